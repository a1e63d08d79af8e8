"""The window's one copy of the modules' settings and the holders of slots."""

from typing import NamedTuple

import msgspec

from vrut_lite.app.engine.stage import Stage
from vrut_lite.atmosphere.ground_reflectance import GroundReflectance
from vrut_lite.kernel.messages import Message, SettingChanged, SlotChanged
from vrut_lite.kernel.settings import SettingSpec, describe
from vrut_lite.messages.haze import SetHaze
from vrut_lite.sky.effective_defaults import Preset, left_open, presets_of


class ModuleInfo(NamedTuple):
    """One module: the values and the descriptions of its settings, by name."""

    name: str
    title: str
    version: str
    provides: tuple[str, ...]
    auxiliary: bool
    settings_type: type[msgspec.Struct]
    specs: dict[str, SettingSpec]
    values: dict[str, object]

    def left_open(self, haze: SetHaze, ground: GroundReflectance) -> dict[str, object]:
        """Effective values of unset settings."""
        return left_open(self.settings_type(**self.values), haze, ground)

    @property
    def presets(self) -> dict[str, Preset]:
        """Settings that the module proposes, by name."""
        return presets_of(self.settings_type)

    @property
    def changed_values(self) -> dict[str, object]:
        """The settings that differ from their defaults."""
        return {
            name: value for name, value in self.values.items() if value != self.specs[name].default
        }


class ModuleCatalogue(NamedTuple):
    """All modules in load order, the holder of each slot ("" for none), and the renderer."""

    modules: dict[str, ModuleInfo]
    holders: dict[str, str]
    renderer: str

    def providers(self, slot: str) -> list[ModuleInfo]:
        """The modules that can hold a slot."""
        return [module for module in self.modules.values() if slot in module.provides]

    @property
    def slots(self) -> list[str]:
        """All slots that some module can hold."""
        return sorted({slot for module in self.modules.values() for slot in module.provides})

    def settings_of(self, *modules: str) -> dict[tuple[str, str], object]:
        """The settings of some modules, or of all, by module and name."""
        return {
            (module, name): value
            for module in modules or self.modules
            for name, value in self.modules[module].values.items()
        }

    def note(self, message: Message) -> None:
        """Follow what a message changes."""
        if isinstance(message, SlotChanged):
            self.holders[message.name] = message.holder
        elif isinstance(message, SettingChanged) and message.module in self.modules:
            self.modules[message.module].values[message.name] = message.value


def catalogue_of(stage: Stage) -> ModuleCatalogue:
    """The catalogue at this moment; on the engine's thread."""
    kernel = stage.kernel
    modules = {
        name: ModuleInfo(
            name=name,
            title=seat.manifest.title,
            version=seat.manifest.version,
            provides=seat.manifest.provides,
            auxiliary=seat.manifest.auxiliary,
            settings_type=type(seat.settings),
            specs=describe(type(seat.settings)),
            values=msgspec.structs.asdict(seat.settings),
        )
        for name, seat in kernel.seats.items()
    }
    slots = {slot for module in modules.values() for slot in module.provides}
    return ModuleCatalogue(
        modules, {slot: kernel.slots.holder(slot) for slot in slots}, stage.renderer
    )
