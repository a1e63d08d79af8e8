"""The kernel: one input, one transaction, breadth first, in a fixed order.

`inject` (any thread) fills the inbox; `pump` admits one input after another, and each is
read only when every consequence of the one before has been delivered. `post`, from a
handler, appends to the running transaction; nothing is ever delivered inside a handler.
Receivers are served in load order, then in order of declaration. Of pending messages with
equal type, sender and key only the latest is delivered.
"""

from collections.abc import Callable
from typing import Any, TypeVar

from vrut_lite.checks import refusal_of
from vrut_lite.errors import UserError
from vrut_lite.foreign_errors import sentence_of
from vrut_lite.interrupts import pass_interrupt
from vrut_lite.kernel import messages
from vrut_lite.kernel import settings as setting_rules
from vrut_lite.kernel.clock import Clock
from vrut_lite.kernel.contract import check_module_type
from vrut_lite.kernel.dispatch import HOST, Act, Dispatcher, Tap
from vrut_lite.kernel.inbox import Inbox
from vrut_lite.kernel.job_scheduler import JobScheduler
from vrut_lite.kernel.jobs import JobRunner, ThreadRunner
from vrut_lite.kernel.lifecycle import FAULTS_UNTIL_SUSPENSION, Lifecycle
from vrut_lite.kernel.loaded_module import (
    POSTS_PER_TRANSACTION,
    KernelServices,
    LoadedModule,
    ModuleContext,
)
from vrut_lite.kernel.messages import Demand, Fault, Input, JobResult, Message
from vrut_lite.kernel.module import Module
from vrut_lite.kernel.setup_log import SetupLog, Step
from vrut_lite.kernel.slots import Slots
from vrut_lite.kernel.trace import Trace

__all__ = ["FAULTS_UNTIL_SUSPENSION", "HOST", "POSTS_PER_TRANSACTION", "Kernel", "Tap"]

M = TypeVar("M", bound=Message)


