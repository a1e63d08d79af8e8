"""Tables that follow from formulas alone, kept on disk."""

import hashlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

from numpy.typing import NDArray

from vrut_lite.array_cache import ArrayCache

_LIMIT_BYTES = 1 << 24


def kept_table(name: str, make: Callable[[], NDArray[Any]], *sources: str) -> NDArray[Any]:
    """The table of `make`, or its copy of another session with the same source files; read-only."""
    digests = [hashlib.blake2b(Path(source).read_bytes()).hexdigest() for source in sources]
    tables = ArrayCache.of_user("tables_of_formulas", _LIMIT_BYTES, warns=False)
    recipe = name, digests
    kept = tables.get(recipe)
    if kept is None:
        kept = {"table": make()}
        tables.put(recipe, kept)
    kept["table"].flags.writeable = False
    return kept["table"]
