"""The kernel: one input, one transaction, breadth first, in a fixed order.

`inject` (any thread) fills the inbox; `pump` admits one input after another, and each is
read only when every consequence of the one before has been delivered. `post`, from a
handler, appends to the running transaction; nothing is ever delivered inside a handler.
Receivers are served in load order, then in order of declaration. Of pending messages with
equal type, sender and key only the latest is delivered.
"""

import threading
import traceback
from collections.abc import Callable
from typing import Any, NamedTuple, TypeVar

import msgspec

from vrut_lite.errors import UserError
from vrut_lite.kernel import settings as setting_rules
from vrut_lite.kernel.messages import (
    ChooseSlot,
    Demand,
    Derived,
    EnableModule,
    Fault,
    Input,
    Message,
    RestartModule,
    SetSetting,
    SettingChanged,
    SlotChanged,
)
from vrut_lite.kernel.module import Module
from vrut_lite.kernel.outbox import Outbox
from vrut_lite.kernel.seat import Seat, State
from vrut_lite.kernel.slots import Slots

M = TypeVar("M", bound=Message)
Tap = Callable[[Message, str], None]

HOST = "host"
FAULTS_UNTIL_SUSPENSION = 3
POSTS_PER_TRANSACTION = 10_000


class Envelope(NamedTuple):
    """A message on its way; `only_to` names the one receiver of a remembered message."""

    message: Message
    sender: str
    only_to: str | None = None


