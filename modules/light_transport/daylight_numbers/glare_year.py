"""Daylight glare probability of an eye in each hour of a year.

Vertical illuminance is that of the year's product. Sources of glare are all that is bright, as in
the hour: sky, sunlit surfaces, the sun's disc and its mirror images.
"""

import numpy as np

from light_transport.daylight_numbers.annual import (
    LUMENS_RGB,
    SolvedYear,
    year_matrices,
    year_of,
)
from light_transport.daylight_numbers.eye_view import SUN_SR, Eye
from light_transport.daylight_numbers.eye_year import EyeYear
from light_transport.daylight_numbers.glare import EN_GLARE, Sources, bright_parts, dgp_of
from light_transport.daylight_numbers.metrics import OCCUPIED_H, occupied
from light_transport.daylight_numbers.mirrored_sun import Flats, mirrored_suns
from light_transport.daylight_numbers.work import Work
from light_transport.daylight_numbers.year_light import YearLight
from light_transport.giving_up import CancelCheck, always
from vrut_lite.numeric_types import FloatArray

# EN 17037: DGP is above its limit in so many of the hours at most.
_SHARE_OF_HOURS = 0.05


def glare_year(
    work: Work, flats: Flats, light: YearLight, solved: SolvedYear, go_on: CancelCheck = always
) -> FloatArray:
    """DGP (P, H) of the eyes that `work` has as sensors; 0 outside 8:00 to 18:00.

    Raises:
        GivenUp: by `go_on`.
    """
    vertical = year_of(year_matrices(work, light, solved, go_on), light).total.astype(float)
    found = np.zeros(vertical.shape)
    hours = np.flatnonzero(occupied(light))
    sun_lx = light.sun_irradiance_rgb @ LUMENS_RGB
    for n, (place, towards) in enumerate(
        zip(work.sensors.places_m, work.sensors.normals, strict=True)
    ):
        eye = Eye(place, towards)
        seen = EyeYear(work, eye, light, solved, hours)
        for hour in hours.tolist():
            go_on()
            sources = [bright_parts(seen.hemisphere, seen.luminance(hour))]
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
