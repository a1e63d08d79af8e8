"""Brightness, horizon and highlight of skies, in numbers instead of the paper's figures."""

from collections.abc import Iterator
from typing import NamedTuple, cast

import numpy as np
from bruneton_sky.published.classical_rules import RULES
from bruneton_sky.published.single_scattering import Rule

from vrut_lite_lab.study.framework.colour import srgb, tone_mapped, xyz
from vrut_lite_lab.study.framework.fisheye import pixels
from vrut_lite_lab.study.models.converged import Converged
from vrut_lite_lab.study.models.model import SkyModel
from vrut_lite_lab.study.models.rules import SingleScattering, converged
from vrut_lite_lab.study.report.scores import WHOLE_SHARE
from vrut_lite_lab.study.rules.against_truth import SAMPLES

_SUNS_DEG = (87.0, 25.0)
_HORIZON_DEG, _WHITE = 82.0, 0.9


class Look(NamedTuple):
    """One sky compared with that of all orders of scattering.

    Attributes:
        brightness: mean luminance, by solid angle, over the other's.
        off: mean difference of the decimal logarithms of luminance.
        relative_off: rms relative error of luminance over the zenith's.
        horizon: shares of red, green and blue of the light below 8 deg of elevation.
        white: share of the sky whose tone-mapped colour is above 0.9 in every channel.
    """

    brightness: float
    off: float
    relative_off: float
    horizon: tuple[float, float, float]
    white: float


def look(model: SkyModel, reference: SkyModel, sun_zenith_deg: float, size: int = 48) -> Look:
    """How a model's sky looks in a picture of `size` pixels across."""
    at, sun = pixels(size), float(np.radians(sun_zenith_deg))
    # An even angle a pixel: each stands for a solid angle of sin(zenith) / zenith.
    weight = np.sin(at.zenith_rad) / at.zenith_rad
    weight /= weight.sum()
    seen, right = (m.sky_radiance(sun, at.zenith_rad, at.azimuth_rad) for m in (model, reference))
    luminance, other = xyz(seen)[:, 1], xyz(right)[:, 1]
    middle = int(np.argmin(at.zenith_rad))
    relative = luminance / luminance[middle] * other[middle] / other
    low = srgb(seen[at.zenith_rad > np.radians(_HORIZON_DEG)]).sum(axis=0)
    red, green, blue = map(float, low / low.sum())
    return Look(
        float((weight * luminance).sum() / (weight * other).sum()),
        float(np.abs(np.log10(luminance / other)).mean()),
        float(np.sqrt(((relative - 1.0) ** 2).mean())),
        (red, green, blue),
        float(weight[tone_mapped(srgb(seen)).min(axis=-1) > _WHITE].sum()),
    )


def report() -> Iterator[str]:
    """A table of text."""
    reference = Converged()
    skies: dict[str, SkyModel] = {"all orders": reference, "single scattering": converged()}
    for pair in SAMPLES[:2]:
        for rule in RULES:
            for quirks, said in ((None, ""), (WHOLE_SHARE, ", whole share before")):
                name = f"{rule} {pair[0]}x{pair[1]}{said}"
                skies[name] = SingleScattering(cast(Rule, rule), pair, quirks)
    for sun in _SUNS_DEG:
        yield f"sun {sun:g} deg from the zenith: brightness, off, relative off, horizon, white"
        for shown, sky in skies.items():
            got = look(sky, reference, sun)
            horizon = "/".join(f"{share:.2f}" for share in got.horizon)
            yield (
                f"  {shown}: {got.brightness:.2f} {got.off:.3f} {got.relative_off:.3f} "
                f"{horizon} {got.white:.4f}"
            )
