"""The transaction: a queue of messages, delivered breadth first to receivers in fixed order.

`put` appends and `settle` delivers until nothing is left; nothing is ever delivered inside a
handler. This is the fast path of the kernel: receivers are bound methods, looked up once per
type of message until a module starts or stops; an envelope is one tuple, a trace entry
another; the clock is read once per delivery.
"""

from collections import deque
from collections.abc import Callable, Mapping
from time import perf_counter_ns
from typing import Any, NamedTuple

from vrut_lite.interrupts import pass_interrupt
from vrut_lite.kernel.contract import refuse_unrun
from vrut_lite.kernel.loaded_module import LoadedModule, ModuleContext
from vrut_lite.kernel.memory import Memory
from vrut_lite.kernel.messages import JobResult, Message
from vrut_lite.kernel.slots import Slots
from vrut_lite.kernel.trace import SLOW_NS, Trace

HOST = "host"
Tap = Callable[[Message, str], None]
# The kernel's own handler; true if it refused the message.
Act = Callable[[Any], bool | None]
Handler = Callable[[Any], None]


# A bound handler, the link and the name of the instance that it belongs to, its own name.
Receiver = tuple[Handler, ModuleContext, str, str]


class Route(NamedTuple):
    """Receivers of one message type; `plain` if messages are delivered without further work."""

    name: str
    slot: str | None
    plain: bool
    act: Act | None
    receivers: list[Receiver]


class Dispatcher:
    """Delivers messages.

    `act_on` gives the kernel's own handler of a type, which runs before the modules; `fail`
    receives the exception of a handler. Both are set before the first message.
    """

    act_on: Callable[[type[Message]], Act | None]
    fail: Callable[[LoadedModule, str, BaseException], None]

    def __init__(self, seats: Mapping[str, LoadedModule], slots: Slots, trace: Trace):
        self.memory = Memory()
        self.taps: list[Tap] = []
        self.posters: list[ModuleContext] = []
        self._seats = seats
        self._slots = slots
        self._trace = trace
        self._queue: deque[Any] = deque()
        self._waiting: dict[tuple[type[Message], str, str], list[Any]] = {}
        self._routes: dict[type[Message], Route] = {}
        self._sequence = 0
        self._cause = 0

    @property
    def current(self) -> int:
        """Number of the message that is being delivered, as the trace has it; 0 for none."""
        return self._cause

    @property
    def waits(self) -> bool:
        """Whether something is queued."""
        return bool(self._queue)

    def put(self, message: Message, sender: str) -> None:
        """Append; an undelivered message of equal type, sender and key gives way."""
        key = message.key()
        if key is None:
            self._queue.append((message, sender, self._cause, None, None))
            return
        place = (type(message), sender, key)
        older = self._waiting.get(place)
        if older is not None:
            older[0] = None
        envelope = [message, sender, self._cause, place, None]
        self._waiting[place] = envelope
        self._queue.append(envelope)

    def put_again(self, message: Message, sender: str, link: ModuleContext) -> None:
        """Append a message that was delivered before, for one late joiner alone."""
        self._queue.append((message, sender, self._cause, None, link))

    def reroute(self) -> None:
        """Clear the cache of receivers, after a module has started or stopped."""
        self._routes.clear()

    def settle(self) -> None:
        """Deliver until nothing is queued: one transaction."""
        queue, waiting, routes = self._queue, self._waiting, self._routes
        if not queue:
            return
        keep, taps, record = self.memory.keep, self.taps, self._trace.deliveries.append
        spoken_for = self._slots.spoken_for
        sequence = self._sequence
        start_ns = perf_counter_ns()
        try:
            while queue:
                message, sender, cause, place, only = queue.popleft()
                if place is not None:
                    if message is None:  # A later message has replaced it.
                        continue
                    del waiting[place]
                kind = type(message)
                route = routes.get(kind) or self._route(kind)
                name, slot, plain, _, receivers = route
                if slot is not None and spoken_for(slot, sender):
                    continue
                sequence += 1
                self._cause = sequence
                if taps or not plain or only is not None:
                    prepared = self._prepare(message, sender, cause, route, only)
                    start_ns = perf_counter_ns()
                    if prepared is None:  # The kernel refused it: no trace entry.
                        continue
                    receivers = prepared
                if place is not None:
                    keep(place, sequence, message)
                for call, link, receiver, method in receivers:
                    if not link.alive:
                        continue
                    try:
                        if (answer := call(message)) is not None:
                            refuse_unrun(answer)
                    except BaseException as error:
                        pass_interrupt(error, f"in {method} of the module {receiver}")
                        self.fail(link.seat, method, error)
                    end_ns = perf_counter_ns()
                    record((sequence, cause, sender, name, receiver, start_ns, end_ns))
                    if end_ns - start_ns > SLOW_NS:
                        self._trace.slow(receiver, method, start_ns, end_ns)
                    start_ns = end_ns
        finally:
            self._sequence = sequence
            self._cause = 0
            for poster in self.posters:
                poster.posts = 0
            self.posters.clear()

    def call(self, seat: LoadedModule, method: str, *arguments: Any) -> Any:
        """Call a module outside delivery, as isolated and watched as a handler."""
        start_ns = perf_counter_ns()
        try:
            answer = getattr(seat.module, method)(*arguments)
            if answer is not None:
                refuse_unrun(answer)
            return answer
        except BaseException as error:
            pass_interrupt(error, f"in {method} of the module {seat.name}")
            self.fail(seat, method, error)
            return None
        finally:
            end_ns = perf_counter_ns()
            if end_ns - start_ns > SLOW_NS:
                self._trace.slow(seat.name, method, start_ns, end_ns)

    def _prepare(
        self, message: Message, sender: str, cause: int, route: Route, only: ModuleContext | None
    ) -> list[Receiver] | None:
        """Run the kernel's own handler and find the receivers.

        None if the kernel refused the message.
        """
        if only is not None:
            return [receiver for receiver in route.receivers if receiver[1] is only]
        start_ns = perf_counter_ns()
        refused = route.act is not None and route.act(message)
        for tap in tuple(self.taps):
            tap(message, sender)
        # The act may have started or stopped modules.
        receivers = self._route(type(message)).receivers if route.act else route.receivers
        if isinstance(message, JobResult):
            receivers = [receiver for receiver in receivers if receiver[2] == message.module]
        if route.act is not None or not receivers:
            actor = HOST if route.act is not None else ""
            end_ns = perf_counter_ns()
            self._trace.deliveries.append(
                (self._cause, cause, sender, route.name, actor, start_ns, end_ns)
            )
        return None if refused else receivers

    def _route(self, kind: type[Message]) -> Route:
        """Where messages of a type go now, in load order, then in order of declaration."""
        receivers = [
            (handler, seat.link, seat.name, method)
            for seat in self._seats.values()
            if seat.link is not None
            for method in seat.methods.get(kind, ())
            if (handler := self._handler(seat, method)) is not None
        ]
        act = self.act_on(kind)
        plain = act is None and kind is not JobResult and bool(receivers)
        route = Route(kind.__name__, getattr(kind, "slot", None), plain, act, receivers)
        self._routes[kind] = route
        return route

    def _handler(self, seat: LoadedModule, method: str) -> Handler | None:
        """An instance's method; None, and a Fault, where looking it up raises."""
        try:
            return getattr(seat.module, method)
        except BaseException as error:
            pass_interrupt(error)
            self.fail(seat, method, error)
            return None
