"""The published tables that the evaluation rests on, each in a file that names its source."""

from functools import lru_cache
from importlib.resources import files

import numpy as np
from numpy.typing import NDArray

from vrut_lite_lab.study.framework.spectra import resampled


@lru_cache(maxsize=8)
def table_spectra(name: str) -> NDArray[np.float64]:
    """The columns (columns, 40) of a table beside its wavelengths, as spectra.

    `name` is that of a file of `data/` without its `.csv`.
    """
    source = files("vrut_lite_lab.study.framework") / "data" / f"{name}.csv"
    with source.open(encoding="utf-8") as lines:
        table = np.loadtxt(lines, delimiter=",")
    spectra = resampled(table[:, 0], table[:, 1:].T)
    spectra.flags.writeable = False
    return spectra
