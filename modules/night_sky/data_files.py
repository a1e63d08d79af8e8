"""The module's data: stars, Milky Way, and tables of publications, each read once."""

from functools import lru_cache
from importlib.resources import files

import numpy as np

from vrut_lite.numeric_types import FloatArray


@lru_cache(maxsize=1)
def night_data() -> dict[str, FloatArray]:
    """Arrays of `night.npz` by name; vrut_lite_lab.extract_night writes it."""
    with (files("night_sky") / "data" / "night.npz").open("rb") as file, np.load(file) as found:
        return {name: np.asarray(found[name], dtype=float) for name in found.files}


@lru_cache(maxsize=2)
def table(name: str) -> FloatArray:
    """The numbers of a table in a text file."""
    with (files("night_sky") / "data" / name).open(encoding="utf-8") as lines:
        return np.loadtxt(lines, delimiter=",")
