"""Reads the tables in the package's data folder."""

from importlib.resources import files

import numpy as np
from numpy.typing import NDArray

from vrut_lite.npz_arrays import read_npz

_MOST_BYTES = 1 << 28


def packaged_arrays(name: str) -> dict[str, NDArray[np.float64]]:
    """The arrays of a file of the package's data folder, by name.

    Raises:
        RuntimeError: the file is missing or damaged, in one sentence.
    """
    source = files("dynamic_skylight") / "data" / name
    try:
        with source.open("rb") as stream:
            return read_npz(stream, _MOST_BYTES)
    except (OSError, ValueError) as error:
        raise RuntimeError(
            f"the package's data file {name} is missing or damaged: install vrut_lite anew"
        ) from error
