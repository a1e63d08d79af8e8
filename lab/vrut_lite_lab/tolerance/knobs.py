"""A declaration of the sizes that a module chooses by the tolerance, for measuring fronts.

`vrut_lite_lab.tolerance_fronts` measures the fronts of error against work of any module for which
there is a `KNOBS`, a `ToleranceKnobs`: of ours in a file of this folder by the module's name, of
others in `tolerance_knobs.py` beside the file of the module's class, or in that file.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Generic, TypeVar

import numpy as np
from numpy.typing import NDArray

from vrut_lite.numeric_types import FloatArray

S = TypeVar("S")
Truth = list[FloatArray]
# A value darker than this share of a picture's brightest is measured by that share.
FLOOR = 1e-3
# The share of directions, and of pictures, that an error refers to.
MOST = 0.99


@dataclass(frozen=True)
class Knob(Generic[S]):
    """A size, or a named set of sizes, that follows the tolerance.

    Attributes:
        choices: from the least to the most work.
        errors: (pictures, choices) relative errors of a sample's pictures for each choice, all
            other knobs at their usual values, given the sample's truth.
        work: counted work of a choice; only comparable within this knob.
        run: the work itself, whose CPU time is measured.
    """

    choices: tuple[int | str, ...]
    errors: Callable[[S, Truth], FloatArray]
    work: Callable[[Any], float]
    run: Callable[[Any], object]


@dataclass(frozen=True)
class ToleranceKnobs(Generic[S]):
    """A module's knobs and the random pictures that they are measured on.

    Attributes:
        fronts: the file from which the module reads its fronts.
        knobs: by the names of the fronts.
        samples: two lists of random samples, always the same for a number of pictures: one to
            measure the fronts, another to check the tolerances. A sample may have several pictures.
        truth: a sample's exact or converged radiance.
        picture_errors: relative error of each of a sample's pictures, given its truth, with
            everything that the module chooses at a tolerance.
        tolerances: those that are checked.
    """

    fronts: Path
    knobs: Mapping[str, Knob[S]]
    samples: Callable[[int], tuple[list[S], list[S]]]
    truth: Callable[[S], Truth]
    picture_errors: Callable[[S, Truth, float], list[float]]
    tolerances: tuple[float, ...] = (0.3, 0.1, 0.03, 0.01, 0.003, 0.001)


def picture_error(seen: NDArray[np.floating], exact: FloatArray) -> float:
    """The relative error that 99 % of a picture's directions stay within, of arrays (n, 3)."""
    relative = np.abs(seen - exact) / np.maximum(exact, FLOOR * exact.max())
    return float(np.quantile(relative, MOST))