class Kernel:
    """Links modules by messages; single-threaded but for `inject`."""

    def __init__(self, runner: JobRunner | None = None) -> None:
        self.seats: dict[str, LoadedModule] = {}
        self.slots = Slots(self.seats)
        self.trace = Trace()
        self._inbox = Inbox()
        self._clock = Clock()
        self.runner = runner or ThreadRunner()
        self.jobs = JobScheduler(self.runner, self.inject, self.trace)
        self.beginning = SetupLog(self.jobs)
        self.dispatcher = Dispatcher(self.seats, self.slots, self.trace)
        self.lifecycle = Lifecycle(
            self.seats,
            self.dispatcher,
            self.slots,
            self.jobs,
            lambda seat: ModuleContext(links, seat),
        )
        # Seats that have started jobs since the last input other than a job's result.
        self._job_starters: list[ModuleContext] = []
        links = KernelServices(
            put=self.dispatcher.put,
            suspend=self.lifecycle.suspend,
            wanted=self.wanted,
            last=self.last,
            holder=self.slots.holder,
            jobs=self.jobs,
            posters=self.dispatcher.posters,
            job_starters=self._job_starters,
        )
        self.dispatcher.fail = self.lifecycle.failed
        self._own_acts = self._acts()
        self.dispatcher.act_on = self._act_on
        self._watchers: list[Callable[[Input], None]] = []
        # Number of the group of inputs that began the last revision.
        self._group = 0
        self._on_inject: Callable[[], None] | None = None
        self._pumping = False

    # --- modules ---------------------------------------------------------------------

    def add_module(self, module_type: type[Module], **services: Any) -> None:
        """Load a module; its settings start at their defaults, host modules get services.

        A module whose constructor raises is suspended with a Fault; the others go on.

        Raises:
            UserError: `check_module_type` refuses the class, or its name is taken.
        """
        check_module_type(module_type)
        name = module_type.manifest.name
        if name in self.seats:
            raise UserError(f"two modules are called '{name}': uninstall one of them")
        try:
            self.seats[name] = LoadedModule(module_type, services)
        # A module's code may change its manifest after the check.
        except BaseException as error:
            pass_interrupt(error)
            raise UserError(f"module {name} cannot be used: {sentence_of(error)}") from None
        self.beginning.note(Step(module=name))
        self.lifecycle.start(self.seats[name])

    def check_module(self, name: str) -> LoadedModule:
        """The seat of a module.

        Raises:
            UserError: no module of this name is installed.
        """
        if name not in self.seats:
            raise UserError(f"there is no module '{name}': installed are {', '.join(self.seats)}")
        return self.seats[name]

    def check_setting(self, module: str, name: str, value: Any) -> Any:
        """The value converted to the setting's type; UserError if the setting refuses it."""
        return getattr(
            setting_rules.change(self.check_module(module).settings, module, name, value), name
        )

    def check_holder(self, slot: str, module: str) -> None:
        """Raise UserError unless the module is installed and provides the slot."""
        if slot not in self.check_module(module).manifest.provides:
            able = ", ".join(self.slots.providers(slot)) or "no module"
            raise UserError(f"module {module} cannot hold the slot '{slot}': {able} can")

    # --- in and out ------------------------------------------------------------------

    def inject(self, *messages: Input) -> None:
        """Queue inputs, from any thread; `pump` admits them. Together they begin one revision."""
        self._inbox.put(*messages)
        if self._on_inject is not None:
            self._on_inject()

    def on_inject(self, wake: Callable[[], None] | None) -> None:
        """Let `wake` be called after each input arrives, on the thread that brings it."""
        self._on_inject = wake

    def watch_admission(self, listener: Callable[[Input], None]) -> None:
        """Show every input that opens a transaction, after coalescing, before it is delivered."""
        self._watchers.append(listener)

    def tap(self, listener: Tap) -> None:
        """Show every message, as it is delivered, with its sender's name."""
        self.dispatcher.taps.append(listener)

    @property
    def waiting(self) -> int:
        """How many inputs wait to be admitted."""
        return len(self._inbox)

    @property
    def revision(self) -> int:
        """The number of the last revision; 0 before the first."""
        return self.jobs.latest

    @property
    def is_whole(self) -> bool:
        """Whether all admitted inputs have had their consequences, except drafts and refinement."""
        return not (self._pumping or self.jobs.awaited)

    @property
    def goes_on(self) -> bool:
        """Whether an input waits that the present revision lets in."""
        return self._inbox.has_within(self._group)

    def pump(self, most: int | None = None, within: bool = False) -> int:
        """Admit inputs until none is left, or `most` of them; the number of transactions.

        `within` the present revision only inputs are admitted that begin no other: results of
        jobs, the rest of the inputs that began it, and those that revise nothing.

        Raises:
            RuntimeError: called from a handler, which would nest transactions.
        """
        if self._pumping:
            raise RuntimeError("pump() was called inside a handler; post() a message instead")
        self._pumping = True
        transactions = 0
        try:
            if self.dispatcher.waits:
                self.jobs.revision = 0
                self.beginning.note(Step())
                self.dispatcher.settle()
            taken, inbox = 0, self._inbox
            while taken != most:
                entry = inbox.take_within(self._group) if within else inbox.take()
                if entry is None:
                    break
                taken += 1
                message, group = entry
                if not isinstance(message, JobResult):
                    self._revise(message, group)
                # The result of a cancelled job is dropped.
                elif not self._is_awaited(message):
                    continue
                self._transact(message)
                transactions += 1
        finally:
            self._pumping = False
        return transactions

    def pump_until_idle(self) -> None:
        """Pump until no input is left and no background job runs or waits."""
        self.pump()
        while self.jobs.busy:
            self.runner.wait()
            self.pump()

    def close(self) -> None:
        """Cancel all background jobs and start no more."""
        self.jobs.cancel_all()
        self.runner.close()

    def last(self, message_type: type[M]) -> M | None:
        """The latest message of a type, or None; for a slot's types, of the present holder."""
        return self.dispatcher.memory.latest.get(message_type)  # type: ignore[return-value]

    def wanted(self, message_type: type[Message]) -> Demand | None:
        """The merged demand for a type of message, or None without demand."""
        return self.lifecycle.demands.merged.get(message_type.__name__)

    def last_fault(self, module: str) -> Fault | None:
        """A module's latest fault, also of one that is suspended, or None."""
        return self.seats[module].last_fault

    def _is_awaited(self, result: JobResult) -> bool:
        if refusal_of(result) is None:
            return self.jobs.admit(result)
        self.jobs.revision = 0
        return True

    def _revise(self, message: Input, group: int) -> None:
        """Begin a revision with the first input of a group that revises anything."""
        jobs = self.jobs
        if not message.revises:
            jobs.revision = 0
            return
        if group != self._group:
            jobs.latest, self._group = jobs.latest + 1, group
        jobs.revision = jobs.latest

    def _transact(self, message: Input) -> None:
        if not self.beginning.ended_by:
            self.beginning.note(Step(input=message))
        for watcher in self._watchers:
            watcher(message)
        if self._job_starters and not isinstance(message, JobResult):
            for starter in self._job_starters:
                starter.jobs = 0
            self._job_starters.clear()
        try:
            self.dispatcher.put(message, HOST)
        # `key()` raised: a malformed input, or a module's own type.
        except BaseException as error:
            pass_interrupt(error)
            where = type(message).__name__
            said = refusal_of(message) or f"{where} has no key: {sentence_of(error)}"
            self.lifecycle.refuse(HOST, where, said)
        self.dispatcher.settle()

    # --- the kernel's own handlers ---------------------------------------------------

    def _acts(self) -> dict[type[Message], tuple[str, Act]]:
        """The kernel's own handler of a message type, and its name in a Fault."""
        lifecycle, seat_of = self.lifecycle, self.check_module
        return {
            messages.SetSetting: ("settings", self._set),
            messages.EnableModule: ("enable", self._enable),
            messages.RestartModule: ("restart", lambda m: lifecycle.start(seat_of(m.module))),
            messages.ReloadModule: ("reload", lambda m: lifecycle.reload(seat_of(m.module))),
            messages.ChooseSlot: ("slots", self._choose),
            Demand: ("demand", lifecycle.demands.note),
            JobResult: ("job", self._job_done),
            messages.SetClock: ("clock", lambda m: lifecycle.say(self._clock.set(m))),
            messages.SetClockRate: ("clock", self._clock.set_rate),
            messages.Tick: ("clock", lambda m: lifecycle.say(self._clock.tick(m))),
        }

    def _act_on(self, kind: type[Message]) -> Act | None:
        """The kernel's own handler of a type, called before the modules; inputs are checked.

        A refused input is posted as a Fault for the user.
        """
        where, act = self._own_acts.get(kind, (kind.__name__, _do_nothing))
        if act is _do_nothing and (not issubclass(kind, Input) or kind.check is Message.check):
            return None

        def guarded(message: Any) -> bool:
            refusal = refusal_of(message)
            if refusal is None:
                try:
                    act(message)
                except UserError as error:
                    refusal = str(error)
            if refusal is None:
                return False
            module = getattr(message, "module", HOST)
            module = module if isinstance(module, str) else HOST
            self.lifecycle.refuse(module, where, refusal)
            return True

        return guarded

    def _set(self, message: messages.SetSetting) -> None:
        seat = self.check_module(message.module)
        before = seat.settings
        settings = setting_rules.change(before, message.module, message.name, message.value)
        value = getattr(settings, message.name)
        if getattr(before, message.name) == value:
            return
        seat.settings = settings
        self.lifecycle.say(
            messages.SettingChanged(module=seat.name, name=message.name, value=value)
        )
        if seat.module is not None:
            self.dispatcher.call(seat, "__setattr__", "settings", settings)
        if seat.module is not None:
            self.dispatcher.call(seat, "settings_changed", message.name)

    def _enable(self, message: messages.EnableModule) -> None:
        seat = self.check_module(message.module)
        if seat.running == message.enabled:
            return
        if message.enabled:
            self.lifecycle.start(seat)
        else:
            self.lifecycle.stop(seat, "disabled")

    def _choose(self, message: messages.ChooseSlot) -> None:
        self.check_holder(message.slot, message.module)
        self.lifecycle.switched(self.slots.choose(message.slot, message.module))

    def _job_done(self, result: JobResult) -> None:
        """Count a job that raised as a fault of its module.

        An error without a trace (of a GPU job, say) is an answer that the module expects.
        """
        seat = self.check_module(result.module)
        if result.trace:
            fault = Fault(
                module=seat.name,
                where=f"job {result.job}",
                error=result.error,
                trace=result.trace,
                for_user=result.for_user,
            )
            self.lifecycle.count(seat, fault)


def _do_nothing(message: Any) -> None:
    """The kernel's own handlers by message type."""
