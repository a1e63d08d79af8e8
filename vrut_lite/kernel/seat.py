"""A module's place at the kernel: what outlives its instance."""

from typing import TYPE_CHECKING, Any, Literal

import msgspec

from vrut_lite.kernel.ledger import Ledger
from vrut_lite.kernel.messages import Fault, Message
from vrut_lite.kernel.module import Manifest, Module

if TYPE_CHECKING:
    from vrut_lite.kernel.link import ModuleLink

State = Literal["running", "disabled", "suspended"]


class Seat:
    """Settings, faults and state of one module; the instance comes and goes."""

    def __init__(self, module_type: type[Module], services: dict[str, Any]):
        self.module: Module | None = None
        self.link: ModuleLink | None = None
        self._ledger = Ledger()
        self.state: State = "disabled"
        self.faults = 0
        self.last_fault: Fault | None = None
        self._services = services
        self.take_type(module_type, module_type.settings_type())

    def take_type(self, module_type: type[Module], settings: msgspec.Struct) -> None:
        """Be the seat of this class, from the next start on."""
        self.module_type = module_type
        self.settings = settings
        self.methods: dict[type[Message], tuple[str, ...]] = {}
        for message_type, method in module_type.handlers():
            self.methods[message_type] = (*self.methods.get(message_type, ()), method)

    @property
    def manifest(self) -> Manifest:
        """The module's manifest."""
        return self.module_type.manifest

    @property
    def name(self) -> str:
        """The module's name."""
        return self.manifest.name

    @property
    def running(self) -> bool:
        """Whether the module hears messages."""
        return self.state == "running"

    @property
    def ledger(self) -> Ledger:
        """The instance's counts of work, or empty ones."""
        return self._ledger

    def start(self, link: "ModuleLink") -> None:
        """Put a fresh instance with the present settings in place of any other.

        May raise what its maker wrote; the seat is then as it was.
        """
        try:
            module = self.module_type(link, self.settings, **self._services)
            ledger = _ledger_of(module)
            link.check_storm()
        except BaseException:
            link.alive = False
            raise
        self._cut()
        self.module, self.link, self._ledger = module, link, ledger
        self.faults = 0
        self.state = "running"

    def stop(self, state: State) -> None:
        """Drop the instance; the settings stay."""
        self._cut()
        self.module = self.link = None
        self._ledger = Ledger()
        self.state = state

    def _cut(self) -> None:
        if self.link is not None:
            self.link.alive = False


def _ledger_of(module: Module) -> Ledger:
    """An instance's counts; one that never called Module's constructor has none."""
    ledger = getattr(module, "ledger", None)
    if not isinstance(ledger, Ledger):
        raise TypeError("its constructor must call super().__init__(link, settings)")
    return ledger
