"""The fisheye of the sky's polarisation, against single rays."""

import numpy as np
import pytest
from bruneton_sky.module import BrunetonSky
from bruneton_sky.polarisation_picture import (
    SIZE_PX,
    PolarisationPicture,
    degree_and_vibration,
    polarisation_picture,
)
from bruneton_sky.settings import BrunetonSkySettings, atmosphere_of
from bruneton_sky.solved_sky import SolvedSky
from bruneton_sky.solver_job import solve_air

from vrut_lite.geometry.colour import luminance, rgb_from_spectrum
from vrut_lite.geometry.polarisation import neutral_points
from vrut_lite.geometry.sky_map import FisheyeMap
from vrut_lite.messages.sky import AmbientChanged, BackgroundChanged, SkyPolarisationChanged
from vrut_lite.messages.sky_light import SkyLightChanged
from vrut_lite.messages.sun import KeyLightChanged, SunMoved
from vrut_lite.testing.sky_on_bus import SkyOnBus

PARTS = {
    "background": BackgroundChanged,
    "key_light": KeyLightChanged,
    "ambient": AmbientChanged,
    "polarisation": SkyPolarisationChanged,
}


def light_at(elevation_deg: float, azimuth_deg: float) -> tuple[SkyLightChanged, SunMoved]:
    """All light of the Bruneton sky, and its sun."""
    sky = SkyOnBus(BrunetonSky)
    sky.want(*PARTS.values())
    sky.sun(elevation_deg, azimuth_deg)
    light = {name: sky.last(kind) for name, kind in PARTS.items()}
    return SkyLightChanged(**light, source="sky_sum"), sky.last(SunMoved)


@pytest.mark.parametrize("sun_deg", [-4.0, 0.5, 15.0, 50.0])
def test_neutral_points_are_those_of_single_rays(sun_deg: float) -> None:
    """The panel names them by the degree: cubes between texels, and the grid of rays behind them,
    must not move one by more."""
    found = polarisation_picture(*light_at(sun_deg, 130.0), 0.0).neutral
    field, angle_deg = solve_air(atmosphere_of(BrunetonSkySettings())), np.arange(1.0, 180.0)
    mu, nu = np.sin(np.radians(angle_deg)), np.cos(np.radians(angle_deg - sun_deg))
    stokes = SolvedSky(field=field).stokes(0.0, mu, np.sin(np.radians(sun_deg)), nu)
    q = luminance(rgb_from_spectrum(stokes[..., 1], field.atmosphere.wavelength_nm))
    exact = neutral_points(angle_deg, q, sun_deg)
    assert tuple(found) == pytest.approx(tuple(exact), abs=1.0, nan_ok=True)


def test_bars_lie_across_the_plane_of_sun_and_view() -> None:
    """Most light was scattered once, and vibrates so: within 5 degrees, 60 and more from a sun 30
    degrees high; on both sides of it."""
    light, moved = light_at(30.0, -110.0)
    sun = np.array(moved.direction)
    d = np.random.default_rng(3).normal(size=(500, 3))
    d[:, 1] = np.abs(d[:, 1]) + 0.3
    d /= np.linalg.norm(d, axis=1)[:, None]
    d = d[np.abs(d @ sun) < 0.5]
    _, vibration = degree_and_vibration(light, d)
    across = np.cross(sun, d)
    across /= np.linalg.norm(across, axis=1)[:, None]
    assert np.abs(np.sum(vibration * across, axis=1)).min() > np.cos(np.radians(5.0))


def test_the_picture_is_dark_at_neutral_points_and_turns_with_north() -> None:
    """A low sun in the east: Arago's point is seen in the west as the darkest colour in its ring,
    the band over the zenith in the brightest; with the scene turned by 90 degrees the picture has
    true north at the top still."""
    light = light_at(2.0, 90.0)
    picture = polarisation_picture(*light, 0.0)
    arago = np.radians(picture.neutral.arago - 2.0)
    west = np.array([-np.cos(arago), np.sin(arago), 0.0])
    assert colour_at(picture, west, 0.0) < 90
    assert colour_at(picture, np.array([0.0, np.sin(0.6), -np.cos(0.6)]), 0.0) > 160
    turned = polarisation_picture(*light, 0.5 * np.pi)
    assert colour_at(turned, west, 0.5 * np.pi) < 90
    assert not np.array_equal(turned.pixels, picture.pixels)


def colour_at(picture: PolarisationPicture, direction: np.ndarray, north_rad: float) -> float:
    """Mean of the green around a direction, which rises with the degree."""
    row, column = np.round(FisheyeMap(SIZE_PX, north_rad).position(direction)).astype(int)
    return float(picture.pixels[row - 2 : row + 3, column - 2 : column + 3, 1].mean())
