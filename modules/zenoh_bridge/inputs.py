"""What the bridge brings from outside: all that it learns there enters its kernel as an input."""

from typing import Any, ClassVar, Self

from vrut_lite.kernel.messages import Input


class RemoteMessage(Input, frozen=True, kw_only=True):
    """Another process said a message of this type; the latest of each type counts.

    `fields` are those of the message in plain form, with arrays in place of their handles.
    """

    by_stranger: ClassVar[bool] = True

    type_name: str
    fields: dict[str, Any]

    def key(self) -> str:
        """One pending message per type."""
        return self.type_name


class BridgeState(Input, frozen=True, kw_only=True):
    """How the bridge stands, in one sentence; `failed` if the user has to mend something."""

    sentence: str
    peers: int = 0
    failed: bool = False

    def key(self) -> None:
        """Every change is told, and none again to a bridge that starts anew."""


class BridgeTrouble(Input, frozen=True, kw_only=True):
    """So many frames or arrays were refused or could not be had; why the last of them was."""

    by_stranger: ClassVar[bool] = True

    sentence: str
    count: int = 1

    def key(self) -> None:
        """Every one is counted, and none again by a bridge that starts anew."""

    def merged(self, older: Self) -> Self:
        """The later sentence, and both counts."""
        return type(self)(sentence=self.sentence, count=self.count + older.count)
