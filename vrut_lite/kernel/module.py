"""The contract between the kernel and a module."""

from collections.abc import Callable, Iterator
from typing import Any, ClassVar, Literal, Protocol, TypeVar

import msgspec

from vrut_lite.kernel.messages import Demand, Derived, Encoding, Input, Message
from vrut_lite.kernel.work_counters import WorkCounters

M = TypeVar("M", bound=Message)
Handler = Callable[[Any, Any], None]
# Role of a job's result in the revision that started it. "awaited": the revision is not whole
# without it; "drafted": a draft stands in for it; "refines": it makes a present part finer;
# "aside": it is no part of the revision.
Role = Literal["aside", "refines", "drafted", "awaited"]


class Manifest(msgspec.Struct, frozen=True, kw_only=True):
    """A module's name, the slots that it can hold and those that it requires.

    It holds none before each slot that it `requires` has had a holder. One that does not `stand_in`
    holds a slot only when it is chosen, never as a replacement. An `auxiliary` module is a tool:
    commands offer its settings by `--set` alone, and the window hides its panel at first. A module
    that has `open_engine` is chosen to draw by the name of its `engine`. `host` names the versions
    of vrut_lite that it is for, such as ">=1.0,<2"; an empty one fits all.
    """

    name: str
    title: str
    version: str
    provides: tuple[str, ...] = ()
    requires: tuple[str, ...] = ()
    stand_in: bool = True
    auxiliary: bool = False
    engine: str = ""
    host: str = ""


class NoSettings(msgspec.Struct, frozen=True):
    """The settings of a module that has none."""


class Link(Protocol):
    """A module's side of the kernel; the host owns it, so that nothing is left behind."""

    def post(self, message: Derived) -> None:
        """Post a message; it is delivered in this transaction, after those already queued."""

    def wanted(self, message_type: type[Message]) -> Demand | None:
        """The merged demand for a type of message, or None without demand.

        Its size is the largest that any consumer named, None where none did, and its encoding
        the most exact.
        """

    def demand(
        self, message_type: type[Message], size: int | None = None, encoding: Encoding = ""
    ) -> None:
        """Ask producers for messages of a type, this large and exact; size 0 takes it back.

        The size None leaves it to the producer.
        """

    def holds(self, slot: str) -> bool:
        """Whether this module holds the slot."""

    def last(self, message_type: type[M]) -> M | None:
        """The latest message of a type, or None.

        For a slot's types it is always the present holder's: after a switch it is None until the
        new holder has posted one.
        """

    def start_job(
        self, name: str, work: Callable[..., Any], *arguments: Any, role: Role = "aside"
    ) -> None:
        """Run `work(*arguments)` in the background; a `JobResult` brings what it returns.

        Work is a plain function of its arguments, which must not be changed; if it has a
        parameter named `control` it gets a `JobControl`. One job of a name runs and one waits,
        the latest. A replay does the work where its result was admitted, or never.

        `role` is the role of the result in the present revision; "awaited": pictures show the
        revision only with it. Jobs that its result starts belong to the same revision.
        """

    def await_result(self, name: str) -> None:
        """Let the present revision await a `JobResult` of this name that the GPU brings."""

    def cancel_job(self, name: str) -> None:
        """Forget the running and the waiting job of a name: neither brings a result."""


def handles(*message_types: type[Message]) -> Callable[[Handler], Handler]:
    """Mark a method as the handler of message types (those very types, not their subclasses)."""

    def mark(method: Handler) -> Handler:
        method.__dict__.setdefault("handled_types", []).extend(message_types)
        return method

    return mark


class Module:
    """Base of all modules: state, settings and handlers, without a clock or a random source.

    An exception of a handler is caught and posted as a Fault; the third suspends the module.
    """

    manifest: ClassVar[Manifest]
    settings_type: ClassVar[type[msgspec.Struct]] = NoSettings
    # The module's own message types that it posts; the host's need no declaration.
    speaks: ClassVar[tuple[type[Message], ...]] = ()
    # Inputs from outside; a live host hands its constructor `inject`, a replay does not.
    injects: ClassVar[tuple[type[Input], ...]] = ()

    def __init__(self, link: Link, settings: Any):
        self.link = link
        self.settings = settings
        self.counters = WorkCounters()

    def settings_changed(self, name: str) -> None:
        """Called after `self.settings` got a new value for `name`; override to react."""

    def snapshot(self) -> Any:
        """State for a reload's new version besides the settings: plain data, or None."""
        return None

    def restore(self, state: Any) -> None:
        """Restore the old version's `snapshot`, given as built-in types."""

    @classmethod
    def handlers(cls) -> Iterator[tuple[type[Message], str]]:
        """Message type and method name of every handler, in order of declaration."""
        seen: dict[str, list[type[Message]]] = {}
        for base in reversed(cls.__mro__):
            for name, member in vars(base).items():
                if hasattr(member, "handled_types"):
                    seen[name] = member.handled_types
        for name, types in seen.items():
            for message_type in types:
                yield message_type, name
