"""Tables that follow from formulas alone, kept on disk."""

import hashlib
from collections.abc import Callable
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from vrut_lite.array_cache import ArrayCache

_LIMIT_BYTES = 1 << 24


def kept_table(make: Callable[[], NDArray[np.float32]], *sources: str) -> NDArray[np.float32]:
    """What `make` makes, or made in another session by the same source files; read-only."""
    recipe = [hashlib.blake2b(Path(source).read_bytes()).hexdigest() for source in sources]
    tables = ArrayCache.of_user("tables_of_formulas", _LIMIT_BYTES)
    kept = tables.get((make.__name__, recipe))
    table = make() if kept is None else kept["table"]
    if kept is None:
        tables.put((make.__name__, recipe), {"table": table})
    table.flags.writeable = False
    return table
