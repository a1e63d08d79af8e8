"""The only place that touches eclipse-zenoh: a session with what the bridge needs of it.

Callbacks run on Zenoh's own threads (`indirect=False`): its threads for callbacks would keep
a program from ending. So whoever gives a callback only takes note in it.
"""

import contextlib
import json
from collections.abc import Callable, Iterator
from typing import Any

from vrut_lite.errors import UserError

FETCH_TIMEOUT_S = 10.0

OnData = Callable[[str, bytes], None]
OnToken = Callable[[str, bool], None]
OnQuery = Callable[[Any], None]


class Session:
    """An open Zenoh session that says nothing to itself.

    Raises:
        UserError: eclipse-zenoh is not installed, or the session cannot be opened.
    """

    def __init__(self, config: dict[str, Any]):
        try:
            import zenoh
        except ImportError:
            raise UserError(
                "the bridge needs eclipse-zenoh: install it with pip install 'vrut-lite[bridge]'"
            ) from None
        self._zenoh = zenoh
        settings = zenoh.Config()
        try:
            for key, value in config.items():
                settings.insert_json5(key, json.dumps(value))
            self._session = zenoh.open(settings)
        except zenoh.ZError as error:
            reason = str(error).splitlines()[0].partition(" at ")[0]
            raise UserError(f"the bridge could not be opened: {reason}") from None
        self.peer = str(self._session.zid())
        self._kept: list[Any] = []

    def put(self, key: str, data: bytes) -> None:
        """Send to all who listen elsewhere; waits while the line is full."""
        self._session.put(
            key,
            data,
            congestion_control=self._zenoh.CongestionControl.BLOCK,
            allowed_destination=self._zenoh.Locality.REMOTE,
        )

    def listen(self, key: str, on_data: OnData) -> None:
        """Hear what others say under a key."""

        def take(sample: Any) -> None:
            on_data(str(sample.key_expr), sample.payload.to_bytes())

        self._kept.append(
            self._session.declare_subscriber(
                key, self._direct(take), allowed_origin=self._zenoh.Locality.REMOTE
            )
        )

    def serve(self, key: str, on_query: OnQuery) -> None:
        """Be asked for what lies under a key; see `answer`."""
        self._kept.append(self._session.declare_queryable(key, self._direct(on_query)))

    def answer(self, query: Any, data: bytes | None) -> None:
        """Answer a query, or say that there is nothing."""
        if data is not None:
            query.reply(query.key_expr, data)
        query.drop()

    def fetch(self, key: str) -> Iterator[bytes]:
        """What others hold under a key, one after the other; empty if nobody answers in time."""
        replies = self._session.get(
            key,
            timeout=FETCH_TIMEOUT_S,
            consolidation=self._zenoh.ConsolidationMode.NONE,
            allowed_destination=self._zenoh.Locality.REMOTE,
        )
        return (reply.ok.payload.to_bytes() for reply in replies if reply.ok is not None)

    def show(self, key: str) -> Any:
        """Let others see a token of this key for as long as this process lives."""
        return self._session.liveliness().declare_token(key)

    def hide(self, token: Any) -> None:
        """Take a token back."""
        token.undeclare()

    def watch(self, key: str, on_token: OnToken) -> None:
        """See the tokens of others appear and go, those that are there already included."""

        def take(sample: Any) -> None:
            on_token(str(sample.key_expr), sample.kind == self._zenoh.SampleKind.PUT)

        self._kept.append(
            self._session.liveliness().declare_subscriber(key, self._direct(take), history=True)
        )

    def close(self) -> None:
        """End the session."""
        with contextlib.suppress(self._zenoh.ZError):
            self._session.close()

    def _direct(self, callback: Callable[[Any], None]) -> Any:
        return self._zenoh.handlers.Callback(callback, indirect=False)
