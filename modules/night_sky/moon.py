"""Where the moon stands, how it is turned and lit, for an instant and a place."""

from typing import NamedTuple

import astronomy
import numpy as np

from night_sky.moon_light import Phase
from night_sky.sky_axes import AU_KM, Watch, body_km, moon_axes, refracted
from vrut_lite.atmosphere.planet import MOON_RADIUS_KM
from vrut_lite.atmosphere.refraction import dip_rad
from vrut_lite.numeric_types import FloatArray


class Moon(NamedTuple):
    """The moon as a place sees it; vectors in world axes.

    Attributes:
        direction: (3,) to the apparent, refracted moon.
        true_direction: (3,) without refraction.
        to_sun: (3,) unit vector from the moon to the sun.
        axes: (3, 3) from world axes to the moon's own: x to the mean Earth, z to its north.
        angular_radius_rad: of its disc.
        visible_disc_fraction: share of the disc above the horizon.
        phase: for its light.
    """

    direction: FloatArray
    true_direction: FloatArray
    to_sun: FloatArray
    axes: FloatArray
    angular_radius_rad: float
    visible_disc_fraction: float
    phase: Phase

    @property
    def lit_fraction(self) -> float:
        """Share of the disc that the sun lights."""
        return float(0.5 * (1.0 + np.cos(self.phase.angle_rad)))


def moon_at(at: Watch, eye_height_m: float = 0.0) -> Moon:
    """The moon of an instant and a place, as an eye above it sees it refracted."""
    from_observer = body_km(astronomy.Body.Moon, at)
    sun = body_km(astronomy.Body.Sun, at) - from_observer
    distance, sun_km = float(np.linalg.norm(from_observer)), float(np.linalg.norm(sun))
    to_moon, to_sun = from_observer / distance, sun / sun_km
    own = moon_axes(at.time)
    seen, lit = own @ -to_moon, own @ to_sun
    true = at.world @ to_moon
    apparent = refracted(true, eye_height_m)
    radius = float(np.arcsin(MOON_RADIUS_KM / distance))
    phase = Phase(
        angle_rad=float(np.arccos(np.clip(-to_moon @ to_sun, -1.0, 1.0))),
        sun_longitude_rad=float(np.arctan2(lit[1], lit[0])),
        seen_latitude_rad=float(np.arcsin(seen[2])),
        seen_longitude_rad=float(np.arctan2(seen[1], seen[0])),
        sun_au=sun_km / AU_KM,
        observer_km=distance,
    )
    return Moon(
        direction=apparent,
        true_direction=true,
        to_sun=at.world @ to_sun,
        axes=own @ at.world.T,
        angular_radius_rad=radius,
        visible_disc_fraction=visible_fraction(
            float(np.arcsin(apparent[1])) + dip_rad(eye_height_m), radius
        ),
        phase=phase,
    )


def visible_fraction(over_horizon_rad: float, angular_radius_rad: float) -> float:
    """Share of a round disc's area above the horizon."""
    t = float(np.clip(over_horizon_rad / angular_radius_rad, -1.0, 1.0))
    return float(np.clip(0.5 + (t * np.sqrt(1.0 - t * t) + np.arcsin(t)) / np.pi, 0.0, 1.0))
