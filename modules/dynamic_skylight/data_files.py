"""The tables that the package carries."""

import zipfile
from importlib.resources import files

import numpy as np
from numpy.typing import NDArray


def packaged_arrays(name: str) -> dict[str, NDArray[np.float64]]:
    """The arrays of a file of the package's data folder, by name.

    Raises:
        RuntimeError: the file is missing, cut short or no archive of arrays, in one sentence.
    """
    source = files("dynamic_skylight") / "data" / name
    try:
        with source.open("rb") as stream, np.load(stream, allow_pickle=False) as archive:
            return {key: np.asarray(archive[key]) for key in archive.files}
    except (OSError, ValueError, EOFError, AttributeError, zipfile.BadZipFile) as error:
        raise RuntimeError(
            f"the package's data file {name} is missing or damaged: install vrut_lite anew"
        ) from error
