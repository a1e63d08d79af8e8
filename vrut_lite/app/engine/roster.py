"""Which modules there are: what panels are made from, taken on the engine's thread."""

from typing import NamedTuple

import msgspec

from vrut_lite.app.engine.stage import Stage
from vrut_lite.kernel.settings import SettingSpec, describe


class ModuleInfo(NamedTuple):
    """One module as it stands: its settings by name, with what is known of each."""

    name: str
    title: str
    version: str
    provides: tuple[str, ...]
    state: str
    specs: dict[str, SettingSpec]
    values: dict[str, object]


class Roster(NamedTuple):
    """All modules in load order, who holds which slot, and what draws."""

    modules: dict[str, ModuleInfo]
    holders: dict[str, str]
    renderer: str

    def providers(self, slot: str) -> list[ModuleInfo]:
        """Those that can hold a slot."""
        return [module for module in self.modules.values() if slot in module.provides]

    @property
    def slots(self) -> list[str]:
        """All slots that some module can hold."""
        return sorted({slot for module in self.modules.values() for slot in module.provides})


def roster_of(stage: Stage) -> Roster:
    """The roster of now."""
    kernel = stage.kernel
    modules = {
        name: ModuleInfo(
            name=name,
            title=seat.manifest.title,
            version=seat.manifest.version,
            provides=seat.manifest.provides,
            state=seat.state,
            specs=describe(type(seat.settings)),
            values=msgspec.structs.asdict(seat.settings),
        )
        for name, seat in kernel.seats.items()
    }
    slots = {slot for module in modules.values() for slot in module.provides}
    return Roster(modules, {slot: kernel.slots.holder(slot) for slot in slots}, stage.renderer)
