"""RMSE and relative error of models against measurements, or against the converged sky."""

from collections.abc import Callable, Sequence
from typing import NamedTuple, cast

import numpy as np
from bruneton_sky.published.classical_rules import RULES
from bruneton_sky.published.single_scattering import Rule

from vrut_lite.numeric_types import FloatArray
from vrut_lite_lab.study.framework.errors import relative_error, rmse, total_rmse
from vrut_lite_lab.study.models.model import SkyModel
from vrut_lite_lab.study.models.rules import Quirks, SingleScattering
from vrut_lite_lab.study.report.moments import Moment
from vrut_lite_lab.study.report.skies import directional_radiance
from vrut_lite_lab.study.rules.against_truth import SAMPLES

# Galaj and Wojciechowski 2019, table 2: mW m^-2 sr^-1 nm^-1 against all 17 scans.
PUBLISHED_RMSE = {
    (16, 8): {"midpoint": 32.2, "trapezoid": 33.7, "simpson": 31.3},
    (128, 64): {"midpoint": 26.3, "trapezoid": 26.2, "simpson": 26.4},
    (512, 256): {"midpoint": 25.6, "trapezoid": 25.6, "simpson": 25.6},
}
# The one fault of the same authors' program that their table shows.
WHOLE_SHARE = Quirks(whole_share=True, eye_sun_length=False, white_aerosol=False)


class ModelScore(NamedTuple):
    """Errors of a model against the references of all moments.

    Attributes:
        rmse_mw: over all moments, mW m^-2 sr^-1 nm^-1; `each_mw` that of every moment.
        bias, rms: mean and root mean square of the relative errors at the 81 directions.
    """

    name: str
    title: str
    rmse_mw: float
    each_mw: tuple[float, ...]
    bias: float
    rms: float


class TableTwo(NamedTuple):
    """A line of the paper's table 2 beside ours, by the rule itself and by the paper's program."""

    rule: str
    samples: tuple[int, int]
    published_mw: float
    ours_mw: float
    whole_share_mw: float
    ours_rms_percent: float


def references(moments: Sequence[Moment], physics: SkyModel) -> FloatArray:
    """Radiance (moments, 81, 40): measured, or computed where there is no measurement."""
    return np.stack(
        [
            directional_radiance(physics, moment) if moment.measured is None else moment.measured
            for moment in moments
        ]
    )


def score(model: SkyModel, moments: Sequence[Moment], reference: FloatArray) -> ModelScore:
    """The score of one model against radiance (moments, 81, 40)."""
    seen = np.stack([directional_radiance(model, moment) for moment in moments])
    each, off = 1e3 * rmse(seen, reference), relative_error(seen, reference)
    rms = float(np.sqrt((off**2).mean()))
    return ModelScore(
        model.name, model.title, total_rmse(each), tuple(map(float, each)), float(off.mean()), rms
    )


def table_two(
    moments: Sequence[Moment],
    samples: Sequence[tuple[int, int]] = SAMPLES,
    tell: Callable[[str], None] = lambda _: None,
) -> list[TableTwo]:
    """The paper's table 2 against measured moments."""
    measured = np.stack([moment.measured for moment in moments if moment.measured is not None])
    lines = []
    for pair in samples:
        for rule in RULES:
            tell(f"table 2: {rule}, {pair[0]} x {pair[1]}")
            ours, theirs = (
                score(SingleScattering(cast(Rule, rule), pair, quirks), moments, measured)
                for quirks in (None, WHOLE_SHARE)
            )
            found = ours.rmse_mw, theirs.rmse_mw, 100.0 * ours.rms
            lines.append(TableTwo(rule, pair, PUBLISHED_RMSE[pair][rule], *found))
    return lines
