"""How far a sky is from the truth, its scale taken out."""

from typing import NamedTuple

import numpy as np

from vrut_lite.geometry.colour import SRGB_FROM_XYZ, luminance
from vrut_lite.numeric_types import FloatArray
from vrut_lite_lab.study.peers.truth import Truth
from vrut_lite_lab.study.peers.views import SkyViewpoint, rays

_XYZ_FROM_SRGB = np.linalg.inv(SRGB_FROM_XYZ)
# Of the brightest: what is darker is no part of a picture (sky beside the Earth from space).
_DARK = 1e-4


class ViewScore(NamedTuple):
    """Errors of a sky at a view.

    Attributes:
        level: its mean luminance over the truth's, taken out of what follows.
        mean, most: relative error of luminance: mean over solid angle, and what 99 % of the solid
            angle stay below.
        colour: mean distance in CIE 1976 u'v', times 1000; NaN of a sky without colour.
        noise: relative standard error of the truth itself.
    """

    level: float
    mean: float
    most: float
    colour: float
    noise: float


def score(rgb: FloatArray, known: Truth, view: SkyViewpoint, grey: bool = False) -> ViewScore:
    """The score of a sky (rows, 2 columns, 3); both its sides against the truth's one."""
    half = rgb.shape[1] // 2
    weight = rays(view).weight[known.some].ravel()
    expected = known.at_some.reshape(-1, 3)
    true = np.asarray(luminance(expected))
    counts = true > _DARK * true.max()
    sides = [rgb[:, half:], rgb[:, :half][:, ::-1]]
    found = np.concatenate([side[known.some].reshape(-1, 3)[counts] for side in sides])
    expected, true, weight = (
        np.concatenate([part[counts]] * 2) for part in (expected, true, weight)
    )
    weight = weight / weight.sum()
    seen = np.asarray(luminance(found))
    level = float(weight @ seen / (weight @ true))
    if not level > 0.0:
        return ViewScore(level, np.nan, np.nan, np.nan, known.noise)
    error = np.abs(seen / level / true - 1.0)
    order = np.argsort(error)
    most = error[order][np.searchsorted(np.cumsum(weight[order]), 0.99)]
    away = np.nan if grey else float(weight @ _distance(found, expected)) * 1000.0
    return ViewScore(level, float(weight @ error), float(most), away, known.noise)


def _distance(found: FloatArray, expected: FloatArray) -> FloatArray:
    apart = _chromaticity(found) - _chromaticity(expected)
    return np.asarray(np.hypot(*apart.T))


def _chromaticity(rgb: FloatArray) -> FloatArray:
    """CIE 1976 u'v' (n, 2)."""
    x, y, z = (rgb @ _XYZ_FROM_SRGB.T).T
    below = np.maximum(x + 15.0 * y + 3.0 * z, 1e-30)
    return np.stack([4.0 * x / below, 9.0 * y / below], axis=1)
