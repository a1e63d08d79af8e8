"""The contract between the kernel and a module."""

from collections.abc import Callable, Iterator
from typing import Any, ClassVar, Protocol, TypeVar

import msgspec

from vrut_lite.kernel.ledger import Ledger
from vrut_lite.kernel.messages import Demand, Derived, Message

M = TypeVar("M", bound=Message)
Handler = Callable[[Any, Any], None]


class Manifest(msgspec.Struct, frozen=True, kw_only=True):
    """What a module is called, which slots it can hold and which it needs filled."""

    name: str
    title: str
    version: str
    provides: tuple[str, ...] = ()
    requires: tuple[str, ...] = ()


class NoSettings(msgspec.Struct, frozen=True):
    """The settings of a module that has none."""


class Link(Protocol):
    """A module's side of the kernel; the host owns it, so that nothing is left behind."""

    def post(self, message: Derived) -> None:
        """Say something; it is delivered in this transaction, after what is already queued."""

    def wanted(self, message_type: type[Message]) -> Demand | None:
        """The largest demand for a type of message, or None when nobody wants it."""

    def holds(self, slot: str) -> bool:
        """Whether this module holds the slot."""

    def last(self, message_type: type[M]) -> M | None:
        """The latest message of a type, from whoever holds it, or None."""


def handles(message_type: type[Message]) -> Callable[[Handler], Handler]:
    """Mark a method as the handler of a message type (that very type, not its subclasses)."""

    def mark(method: Handler) -> Handler:
        method.__dict__.setdefault("handled_types", []).append(message_type)
        return method

    return mark


class Module:
    """Base of all modules: state, settings and handlers, without a clock or a random source.

    A handler that raises is caught, told as a Fault, and suspends the module at the third.
    """

    manifest: ClassVar[Manifest]
    settings_type: ClassVar[type[msgspec.Struct]] = NoSettings

    def __init__(self, link: Link, settings: Any):
        self.link = link
        self.settings = settings
        self.ledger = Ledger()

    def settings_changed(self, name: str) -> None:
        """Called after `self.settings` got a new value for `name`; override to react."""

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
