"""A Zenoh session, with the operations that the bridge needs; the only use of eclipse-zenoh.

Callbacks run on Zenoh's own threads (`indirect=False`), because its separate callback threads
would keep a program from ending. So callbacks must be short.
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


class BridgeSession:
    """An open Zenoh session that does not receive its own messages.

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
        """Send to all other listeners; blocks while the line is full."""
        self._session.put(
            key,
            data,
            congestion_control=self._zenoh.CongestionControl.BLOCK,
            allowed_destination=self._zenoh.Locality.REMOTE,
        )

    def listen(self, key: str, on_data: OnData) -> None:
        """Receive what others send under a key."""

        def take(sample: Any) -> None:
            on_data(str(sample.key_expr), sample.payload.to_bytes())

        self._kept.append(
            self._session.declare_subscriber(
                key, self._direct(take), allowed_origin=self._zenoh.Locality.REMOTE
            )
        )

    def serve(self, key: str, on_query: OnQuery) -> None:
        """Receive queries for a key; see `answer`."""
        self._kept.append(self._session.declare_queryable(key, self._direct(on_query)))

    def answer(self, query: Any, data: bytes | None) -> None:
        """Answer a query; None: there is no such array."""
        if data is not None:
            query.reply(query.key_expr, data)
        query.drop()

    def fetch(self, key: str) -> Iterator[bytes]:
        """The replies of others for a key, in order; empty without a reply in time."""
        replies = self._session.get(
            key,
            timeout=FETCH_TIMEOUT_S,
            consolidation=self._zenoh.ConsolidationMode.NONE,
            allowed_destination=self._zenoh.Locality.REMOTE,
        )
        return (reply.ok.payload.to_bytes() for reply in replies if reply.ok is not None)

    def show(self, key: str) -> Any:
        """Declare a liveliness token, visible to others while this process lives."""
        return self._session.liveliness().declare_token(key)

    def hide(self, token: Any) -> None:
        """Withdraw a token."""
        token.undeclare()

    def watch(self, key: str, on_token: OnToken) -> None:
        """Observe the tokens of others, including those that exist already."""

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
