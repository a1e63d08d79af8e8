"""The inputs that the bridge injects for everything that it receives."""

from typing import Any, ClassVar, Self

from vrut_lite.kernel.messages import Input


class RemoteMessage(Input, frozen=True, kw_only=True):
    """A message from another process; the latest of each type counts.

    `fields` are the message's fields in plain form, with arrays in place of their handles.
    """

    by_stranger: ClassVar[bool] = True

    type_name: str
    fields: dict[str, Any]

    def key(self) -> str:
        """One pending message per type."""
        return self.type_name


class BridgeState(Input, frozen=True, kw_only=True):
    """The bridge's state in one sentence; `failed` if the user must correct something."""

    sentence: str
    peers: int = 0
    failed: bool = False

    def key(self) -> None:
        """No key: every change counts, and none is repeated to a restarted bridge."""


class BridgeTrouble(Input, frozen=True, kw_only=True):
    """`count` frames or arrays were refused or could not be fetched; the last one's reason."""

    by_stranger: ClassVar[bool] = True

    sentence: str
    count: int = 1

    def key(self) -> None:
        """No key: every refusal counts, and none is repeated to a restarted bridge."""

    def merged(self, older: Self) -> Self:
        """The later sentence, and the sum of the counts."""
        return type(self)(sentence=self.sentence, count=self.count + older.count)
