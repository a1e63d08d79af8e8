"""The module `zenoh_bridge`: sends messages to other processes and posts what they send.

It may hold the slots `sun` and `sky`. Then it posts another process's messages here and forwards
the demands of this process. Without a slot it keeps the latest message of each type.

All that it receives enters as an input, so that a replay of a journal with these inputs posts the
same messages without a connection.
"""

import weakref
from collections.abc import Callable
from typing import Any, ClassVar, get_args

from vrut_lite import __version__
from vrut_lite.errors import UserError
from vrut_lite.kernel.demands import Demands
from vrut_lite.kernel.messages import (
    Demand,
    Derived,
    EnableModule,
    Encoding,
    Fault,
    Input,
    RestartModule,
    SlotChanged,
)
from vrut_lite.kernel.module import Handler, Link, Manifest, Module, handles
from zenoh_bridge.connection import NAME, Connection
from zenoh_bridge.inputs import BridgeState, BridgeTrouble, RemoteMessage
from zenoh_bridge.plan import plan_of
from zenoh_bridge.settings import ZenohBridgeSettings
from zenoh_bridge.shareable import SHAREABLE, SLOTS, revive, types_named

OFF = "off: set enabled to true to join another process"
ALONE = "joined to nobody: this kernel takes no inputs from outside"
OPENING = "opening"


def _handles_all(kinds: tuple[type[Derived], ...]) -> Callable[[Handler], Handler]:
    def mark(method: Handler) -> Handler:
        for kind in kinds:
            method = handles(kind)(method)
        return method

    return mark


