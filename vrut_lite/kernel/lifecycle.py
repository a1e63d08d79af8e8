"""Start, stop, failure and replacement of modules, with their slots, demands and jobs."""

from collections.abc import Callable, Mapping
from typing import Any

import msgspec

from vrut_lite.foreign_errors import described
from vrut_lite.interrupts import pass_interrupt
from vrut_lite.kernel import settings as setting_rules
from vrut_lite.kernel.demands import Demands
from vrut_lite.kernel.dispatch import HOST, Dispatcher
from vrut_lite.kernel.job_scheduler import JobScheduler
from vrut_lite.kernel.loaded_module import LoadedModule, ModuleContext, State
from vrut_lite.kernel.messages import Derived, Fault, SlotChanged
from vrut_lite.kernel.reload import import_afresh, root_package
from vrut_lite.kernel.slots import Slots

FAULTS_UNTIL_SUSPENSION = 3


class Lifecycle:
    """Moves seats from state to state and posts the changes."""

    def __init__(
        self,
        seats: Mapping[str, LoadedModule],
        dispatcher: Dispatcher,
        slots: Slots,
        jobs: JobScheduler,
        make_link: Callable[[LoadedModule], ModuleContext],
    ):
        self.demands = Demands(lambda name: name in seats and not seats[name].running)
        self._dispatcher = dispatcher
        self._slots = slots
        self._jobs = jobs
        self._make_link = make_link

    def say(self, message: Derived | None) -> None:
        """Queue a message of the host, if there is one."""
        if message is not None:
            self._dispatcher.put(message, HOST)

    # --- faults ----------------------------------------------------------------------

    def failed(self, seat: LoadedModule, where: str, error: BaseException) -> None:
        """Count a module's exception as its Fault."""
        self.count(seat, Fault(module=seat.name, where=where, **described(error)))

    def count(self, seat: LoadedModule, fault: Fault) -> None:
        """Post a fault and count it; a UserError counts only against storms."""
        if fault.for_user:
            if seat.link is not None and not seat.link.counts(fault):
                return
        else:
            seat.faults += 1
            if seat.running and seat.faults >= FAULTS_UNTIL_SUSPENSION:
                fault = msgspec.structs.replace(fault, suspended=True)
        self._tell(seat, fault)

    def suspend(self, seat: LoadedModule, where: str, error: BaseException) -> None:
        """Suspend a module at once and post the reason as a Fault."""
        self._tell(seat, Fault(module=seat.name, where=where, suspended=True, **described(error)))

    def refuse(self, module: str, where: str, error: str) -> None:
        """Post a Fault for the user about an invalid input."""
        self.say(Fault(module=module, where=where, error=error, for_user=True))

    def _tell(self, seat: LoadedModule, fault: Fault) -> None:
        if fault.suspended:
            self.stop(seat, "suspended")
        seat.last_fault = fault
        self.say(fault)

    # --- starting and stopping -------------------------------------------------------

    def start(self, seat: LoadedModule) -> None:
        """Make a fresh instance and deliver the last value of every type that it handles."""
        self._jobs.cancel_all(seat.name)
        try:
            seat.start(self._make_link(seat))
        except BaseException as error:
            pass_interrupt(error, f"at the start of the module {seat.name}")
            self.suspend(seat, "start", error)
        else:
            self._welcome(seat)

    def stop(self, seat: LoadedModule, state: State) -> None:
        """Drop the instance, its jobs and its slots."""
        self._jobs.cancel_all(seat.name)
        seat.stop(state)
        self._changed_state()

    def switched(self, change: SlotChanged | None) -> None:
        """Post the new holder; forget what others posted for the slot."""
        if change is not None and change.holder:
            self._dispatcher.memory.keep_only(change.name, change.holder)
        self.say(change)

    def _welcome(self, seat: LoadedModule) -> None:
        """Give a fresh instance its slots, its demands and the last values."""
        self._changed_state()
        for demand in self.demands.of_consumer(seat.name):
            self._dispatcher.put(demand, HOST)
        if seat.link is not None:
            for message, sender in self._dispatcher.memory.recall(seat.methods):
                self._dispatcher.put_again(message, sender, seat.link)

    def _changed_state(self) -> None:
        self._dispatcher.reroute()
        self.demands.refresh()
        for change in self._slots.fill():
            self.switched(change)

    # --- reloading -------------------------------------------------------------------

    def reload(self, seat: LoadedModule) -> None:
        """Put the newest version in the old one's place; a broken one leaves the old running."""
        old_type, old_settings = seat.module_type, seat.settings
        state = self._snapshot(seat)
        undo = None
        try:
            new_type, undo = import_afresh(old_type)
            settings, losses = setting_rules.carry_over(
                old_settings, new_type.settings_type, seat.name
            )
            seat.take_type(new_type, settings)
            self._jobs.cancel_all(seat.name)
            if seat.state != "disabled":
                seat.start(self._make_link(seat))
        except BaseException as error:
            seat.take_type(old_type, old_settings)
            if undo is not None:
                undo()
            pass_interrupt(error)
            self._tell(seat, Fault(module=seat.name, where="reload", **described(error)))
            return
        for loss in losses:
            self.refuse(seat.name, "reload", loss)
        # The new version handles its own message types, not the old version's.
        self._dispatcher.memory.forget_types_of(root_package(old_type))
        self._welcome(seat)
        if state is not None and seat.running:
            self._dispatcher.call(seat, "restore", state)

    def _snapshot(self, seat: LoadedModule) -> Any:
        """A module's state as built-in types, so that nothing of the old version lives on."""
        if seat.module is None:
            return None
        state = self._dispatcher.call(seat, "snapshot")
        try:
            return msgspec.to_builtins(state)
        except BaseException as error:
            pass_interrupt(error)
            self.failed(seat, "snapshot", error)
            return None
