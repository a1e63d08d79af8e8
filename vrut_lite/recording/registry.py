"""The message types that a journal may hold, by name: nothing else is ever decoded."""

from collections.abc import Iterable

from vrut_lite.errors import UserError
from vrut_lite.kernel.messages import KERNEL_MESSAGES, Input, Message
from vrut_lite.kernel.module import Module
from vrut_lite.messages.vocabulary import DAYLIGHT_MESSAGES


class Registry:
    """Message types of the kernel, of daylight and of the given modules, by name.

    A module's types are those that it handles, and those that it declares in `speaks`.

    Raises:
        UserError: two types share a name, so that a journal could mean either.
    """

    def __init__(self, modules: Iterable[type[Module]] = ()):
        self._types: dict[str, type[Message]] = {}
        self._add_all(KERNEL_MESSAGES)
        self._add_all(DAYLIGHT_MESSAGES)
        for module in modules:
            self._add_all(module.speaks)
            self._add_all(kind for kind, _ in module.handlers())

    def find(self, name: str) -> type[Message]:
        """The type of this name.

        Raises:
            UserError: the type is unknown.
        """
        if name not in self._types:
            raise UserError(
                f"the message type {name!r} is unknown: it was renamed or removed, "
                "or its module is not installed"
            )
        return self._types[name]

    def find_input(self, name: str) -> type[Input]:
        """The type of input of this name; UserError if it is unknown or derived."""
        kind = self.find(name)
        if not issubclass(kind, Input):
            raise UserError(f"{name} is no input: only a handler may say it")
        return kind

    def inputs(self) -> list[type[Input]]:
        """Every type of input."""
        return [kind for kind in self._types.values() if issubclass(kind, Input)]

    def _add_all(self, types: Iterable[type[Message]]) -> None:
        for kind in types:
            known = self._types.setdefault(kind.__name__, kind)
            if known is not kind:
                raise UserError(
                    f"two message types are called {kind.__name__}, in {known.__module__} and "
                    f"{kind.__module__}: rename one"
                )
