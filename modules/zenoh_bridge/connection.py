"""One connection to other processes, from opening to close, all of it off the kernel's thread.

The sender's thread opens the session, sends messages, serves arrays and publishes this process's
demands. The reader's thread fetches the arrays of received messages and injects the messages. Both
keep only the latest message of each type, so that a slow line skips messages.
"""

import atexit
import itertools
import threading
from collections.abc import Callable
from typing import Any

import msgspec

from vrut_lite.array import Array
from vrut_lite.errors import UserError
from vrut_lite.foreign_errors import sentence_of
from vrut_lite.kernel.messages import Demand, Derived, Input
from vrut_lite.message_codec import Handle, arrays_of
from zenoh_bridge.array_store import ArrayStore, check_handle, unpacked
from zenoh_bridge.frames import MessageFrame, encode_frame, read_frame, remote_message
from zenoh_bridge.inputs import BridgeState, BridgeTrouble
from zenoh_bridge.paced import Paced
from zenoh_bridge.plan import SessionPlan
from zenoh_bridge.session import BridgeSession
from zenoh_bridge.wants import LONGEST_PEER, RemoteWants, Wishes, token_key
from zenoh_bridge.worker import Worker

NAME = "zenoh_bridge"

# Queries that may wait for an answer, and replies to one query that are examined.
_MOST_QUERIES = 64
_MOST_REPLIES = 4
# Processes that are counted at most; a stranger could pretend to be any number.
_MOST_PEERS = 1024
# Size of the array store, in units of the largest array.
_STORE_IN_LARGEST = 4
_CLOSE_TIMEOUT_S = 5.0


