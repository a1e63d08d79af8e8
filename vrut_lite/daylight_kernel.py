"""A kernel with the installed modules, and light demanded of it: all that needs no GL."""

from vrut_lite.discovery import discover
from vrut_lite.errors import ModuleFailed, UserError
from vrut_lite.kernel.bus import Kernel
from vrut_lite.kernel.jobs import JobRunner
from vrut_lite.kernel.messages import Demand, Fault, Input, Message
from vrut_lite.messages.sky_light import LIGHT, SkyLightChanged
from vrut_lite.sky.sky_sum import SkySum

__all__ = ["LIGHT", "FaultCollector", "daylight_kernel", "demand_light"]


def daylight_kernel(runner: JobRunner | None = None) -> tuple[Kernel, list[str]]:
    """A kernel with every installed module and the sum of sky and layers.

    With it comes a sentence for each module that failed to load.
    """
    kernel = Kernel(runner)
    modules, failures = discover()
    for module in modules:
        services = {"inject": kernel.inject} if module.injects else {}
        try:
            kernel.add_module(module, **services)
        except UserError as error:
            failures.append(f"module {module.__name__} failed to load: {error}")
    kernel.add_module(SkySum)
    kernel.pump()
    return kernel, failures


def demand_light(kernel: Kernel, consumer: str, cube_size: int | None = None) -> None:
    """Ask for the clear sky's light and for the sum; without a size they choose one."""
    for message_type in (*LIGHT, SkyLightChanged):
        kernel.inject(Demand(consumer=consumer, message=message_type.__name__, size=cube_size))


class FaultCollector:
    """Collects the faults of a kernel, so that a command can fail by them.

    Faults that follow from another process's messages are posted but not collected.
    """

    def __init__(self, kernel: Kernel):
        self.faults: list[Fault] = []
        self._by_stranger = False
        kernel.watch_admission(self._admitted)
        kernel.tap(self._note)

    def _admitted(self, message: Input) -> None:
        self._by_stranger = message.by_stranger

    def _note(self, message: Message, sender: str) -> None:
        if isinstance(message, Fault) and not self._by_stranger:
            self.faults.append(message)

    def raise_first(self) -> None:
        """Raise the first fault and forget the others, which are often its consequences.

        Raises:
            UserError: the fault is for the user.
            ModuleFailed: a module raised something else.
        """
        if not self.faults:
            return
        fault = self.faults[0]
        self.faults.clear()
        if fault.for_user:
            raise UserError(fault.error)
        raise ModuleFailed(f"module {fault.module} failed in {fault.where}: {fault.error}")
