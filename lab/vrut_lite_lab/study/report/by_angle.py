"""Relative errors by angle from the sun and by the sun's elevation, beside the instruments' own."""

from collections.abc import Sequence
from io import BytesIO
from typing import Any, NamedTuple

import numpy as np

from vrut_lite.numeric_types import FloatArray
from vrut_lite_lab.study.framework.directions import directions
from vrut_lite_lab.study.framework.errors import relative_error
from vrut_lite_lab.study.models.model import SkyModel, cosines
from vrut_lite_lab.study.report.moments import Moment
from vrut_lite_lab.study.report.skies import directional_radiance

EDGES_DEG = (0, 10, 20, 30, 45, 60, 90, 120, 180)
# What spectroradiometers err by: calibration, stray light and pointing together.
INSTRUMENT = (0.03, 0.05)


class ErrorsByAngle(NamedTuple):
    """Root mean square relative errors of one model; NaN where nothing was measured.

    Attributes:
        from_sun: for each pair of `EDGES_DEG`.
        of_moments: for each moment.
    """

    title: str
    from_sun: tuple[float, ...]
    of_moments: tuple[float, ...]


def errors_by_angle(
    model: SkyModel, moments: Sequence[Moment], reference: FloatArray
) -> ErrorsByAngle:
    """The errors of a model against radiance (moments, 81, 40)."""
    seen = np.stack([directional_radiance(model, moment) for moment in moments])
    squares = relative_error(seen, reference) ** 2
    zenith, azimuth = directions()
    gamma_deg = np.degrees(
        [
            np.arccos(cosines(m.sun_zenith_rad, zenith, azimuth - m.sun_azimuth_rad).nu)
            for m in moments
        ]
    )
    found = np.digitize(gamma_deg, EDGES_DEG[1:-1])
    bins = (squares[found == n] for n in range(len(EDGES_DEG) - 1))
    from_sun = tuple(float(np.sqrt(some.mean())) if some.size else np.nan for some in bins)
    return ErrorsByAngle(model.title, from_sun, tuple(np.sqrt(squares.mean(axis=1)).tolist()))


def plot_by_angle(errors: Sequence[ErrorsByAngle], moments: Sequence[Moment]) -> bytes:
    """PNG: two panels, a line for each model, the instruments' own error as a band."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(11.0, 4.4), layout="constrained")
    left, right = figure.subplots(1, 2)
    middles = 0.5 * (np.array(EDGES_DEG[1:]) + np.array(EDGES_DEG[:-1]))
    elevation = 90.0 - np.degrees([moment.sun_zenith_rad for moment in moments])
    order = np.argsort(elevation)
    for n, each in enumerate(errors):
        # Colours repeat after ten lines.
        look: dict[str, Any] = {"marker": "os^"[n // 10 % 3], "ls": "--" if n // 10 % 2 else "-"}
        look |= {"color": f"C{n % 10}", "ms": 3, "lw": 1}
        left.plot(middles, 100.0 * np.array(each.from_sun), label=each.title, **look)
        right.plot(elevation[order], 100.0 * np.array(each.of_moments)[order], **look)
    for axis, title in ((left, "angle from the sun"), (right, "elevation of the sun")):
        axis.axhspan(*(100.0 * share for share in INSTRUMENT), color="0.8", zorder=0)
        axis.set(xlabel=f"{title} in degrees", ylabel="rms relative error in %", yscale="log")
        axis.grid(alpha=0.3)
    figure.legend(loc="outside lower center", ncols=4, fontsize=7)
    figure.suptitle("Grey: the 3 to 5 % that instruments themselves err by")
    into = BytesIO()
    figure.savefig(into, format="png", dpi=110)
    return into.getvalue()
