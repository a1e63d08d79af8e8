"""Demands between processes, as Zenoh liveliness tokens.

A demand is a token `PREFIX/want/PEER/TYPE/SIZE/ENCODING`. Zenoh shows it to every process that
joins later, and withdraws it when its process ends, however that ends.
SIZE and ENCODING are `any` where the consumer leaves them to the producer.
"""

import threading
from collections.abc import Mapping
from typing import get_args

import msgspec

from vrut_lite.errors import UserError
from vrut_lite.kernel.demands import Demands
from vrut_lite.kernel.messages import Demand, Encoding
from vrut_lite.messages.sky import BackgroundChanged
from zenoh_bridge.shareable import BY_NAME

# How much is wanted: edge in texels and encoding, by type of message.
Wishes = Mapping[str, tuple[int | None, str]]

_ANY = "any"
# A process has one token for each type; a stranger could declare any number.
_MOST_TOKENS = 1024
# In letters; Zenoh's own identities have 32.
LONGEST_PEER = 64


def token_key(prefix: str, peer: str, type_name: str, size: int | None, encoding: str) -> str:
    """The token's key that stands for a demand."""
    return f"{prefix}/want/{peer}/{type_name}/{_ANY if size is None else size}/{encoding or _ANY}"


def demand_of(key: str, max_array: int) -> Demand:
    """The demand in a token's key; its consumer is unique to the token.

    Raises:
        UserError: the key is malformed, names something that does not exist, or asks for more
            than `max_array` bytes.
    """
    peer, type_name, size, encoding = [*key.rsplit("/", 4), "", "", "", ""][1:5]
    encodings = {name or _ANY: name for name in get_args(Encoding)}
    if type_name not in BY_NAME or encoding not in encodings:
        raise UserError(f"a demand for {type_name[:40]!r} as {encoding[:40]!r} was refused")
    if len(peer) > LONGEST_PEER:
        raise UserError(f"a demand of {peer[:40]!r}... was refused: the name is too long")
    is_number = size.isascii() and size.isdigit() and 0 < len(size) <= 9 and int(size)
    if not (size == _ANY or is_number):
        raise UserError(f"a demand for {type_name} in size {size[:40]!r} was refused")
    demand = Demand(
        consumer=f"{peer}/{size}/{encoding}",
        message=type_name,
        size=None if size == _ANY else int(size),
        encoding=encodings[encoding],
    )
    demand.check()
    wanted = _cube_bytes(demand)
    if type_name == BackgroundChanged.__name__ and wanted > max_array:
        raise UserError(
            f"a demand for {type_name} in size {size} was refused: it takes {wanted} bytes, "
            "raise max_array_mib on both sides"
        )
    return demand


def _cube_bytes(demand: Demand) -> int:
    """Bytes of a cube map of this size, in the demanded encoding or the usual one."""
    item = {"u8": 1, "float32": 4}.get(demand.encoding, 2)
    return 6 * (demand.size or 0) ** 2 * 3 * item


class RemoteWants:
    """The demands of all other processes, merged by type; for any thread."""

    def __init__(self, max_array: int) -> None:
        self._max_array = max_array
        self._demands = Demands(lambda consumer: False)
        self._tokens: set[str] = set()
        self._lock = threading.Lock()

    def wanted(self, type_name: str) -> Demand | None:
        """The merged demand for a type, or None."""
        return self._demands.merged.get(type_name)

    def note(self, key: str, alive: bool) -> str | None:
        """Record that a token appeared or vanished; returns the type if its demand may change.

        Raises:
            UserError: the token's key is invalid, or there are too many tokens.
        """
        demand = demand_of(key, self._max_array)
        with self._lock:
            if (key in self._tokens) == alive:
                return None
            if alive and len(self._tokens) >= _MOST_TOKENS:
                raise UserError(f"more than {_MOST_TOKENS} demands are on the bridge")
            (self._tokens.add if alive else self._tokens.discard)(key)
            change = {} if alive else {"size": 0}
            self._demands.note(msgspec.structs.replace(demand, **change))
        return demand.message
