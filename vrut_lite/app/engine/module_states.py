"""The state of each module, for the module manager; taken on the engine's thread."""

from collections.abc import Iterable
from typing import NamedTuple

from vrut_lite.app.engine.stage import Stage
from vrut_lite.kernel.messages import Demand, EnableModule, Fault, Input, Message
from vrut_lite.kernel.module import Manifest
from vrut_lite.kernel.reload import root_package

_HOST_PACKAGE = __name__.partition(".")[0]


class ModuleState(NamedTuple):
    """One module; `needed` marks the host's own and the default holders of slots.

    `posts`: names of its own types and of those that it has posted so far; `hears`: those that it
    handles.
    """

    name: str
    title: str
    version: str
    state: str
    holds: tuple[str, ...]
    fault: Fault | None
    of_host: bool
    needed: bool
    posts: tuple[str, ...]
    hears: tuple[str, ...]


class ModuleStates(NamedTuple):
    """All modules in load order, and a sentence for each that could not be loaded."""

    modules: dict[str, ModuleState]
    failures: tuple[str, ...]

    @property
    def safe(self) -> bool:
        """Whether only needed modules run."""
        return not any(m.state == "running" and not m.needed for m in self.modules.values())


def states_of(stage: Stage) -> ModuleStates:
    """The states at this moment."""
    kernel = stage.kernel
    modules = {}
    for name, seat in kernel.seats.items():
        of_host = root_package(seat.module_type) == _HOST_PACKAGE
        modules[name] = ModuleState(
            name=name,
            title=seat.manifest.title,
            version=seat.manifest.version,
            state=seat.state,
            holds=tuple(sorted(kernel.slots.held_by(name))),
            fault=seat.last_fault,
            of_host=of_host,
            needed=of_host or _holds_alone(seat.manifest),
            # Its demands are for what it hears.
            posts=_names(
                {*seat.module_type.speaks, *kernel.dispatcher.memory.kinds_of(name)} - {Demand}
            ),
            hears=_names({kind for kind, _ in seat.module_type.handlers()}),
        )
    return ModuleStates(modules, tuple(stage.failures))


def _names(kinds: Iterable[type[Message]]) -> tuple[str, ...]:
    return tuple(sorted({kind.__name__ for kind in kinds}))


def _holds_alone(manifest: Manifest) -> bool:
    """Whether a module can give sun or sky without any other module."""
    gives_light = bool({"sun", "sky"} & set(manifest.provides))
    return gives_light and manifest.stand_in and not manifest.requires


def into_safe_mode(states: ModuleStates) -> list[Input]:
    """Inputs that switch the needed modules on and all others off."""
    return [
        EnableModule(module=module.name, enabled=module.needed)
        for module in states.modules.values()
        if module.needed != (module.state == "running")
    ]
