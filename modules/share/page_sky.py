"""The sky of a page as its script reads it: tables, places of sun and moon, and clouds."""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from share.air_table import BELOW
from share.cloud_maps import GLOW_POWER, GLOW_RAD, MOST_FINER, CloudMaps
from share.sky_table import LOWER, SkyTable
from share.sun_places import DUSK_RAD, MOST_DECLINATION_RAD, TAKES_OVER_RAD, SunPlaces
from vrut_lite.messages.night import MoonLight


def about_places(places: SunPlaces) -> dict[str, Any]:
    """The places of the sun, as `page/src/places.js` reads them."""
    return {
        "declinations": places.declinations,
        "hours": places.hours,
        "most_declination": MOST_DECLINATION_RAD,
        "day_nodes": places.day_nodes.tolist(),
        "first_of_dusk": places.first_of_dusk,
        "dusk_rad": DUSK_RAD.tolist(),
        "dusk_azimuths": places.dusk_azimuths,
        "takes_over_rad": TAKES_OVER_RAD,
    }


def about_sky(table: SkyTable) -> dict[str, Any]:
    """The table of the sky, without its radiances, as `page/src/sky.js` reads it."""
    return {
        "lower": LOWER,
        "below": BELOW,
        "true_rad": table.true_rad.tolist(),
        "apparent_rad": table.apparent_rad.tolist(),
        "level": table.level_rgb.tolist(),
        "key": table.key.tolist(),
        "ground": table.ground.tolist(),
        "albedo": table.albedo_rgb.tolist(),
    }


def about_clouds(maps: CloudMaps) -> dict[str, Any]:
    """Frozen clouds without their arrays, as `page/src/clouds.js` reads them."""
    return {
        "places": about_places(maps.places),
        "finer": MOST_FINER,
        "glow_power": GLOW_POWER,
        "glow_rad": GLOW_RAD,
    }


def cloud_arrays(maps: CloudMaps) -> dict[str, NDArray]:
    """The arrays of frozen clouds; terms as planes (2, K, h, w) of low and high bytes, which count
    from 128."""
    whole = maps.terms.astype(np.int32) + 128
    terms = np.stack([whole & 255, (whole >> 8) + 128]).astype(np.uint8)
    return {
        "cloud_passed": maps.passed,
        "cloud_kept": np.stack([maps.kept, maps.finer]),
        "cloud_terms": terms,
        "cloud_light": np.concatenate([maps.by_sun, maps.by_night[None]]),
        "cloud_glow": maps.glow,
    }


def moon_table(moons: list[MoonLight]) -> dict[str, Any] | None:
    """Moonlight at its mean distance as shares of sunlight, by phase angle."""
    found = []
    for moon in moons:
        phase = math.degrees(math.acos(np.clip(2.0 * moon.lit_fraction - 1.0, -1.0, 1.0)))
        near = math.asin(1737.4 / 384_400.0) / moon.angular_radius_rad
        share = np.maximum(moon.of_sunlight_rgb, 1e-30) * near**2
        found.append((phase, np.log(share).tolist()))
    if len(found) < 2:
        return None
    found.sort()
    return {"phase_deg": [phase for phase, _ in found], "log_share": [row for _, row in found]}
