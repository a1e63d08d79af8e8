"""The conditions under which skies are measured: airs, suns, observers and directions."""

from functools import lru_cache
from typing import NamedTuple

import numpy as np
from bruneton_sky.atmosphere import Atmosphere
from bruneton_sky.geometry import horizon_mu
from bruneton_sky.settings import BrunetonSkySettings, atmosphere_of
from numpy.typing import NDArray

from vrut_lite.geometry.cube_map import texel_directions
from vrut_lite.numeric_types import FloatArray

SETTINGS = {
    "clear air": BrunetonSkySettings(preset="earth-clear"),
    "default air": BrunetonSkySettings(),
    "turbidity 10": BrunetonSkySettings(turbidity=10.0),
}
# Haze of one lobe, for rules that integrate one kind of particle.
ONE_LOBE = "one lobe, turbidity 10"
# Bruneton's own demonstration of 2017, at three wavelengths.
DEMO = "Bruneton's air of 2017"
# As near to the zenith as northern suns come, down to where the brightest stars are seen.
ELEVATIONS_DEG = (60.0, 30.0, 10.0, 2.0, -4.0, -9.0)
QUICK_ELEVATIONS_DEG = (60.0, 10.0, -4.0)
HEIGHTS_M = (0.0, 5000.0)
# Edge of the cube whose texels are the picture in which errors are counted.
PICTURE = 20
_AZIMUTH = np.array([0.6, -0.8])


class Condition(NamedTuple):
    """An observer above level ground, and a sun."""

    height_m: float
    elevation_deg: float

    @property
    def name(self) -> str:
        """As results are filed."""
        return f"sun {self.elevation_deg:g}°, {self.height_m:g} m up"

    @property
    def sun(self) -> FloatArray:
        """Direction (3,) to the sun, world axes."""
        return sun_at(self.elevation_deg)


def air(name: str) -> Atmosphere:
    """The atmosphere of a name in `SETTINGS`, at the product's four wavelengths, or another's."""
    if name == ONE_LOBE:
        return atmosphere_of(BrunetonSkySettings(turbidity=10.0, aerosol="one-lobe"))
    return Atmosphere.earth() if name == DEMO else atmosphere_of(SETTINGS[name])


def sun_at(elevation_deg: float) -> FloatArray:
    """Direction (3,) to a sun north-east, world axes."""
    elevation = np.radians(elevation_deg)
    x, z = _AZIMUTH * np.cos(elevation)
    return np.array([x, np.sin(elevation), z])


def conditions(quick: bool) -> list[Condition]:
    """Every height under every sun."""
    suns = QUICK_ELEVATIONS_DEG if quick else ELEVATIONS_DEG
    heights = HEIGHTS_M[:1] if quick else HEIGHTS_M
    return [Condition(height, sun) for height in heights for sun in suns]


@lru_cache
def in_view(height_m: float, ground_radius_m: float) -> NDArray[np.bool_]:
    """Which texels (6, PICTURE, PICTURE) of the picture lie above the ground's horizon."""
    above = texel_directions(PICTURE)[..., 1] > float(horizon_mu(ground_radius_m, height_m))
    above.flags.writeable = False
    return above


def sky_directions(atmosphere: Atmosphere, height_m: float) -> FloatArray:
    """Unit directions (n, 3) of the picture above the horizon."""
    return texel_directions(PICTURE)[in_view(height_m, atmosphere.ground_radius_m)]


def random_directions(count: int) -> FloatArray:
    """Unit directions (count, 3), even over the upper half of the sphere."""
    rng = np.random.default_rng(20261121)
    up = rng.random(count)
    azimuth = rng.uniform(0.0, 2.0 * np.pi, count)
    level = np.sqrt(1.0 - up * up)
    return np.stack([level * np.sin(azimuth), up, -level * np.cos(azimuth)], axis=-1)