class ZenohBridge(Module):
    """Connects kernels of several processes.

    `inject` puts inputs into this kernel, from any thread; without it (as in a replay) the bridge
    does not connect and only posts what its inputs contain. `state` is one sentence.

    The counters count, by message type, messages sent ("... sent"), messages received and posted
    (the type's name), and messages skipped: unwanted there, without slot here, not accepted.
    "bridge trouble" counts frames and arrays that were refused or could not be fetched.
    """

    # Without a connection it has nothing to post, so it holds a slot only when chosen.
    manifest = Manifest(
        name=NAME,
        title="Another process (Zenoh)",
        version=__version__,
        provides=SLOTS,
        stand_in=False,
        auxiliary=True,
    )
    settings_type = ZenohBridgeSettings
    settings: ZenohBridgeSettings
    # The inputs that it injects from outside.
    injects: ClassVar[tuple[type[Input], ...]] = (RemoteMessage, BridgeState, BridgeTrouble, Demand)

    def __init__(
        self,
        link: Link,
        settings: ZenohBridgeSettings,
        inject: Callable[[Input], None] | None = None,
    ):
        super().__init__(link, settings)
        self.state = OFF
        self._inject = inject
        self._connection: Connection | None = None
        self._latest: dict[type[Derived], Derived] = {}
        self._relayed: dict[type[Derived], Derived] = {}
        self._demands: dict[tuple[str, str], Demand] = {}
        self._theirs: dict[str, Demand] = {}
        self._join()

    def settings_changed(self, name: str) -> None:
        """Any change opens a new session."""
        self._join()

    # --- joining and leaving ---------------------------------------------------------

    def _join(self) -> None:
        """Close the session, and open one as the settings say; errors return as a BridgeState."""
        if self._connection is not None:
            self._connection.close()
            self._connection = None
        self.state = OFF
        if self.settings.enabled:
            self.state = ALONE if self._inject is None else OPENING
            self._open()
        for demand in self._theirs.values():
            self._check(demand)

    def _open(self) -> None:
        if self._inject is None:
            return
        try:
            plan = plan_of(self.settings)
        except UserError as error:
            self._inject(BridgeState(sentence=str(error), failed=True))
            return
        self._connection = Connection(plan, self._inject)
        # The kernel does not notify an instance that it drops: its end must close the session.
        weakref.finalize(self, self._connection.close)
        self._connection.start()
        for kind in SHAREABLE:
            latest = self.link.last(kind)
            if latest is not None:
                self.said(latest)
        self._tell_wishes()

    @handles(BridgeState)
    def state_changed(self, message: BridgeState) -> None:
        """Update the bridge's state.

        Raises:
            UserError: the bridge could not be opened.
        """
        if not self.settings.enabled:
            return
        self.state = message.sentence
        if self._connection is not None:
            self._connection.states.heard()
        if message.failed:
            raise UserError(message.sentence)

    @handles(BridgeTrouble)
    def trouble(self, message: BridgeTrouble) -> None:
        """Count refusals, and publish the latest as a fault.

        Raises:
            UserError: always.
        """
        self.counters.skip("bridge trouble", message.count)
        if self._connection is not None:
            self._connection.troubles.heard()
        others = f" (and {message.count - 1} more)" if message.count > 1 else ""
        raise UserError(message.sentence + others)

    # --- out -------------------------------------------------------------------------

    @_handles_all(SHAREABLE)
    def said(self, message: Derived) -> None:
        """Send a message that was posted here, unless it came over the bridge."""
        if self._connection is None or message is self._relayed.get(type(message)):
            return
        name = type(message).__name__
        if self._connection.say(message):
            self.counters.did(f"{name} sent")
        else:
            self.counters.skip(f"{name} unwanted there")

    # --- in --------------------------------------------------------------------------

    @handles(RemoteMessage)
    def came_in(self, remote: RemoteMessage) -> None:
        """Post a received message, or keep it until this module holds the slot."""
        accepted = {kind.__name__ for kind in types_named(self.settings.accept, "accept")}
        if not self.settings.enabled or remote.type_name not in accepted:
            self.counters.skip(f"{remote.type_name} not accepted")
            return
        message = revive(remote.type_name, remote.fields)
        self._latest[type(message)] = message
        self._say(message)

    @handles(SlotChanged)
    def slot_changed(self, change: SlotChanged) -> None:
        """Post the latest messages of a slot gained; withdraw the demand for a slot lost."""
        of_slot = [kind for kind in SHAREABLE if kind.slot == change.name]
        if self._connection is not None:
            for kind in of_slot:
                self._connection.forget(kind.__name__)
        for kind in of_slot if change.holder == NAME else ():
            if kind in self._latest:
                self._say(self._latest[kind])
        self._tell_wishes()

    def _say(self, message: Derived) -> None:
        name = type(message).__name__
        if message.slot is not None and not self.link.holds(message.slot):
            self.counters.skip(f"{name} without slot")
            return
        self._relayed[type(message)] = message
        self.link.post(message)
        self.counters.did(name)

    # --- demand ----------------------------------------------------------------------

    @handles(Demand)
    def demanded(self, demand: Demand) -> None:
        """Demand has changed: in this process, or, with this module as consumer, in others."""
        if demand.consumer == NAME:
            self._theirs[demand.message] = demand
            self._check(demand)
        # The kernel has already refused demands for unknown encodings.
        elif demand.encoding in get_args(Encoding):
            self._demands[demand.message, demand.consumer] = demand
            self._tell_wishes()

    def _check(self, theirs: Demand) -> None:
        """Withdraw demands that a closed session has left behind."""
        if self._connection is not None:
            self._connection.check(theirs)
        elif self._inject is not None and theirs.size != 0:
            self._inject(Demand(consumer=NAME, message=theirs.message, size=0))

    @handles(EnableModule)
    @handles(RestartModule)
    @handles(Fault)
    def modules_changed(self, _message: Any) -> None:
        """Demands may have changed, because a module has started or stopped."""
        self._tell_wishes()

    def _tell_wishes(self) -> None:
        if self._connection is None:
            return
        wishes = {}
        for kind in types_named(self.settings.accept, "accept"):
            wish = self._local_wish(kind)
            if wish is not None:
                wishes[kind.__name__] = (wish.size, wish.encoding)
        self._connection.want(wishes)

    def _local_wish(self, kind: type[Derived]) -> Demand | None:
        """This process's own demand for a type that another process must produce."""
        merged = self.link.wanted(kind)
        if merged is None or (kind.slot is not None and not self.link.holds(kind.slot)):
            return None
        running = merged.consumer.split(", ")
        demands = Demands(lambda consumer: consumer not in running)
        for (message, _), demand in self._demands.items():
            if message == kind.__name__ and demand.size != 0:
                demands.note(demand)
        return demands.merged.get(kind.__name__)
