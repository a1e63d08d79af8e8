"""Daylight glare probability of an eye in each hour of a year.

Vertical illuminance is that of the year's product. Sources of glare are the sky, the sun's disc and
its mirror images; sunlit surfaces count by their light at the eye alone.
"""

import numpy as np

from light_transport.daylight_numbers.annual import (
    LUMENS_RGB,
    SolvedYear,
    year_matrices,
    year_of,
)
from light_transport.daylight_numbers.eye_view import SUN_SR, Eye
from light_transport.daylight_numbers.glare import EN_GLARE, THRESHOLD, Sources, dgp_of
from light_transport.daylight_numbers.metrics import OCCUPIED_H, occupied
from light_transport.daylight_numbers.mirrored_sun import Flats, mirrored_suns
from light_transport.daylight_numbers.sky_cells import CELLS, cell_directions, node_of_cell
from light_transport.daylight_numbers.work import Work
from light_transport.daylight_numbers.year_light import YearLight
from light_transport.giving_up import GoOn, always
from vrut_lite.numeric_types import FloatArray

# EN 17037: DGP is above its limit in so many of the hours at most.
_SHARE_OF_HOURS = 0.05
_LEAST_COSINE = 0.02


def glare_year(
    work: Work, flats: Flats, light: YearLight, solved: SolvedYear, go_on: GoOn = always
) -> FloatArray:
    """DGP (P, H) of the eyes that `work` has as sensors.

    Raises:
        GivenUp: by `go_on`.
    """
    vertical = year_of(year_matrices(work, light, solved, go_on), light).total.astype(float)
    found = np.zeros(vertical.shape)
    luminances = light.sky @ LUMENS_RGB
    sun_lx = light.sun_irradiance_rgb @ LUMENS_RGB
    for n, (place, towards) in enumerate(
        zip(work.sensors.places_m, work.sensors.normals, strict=True)
    ):
        eye = Eye(place, towards)
        cells, weight = _sky_seen(work, n)
        direction = cell_directions().mean(axis=1)[cells] @ eye.axes.T
        solid = weight / np.maximum(direction[:, 2], _LEAST_COSINE)
        node = node_of_cell()[cells]
        for hour in range(len(light.hour)):
            go_on()
            bright = luminances[hour, node] > THRESHOLD
            sources = [
                _one_source(luminances[hour, node[bright]], solid[bright], direction[bright])
            ]
            if sun_lx[hour] > 0.0:
                sources.append(_discs(work, flats, eye, light, hour))
            found[n, hour] = dgp_of(tuple(sources), vertical[n, hour])
    return found


def en_level(dgp: FloatArray, light: YearLight) -> tuple[str, FloatArray]:
    """EN 17037's level of an eye's year (H,), and the share of 8:00 to 18:00 above each limit."""
    used = dgp[occupied(light)]
    shares = np.array([(used > limit).sum() / OCCUPIED_H for _, limit in EN_GLARE])
    reached = [
        name for (name, _), share in zip(EN_GLARE, shares, strict=True) if share <= _SHARE_OF_HOURS
    ]
    return (reached[0] if reached else "none"), shares


def _sky_seen(work: Work, eye: int) -> tuple[np.ndarray, FloatArray]:
    """Cells of the sky that an eye sees, and their solid angles times cosine and transmittance."""
    one, other = (half.seen[len(half.seen) // 2][eye, :CELLS] for half in work.operator.halves)
    both = (0.5 * (one + other)).tocoo()
    return both.col, both.data


def _one_source(luminance: FloatArray, solid: FloatArray, direction: FloatArray) -> Sources:
    """The bright sky as one source, as far as it is seen."""
    if not len(luminance):
        return Sources(np.empty(0), np.empty(0), np.empty((0, 3)))
    weight = luminance * solid
    middle = (weight[:, None] * direction).sum(axis=0)
    total = solid.sum()
    return Sources(
        np.array([weight.sum() / total]), np.array([total]), middle[None] / np.linalg.norm(middle)
    )


def _discs(work: Work, flats: Flats, eye: Eye, light: YearLight, hour: int) -> Sources:
    towards, irradiance = mirrored_suns(
        work.bake,
        work.glass,
        flats,
        eye.place_m,
        light.sun_direction[hour],
        light.sun_irradiance_rgb[hour],
    )
    seen = towards @ eye.towards > 0.0
    lux = irradiance[seen] @ LUMENS_RGB
    return Sources(lux / SUN_SR, np.full(len(lux), SUN_SR), towards[seen] @ eye.axes.T)