class Kernel:
    """Links modules by messages; single-threaded but for `inject`."""

    def __init__(self) -> None:
        self.seats: dict[str, Seat] = {}
        self.slots = Slots(self.seats)
        self._inbox: Outbox[Input] = Outbox()
        self._inbox_lock = threading.Lock()
        self._queue: Outbox[Envelope] = Outbox()
        self._remembered: dict[tuple[type[Message], str, str], Message] = {}
        self._demands: dict[str, dict[str, Demand]] = {}
        self._posts: dict[str, int] = {}
        self._taps: list[Tap] = []
        self._pumping = False

    # --- modules ---------------------------------------------------------------------

    def add_module(self, module_type: type[Module], **services: Any) -> None:
        """Load a module; its settings start at their defaults, host modules get services.

        A module whose constructor raises is suspended with a Fault; the others go on.
        """
        name = module_type.manifest.name
        if name in self.seats:
            raise UserError(f"two modules are called '{name}': uninstall one of them")
        self.seats[name] = Seat(module_type, services)
        self._start(self.seats[name])
        for slot in module_type.manifest.provides:
            self._announce(self.slots.fill(slot))

    def check_module(self, name: str) -> Seat:
        """The seat of a module.

        Raises:
            UserError: no module of this name is installed.
        """
        if name not in self.seats:
            raise UserError(f"there is no module '{name}': installed are {', '.join(self.seats)}")
        return self.seats[name]

    def check_setting(self, module: str, name: str, value: Any) -> Any:
        """The value as the module's setting would take it; UserError if it would not."""
        return getattr(
            setting_rules.change(self.check_module(module).settings, module, name, value), name
        )

    def check_holder(self, slot: str, module: str) -> None:
        """Raise UserError unless the module is installed and provides the slot."""
        if slot not in self.check_module(module).manifest.provides:
            able = ", ".join(self.slots.providers(slot)) or "no module"
            raise UserError(f"module {module} cannot hold the slot '{slot}': {able} can")

    # --- in and out ------------------------------------------------------------------

    def inject(self, message: Input) -> None:
        """Bring a fact from outside, from any thread; `pump` will admit it."""
        with self._inbox_lock:
            self._inbox.put(message, type(message), HOST, message.key())

    def tap(self, listener: Tap) -> None:
        """Show every message, as it is delivered, with its sender's name."""
        self._taps.append(listener)

    def pump(self) -> int:
        """Admit inputs until none is left; the number of transactions.

        Raises:
            RuntimeError: called from a handler, which would nest transactions.
        """
        if self._pumping:
            raise RuntimeError("pump() was called inside a handler; post() a message instead")
        self._pumping = True
        transactions = 0
        try:
            self._settle()
            while (message := self._next_input()) is not None:
                self._enqueue(Envelope(message, HOST))
                self._settle()
                transactions += 1
        finally:
            self._pumping = False
        return transactions

    def last(self, message_type: type[M]) -> M | None:
        """The latest message of a type, or None."""
        latest = None
        for (kind, _, _), message in self._remembered.items():
            if kind is message_type:
                latest = message
        return latest  # type: ignore[return-value]

    def wanted(self, message_type: type[Message]) -> Demand | None:
        """The largest demand for a type of message, or None when nobody wants it."""
        demands = self._demands.get(message_type.__name__, {}).values()
        return max(demands, key=lambda demand: demand.size, default=None)

    def last_fault(self, module: str) -> Fault | None:
        """A module's latest fault, also of one that is suspended, or None."""
        return self.seats[module].last_fault

    # --- the transaction -------------------------------------------------------------

    def _next_input(self) -> Input | None:
        with self._inbox_lock:
            return self._inbox.take()

    def _settle(self) -> None:
        """Deliver until nothing is queued: one transaction."""
        self._posts.clear()
        while (envelope := self._queue.take()) is not None:
            self._act(envelope.message)
            if envelope.only_to is None:
                self._remember(envelope)
                for listener in self._taps:
                    listener(envelope.message, envelope.sender)
            self._deliver(envelope)

    def _deliver(self, envelope: Envelope) -> None:
        kind = type(envelope.message)
        for seat in tuple(self.seats.values()):
            if envelope.only_to is not None and seat.name != envelope.only_to:
                continue
            for method in seat.methods.get(kind, ()):
                if seat.running:
                    self._call(seat, method, envelope.message)

    def _call(self, seat: Seat, method: str, *arguments: Any) -> None:
        """Call a module; what it raises becomes a Fault and stays its own affair.

        A UserError is told like any fault, but it is the user's to mend, not the module's: it
        never suspends.
        """
        try:
            getattr(seat.module, method)(*arguments)
        except UserError as error:
            self._blame(seat, method, error, suspend=False)
        except Exception as error:
            seat.faults += 1
            self._blame(seat, method, error, suspend=seat.faults >= FAULTS_UNTIL_SUSPENSION)

    def _blame(self, seat: Seat, where: str, error: Exception, suspend: bool) -> None:
        if suspend:
            self._stop(seat, "suspended")
        for_user = isinstance(error, UserError)
        fault = Fault(
            module=seat.name,
            where=where,
            error=str(error) if for_user else f"{type(error).__name__}: {error}",
            trace="".join(traceback.format_exception(error)),
            suspended=suspend,
            for_user=for_user,
        )
        seat.last_fault = fault
        self._enqueue(Envelope(fault, HOST))

    def _enqueue(self, envelope: Envelope) -> None:
        key = envelope.message.key() if envelope.only_to is None else None
        self._queue.put(envelope, type(envelope.message), envelope.sender, key)

    def _remember(self, envelope: Envelope) -> None:
        key = envelope.message.key()
        if key is not None:
            # Taken out first: the order of the memory is the order of the last delivery.
            place = (type(envelope.message), envelope.sender, key)
            self._remembered.pop(place, None)
            self._remembered[place] = envelope.message

    def _post(self, seat: Seat, message: Derived) -> None:
        """Queue what a module says; a storm is cut by count, and its maker named."""
        if not seat.running:
            return
        slot = message.slot
        if slot is not None and self.slots.holder(slot) != seat.name:
            seat.ledger.skip(f"post {type(message).__name__} without slot")
            return
        self._posts[seat.name] = self._posts.get(seat.name, 0) + 1
        if self._posts[seat.name] > POSTS_PER_TRANSACTION:
            storm = RuntimeError(f"posted over {POSTS_PER_TRANSACTION} messages after one input")
            self._blame(seat, f"post {type(message).__name__}", storm, suspend=True)
            return
        self._enqueue(Envelope(message, seat.name))

    # --- what the kernel itself does -------------------------------------------------

    def _act(self, message: Message) -> None:
        """The kernel's own part in a message, before the modules hear of it."""
        match message:
            case SetSetting():
                self._set(message)
            case EnableModule():
                self._enable(message)
            case RestartModule() if message.module in self.seats:
                self._start(self.seats[message.module])
            case ChooseSlot():
                self._choose(message)
            case Demand() if message.size > 0:
                self._demands.setdefault(message.message, {})[message.consumer] = message
            case Demand():
                self._demands.get(message.message, {}).pop(message.consumer, None)

    def _set(self, message: SetSetting) -> None:
        seat = self.seats.get(message.module)
        try:
            if seat is None:
                raise UserError(f"there is no module '{message.module}'")
            value = self.check_setting(message.module, message.name, message.value)
        except UserError as error:
            refusal = Fault(
                module=message.module, where="settings", error=str(error), for_user=True
            )
            self._enqueue(Envelope(refusal, HOST))
            return
        if getattr(seat.settings, message.name) == value:
            return
        seat.settings = msgspec.structs.replace(seat.settings, **{message.name: value})
        changed = SettingChanged(module=seat.name, name=message.name, value=value)
        self._enqueue(Envelope(changed, HOST))
        if seat.running and seat.module is not None:
            seat.module.settings = seat.settings
            self._call(seat, "settings_changed", message.name)

    def _enable(self, message: EnableModule) -> None:
        seat = self.seats.get(message.module)
        if seat is None or seat.running == message.enabled:
            return
        if message.enabled:
            self._start(seat)
        else:
            self._stop(seat, "disabled")

    def _choose(self, message: ChooseSlot) -> None:
        try:
            self.check_holder(message.slot, message.module)
        except UserError as error:
            self._refuse(message.module, "slots", error)
            return
        self._announce(self.slots.choose(message.slot, message.module))

    def _refuse(self, module: str, where: str, error: UserError) -> None:
        fault = Fault(module=module, where=where, error=str(error), for_user=True)
        self._enqueue(Envelope(fault, HOST))

    def _start(self, seat: Seat) -> None:
        """Make a fresh instance and tell it the last value of everything it listens to."""
        try:
            seat.start(_ModuleLink(self, seat))
        except Exception as error:
            self._blame(seat, "start", error, suspend=True)
            return
        for slot in seat.manifest.provides:
            self._announce(self.slots.fill(slot))
        for (kind, sender, _), message in self._remembered.items():
            if kind in seat.methods:
                self._enqueue(Envelope(message, sender, only_to=seat.name))

    def _stop(self, seat: Seat, state: State) -> None:
        seat.stop(state)
        for slot in self.slots.held_by(seat.name):
            self._announce(self.slots.fill(slot))

    def _announce(self, change: SlotChanged | None) -> None:
        if change is not None:
            self._enqueue(Envelope(change, HOST))


class _ModuleLink:
    """What a module sees of the kernel."""

    def __init__(self, kernel: Kernel, seat: Seat):
        self._kernel = kernel
        self._seat = seat

    def post(self, message: Derived) -> None:
        self._kernel._post(self._seat, message)

    def wanted(self, message_type: type[Message]) -> Demand | None:
        return self._kernel.wanted(message_type)

    def holds(self, slot: str) -> bool:
        return self._kernel.slots.holder(slot) == self._seat.name

    def last(self, message_type: type[M]) -> M | None:
        return self._kernel.last(message_type)