class Connection:
    """A connection to other processes from `start` to `close`; it injects what it receives."""

    def __init__(self, plan: SessionPlan, inject: Callable[[Input], None]):
        self._plan = plan
        self._inject_into_kernel = inject
        self._closed = False
        self._session: BridgeSession | None = None
        self._arrays = ArrayStore(_STORE_IN_LARGEST * plan.max_array)
        self._wants = RemoteWants(plan.max_array)
        self._last: dict[str, Derived] = {}
        self._tokens: dict[str, Any] = {}
        self._presence: Any = None  # A token lives as long as its object.
        self._peers: set[str] = set()
        self._serial = itertools.count()
        # Held while a demand is read and injected, so that the last one injected is current.
        self._telling = threading.Lock()
        self._shared = {kind.__name__ for kind in plan.share}
        self.states = Paced(self._inject)
        self.troubles = Paced(self._inject)
        self._sender = Worker("sender", self._do, self._open, self._end)
        self._reader = Worker("reader", self._complete)

    # --- from the kernel's thread ----------------------------------------------------

    def start(self) -> None:
        """Open in the background; waits for an endpoint that has just been released."""
        atexit.register(self.close_now)
        self._reader.start()
        self._sender.start()

    def say(self, message: Derived) -> bool:
        """Send a message; False if no process wants it, or if its type is not shared."""
        name = type(message).__name__
        if name not in self._shared:
            return False
        self._last[name] = message
        if self._wants.wanted(name) is None:
            return False
        self._sender.put(("say", name), message)
        return True

    def forget(self, type_name: str) -> None:
        """Do not send the last message of a type to late joiners: its sender lost the slot."""
        self._last.pop(type_name, None)

    def want(self, wishes: Wishes) -> None:
        """Publish this process's demands."""
        self._sender.put("want", dict(wishes))

    def check(self, demand: Demand) -> None:
        """Correct this kernel's record of the others' demand, which may be of an old session."""
        with self._telling:
            truth = self._demand(demand.message)
            if truth != demand:
                self._inject(truth)

    def close(self) -> None:
        """Stop injecting, and end in the background.

        The garbage collector may also call it, on any thread at any time, so it only sets flags
        and takes no lock that its caller could hold.
        """
        self._closed = True
        self._sender.close()
        self._reader.close()

    def close_now(self) -> None:
        """Close, and wait until the endpoint is free."""
        self.close()
        self._sender.join(_CLOSE_TIMEOUT_S)

    # --- on the sender's thread ------------------------------------------------------

    def _open(self) -> None:
        if self._closed:
            return
        try:
            session = self._session = BridgeSession(self._plan.config)
            prefix = self._plan.prefix
            for kind in self._plan.accept:
                session.listen(f"{prefix}/say/{kind.__name__}", self._guarded(self._heard))
            session.serve(f"{prefix}/array/*", self._guarded(self._asked))
            session.watch(f"{prefix}/want/**", self._guarded(self._token))
            session.watch(f"{prefix}/peer/*", self._guarded(self._peer))
            self._presence = session.show(f"{prefix}/peer/{session.peer}")
        except BaseException as error:
            self.states.put(BridgeState(sentence=_one_line(error), failed=True))
            return
        self._tell_state()

    def _end(self) -> None:
        atexit.unregister(self.close_now)
        if self._session is not None:
            self._session.close()

    def _do(self, key: Any, item: Any) -> None:
        if self._session is None:
            return
        try:
            if key == "want":
                self._show(self._session, item)
            elif key[0] == "say":
                self._send(self._session, item)
            else:
                array = self._arrays.find(str(item.key_expr).rpartition("/")[2])
                self._session.answer(item, None if array is None else array.values.tobytes())
        except BaseException as error:
            self._trouble(error)

    def _send(self, session: BridgeSession, message: Derived) -> None:
        for array in arrays_of(message):
            if array.values.nbytes > self._plan.max_array:
                name = type(message).__name__
                raise UserError(
                    f"{name} holds an array of {array.values.nbytes} bytes, which cannot cross: "
                    "raise max_array_mib on both sides"
                )
            self._arrays.keep(array)
        frame = encode_frame(message, self._plan.max_message)
        session.put(f"{self._plan.prefix}/say/{type(message).__name__}", frame)

    def _show(self, session: BridgeSession, wishes: Wishes) -> None:
        prefix, peer = self._plan.prefix, session.peer
        keys = {token_key(prefix, peer, name, *wish) for name, wish in wishes.items()}
        for key in keys - self._tokens.keys():
            self._tokens[key] = session.show(key)
        for key in self._tokens.keys() - keys:
            session.hide(self._tokens.pop(key))

    # --- on Zenoh's threads: only record arrivals ------------------------------------

    def _heard(self, key: str, data: bytes) -> None:
        name = key.rpartition("/")[2]
        frame = read_frame(data, name, self._plan.max_message, self._plan.max_array)
        self._reader.put(name, frame)

    def _asked(self, query: Any) -> None:
        # A ring: with too many queries at a time the oldest get no answer.
        self._sender.put(("query", next(self._serial) % _MOST_QUERIES), query)

    def _token(self, key: str, alive: bool) -> None:
        if self._is_own(key.removeprefix(f"{self._plan.prefix}/want/")):
            return
        name = self._wants.note(key, alive)
        if name is None or name not in self._shared:
            return
        with self._telling:
            self._inject(self._demand(name))
        last = self._last.get(name)
        if alive and last is not None:
            self._sender.put(("say", name), last)

    def _peer(self, key: str, alive: bool) -> None:
        peer = key.rpartition("/")[2]
        if len(peer) > LONGEST_PEER or self._is_own(peer):
            return
        if len(self._peers) < _MOST_PEERS or not alive:
            (self._peers.add if alive else self._peers.discard)(peer)
            self._tell_state()

    def _is_own(self, key: str) -> bool:
        return self._session is not None and key.partition("/")[0] == self._session.peer

    def _guarded(self, note: Callable[..., None]) -> Callable[..., None]:
        def guarded(*arguments: Any) -> None:
            try:
                note(*arguments)
            except BaseException as error:
                self._trouble(error)

        return guarded

    # --- on the reader's thread ------------------------------------------------------

    def _complete(self, name: str, frame: MessageFrame) -> None:
        try:
            self._inject(remote_message(frame, self._fetch))
        except BaseException as error:
            self._trouble(error)

    def _fetch(self, handle: Handle) -> Array:
        digest, _, _ = check_handle(handle, self._plan.max_array)
        known = self._arrays.find(digest)
        if known is not None:
            return known
        assert self._session is not None
        replies = self._session.fetch(f"{self._plan.prefix}/array/{digest}")
        refusal = UserError(f"nobody had the array {digest} any more")
        for data in itertools.islice(replies, _MOST_REPLIES):
            try:
                array = unpacked(data, handle, self._plan.max_array)
            except UserError as error:
                refusal = error
                continue
            self._arrays.keep(array)
            return array
        raise refusal

    def _demand(self, name: str) -> Demand:
        """The other processes' merged demand for a type, with this bridge as its consumer."""
        merged = self._wants.wanted(name) if name in self._shared else None
        if merged is None:
            return Demand(consumer=NAME, message=name, size=0)
        # A texture cannot leave its GPU.
        return msgspec.structs.replace(merged, consumer=NAME, encoding=merged.encoding or "float16")

    # --- into the kernel -------------------------------------------------------------

    def _inject(self, message: Input) -> None:
        if not self._closed:
            self._inject_into_kernel(message)

    def _tell_state(self) -> None:
        count = len(self._peers)
        joined = "1 process has joined" if count == 1 else f"{count or 'no'} processes have joined"
        self.states.put(BridgeState(sentence=f"{self._plan.place}: {joined}", peers=count))

    def _trouble(self, error: BaseException) -> None:
        self.troubles.put(BridgeTrouble(sentence=_one_line(error)))


def _one_line(error: BaseException) -> str:
    """An error as one line; a panic of a Rust library is not an `Exception`."""
    return " ".join(sentence_of(error).split())
