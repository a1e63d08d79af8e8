"""A module's place at the kernel: what outlives its instance."""

from typing import Any, Literal

import msgspec

from vrut_lite.kernel.ledger import Ledger
from vrut_lite.kernel.messages import Fault, Message
from vrut_lite.kernel.module import Link, Manifest, Module

State = Literal["running", "disabled", "suspended"]


class Seat:
    """Settings, faults and state of one module; the instance comes and goes."""

    def __init__(self, module_type: type[Module], services: dict[str, Any]):
        self.module_type = module_type
        self.settings: msgspec.Struct = module_type.settings_type()
        self.module: Module | None = None
        self.methods: dict[type[Message], tuple[str, ...]] = {}
        self.state: State = "disabled"
        self.faults = 0
        self.last_fault: Fault | None = None
        self._services = services
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
        return self.module.ledger if self.module is not None else Ledger()

    def start(self, link: Link) -> None:
        """Make a fresh instance with the present settings; may raise what its maker wrote."""
        self.module = self.module_type(link, self.settings, **self._services)
        self.faults = 0
        self.state = "running"

    def stop(self, state: State) -> None:
        """Drop the instance; the settings stay."""
        self.module = None
        self.state = state
