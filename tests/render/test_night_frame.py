"""Stars and the moon in the frame: their light is kept, and surfaces hide them."""

import msgspec
import numpy as np
import pytest
from box_stage import uniform_sky
from scene_stage import light, look
from stateful_backend import opened

from vrut_lite.array import Array
from vrut_lite.geometry.sky_map import CubeFaces, FisheyeMap, LatLongMap
from vrut_lite.geometry.sun_disc import points_radiance
from vrut_lite.installed_parts import all_parts
from vrut_lite.messages.night import THROUGH_PLACES, MoonDiscChanged, StarsChanged
from vrut_lite.sky.moon_disc import moon_samples

SIZE = 160, 120
FIELD_RAD = 0.9


def stars_of(direction, irradiance):
    return StarsChanged(
        direction=Array(np.asarray(direction, np.float32)),
        irradiance_rgb=Array(np.asarray(irradiance, np.float32)),
        source="test",
    )


def moon_at(direction, to_sun, radius=0.0045, flattening=1.0):
    direction, to_sun = (np.asarray(v, float) / np.linalg.norm(v) for v in (direction, to_sun))
    return MoonDiscChanged(
        direction=tuple(direction.tolist()),
        angular_radius_rad=radius,
        flattening=flattening,
        to_sun=tuple(to_sun.tolist()),
        axes=(0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0),
        lit_rgb=(2.0, 1.0, 0.5),
        dark_rgb=(1e-4, 1e-4, 1e-4),
        albedo=Array(np.ones((4, 8), np.float32)),
        source="test",
    )


def solid_angles():
    """Of the picture's pixels (h, w), sr."""
    focal = 0.5 * SIZE[1] / np.tan(0.5 * FIELD_RAD)
    x, y = (np.arange(n) + 0.5 - 0.5 * n for n in SIZE)
    return focal * (focal**2 + y[:, None] ** 2 + x**2) ** -1.5


def around(elevations, azimuths):
    e, a = np.radians(elevations), np.radians(azimuths)
    return np.stack([np.cos(e) * np.sin(a), np.sin(e), -np.cos(e) * np.cos(a)], axis=-1)


@pytest.fixture
def backend(shared_gl_backend, box_file):
    backend = shared_gl_backend(size_px=SIZE, scene=opened(box_file))
    light(backend, uniform_sky(0.0))
    return backend


def show(backend, *messages):
    backend.change(parts=all_parts())
    backend.hear(*messages)


def picture(backend, target=(0.0, 40.0, -60.0), eye=(0.0, 10.0, 0.0)):
    return look(backend, eye, target, FIELD_RAD).radiance.astype(float)


@pytest.mark.gl
def test_every_star_gives_the_picture_its_irradiance(backend):
    """Wherever it lies, between pixels and off the axis: sum of L Omega = E within 0.5 %."""
    rng = np.random.default_rng(7)
    for elevation, azimuth in zip(rng.uniform(12, 40, 6), rng.uniform(-25, 25, 6), strict=True):
        direction = around([elevation], [azimuth])
        show(backend, stars_of(direction, [[3e-8, 2e-8, 1e-8]]))
        seen = (picture(backend) * solid_angles()[..., None]).sum(axis=(0, 1))
        np.testing.assert_allclose(seen, [3e-8, 2e-8, 1e-8], rtol=0.005)


@pytest.mark.gl
def test_a_star_is_seen_where_it_stands(backend):
    show(backend, stars_of(around([26.565], [0.0]), [[1e-8] * 3]))
    seen = picture(backend)[..., 1]
    row, column = np.unravel_index(seen.argmax(), seen.shape)
    assert abs(row - 59.5) <= 1.0
    assert abs(column - 79.5) <= 1.0
    assert (seen > 1e-3 * seen.max()).sum() < 40


@pytest.mark.gl
def test_surfaces_hide_stars_and_moon(backend):
    """The box fills the picture: nothing shines through."""
    stars = stars_of(around([1.0, 3.0], [0.0, 2.0]), np.full((2, 3), 1e-3))
    show(backend, stars, moon_at(around(2.0, 0.0), (0.0, 0.0, 1.0)))
    seen = picture(backend, target=(0.0, 0.9, 0.0), eye=(0.0, 0.9, 1.5))
    assert seen.max() == 0.0


@pytest.mark.gl
@pytest.mark.parametrize("radius", [0.0045, 0.1])
def test_the_moon_gives_the_picture_its_light_at_any_width(backend, radius):
    """Of 1 and of 30 pixels' width: as much as its samples add up to, within 2 %."""
    moon = moon_at(around(30.0, 5.0), (1.0, 0.3, 0.4), radius)
    air = np.linspace([0.4, 0.6, 0.8], [0.6, 0.8, 1.0], THROUGH_PLACES)
    moon = msgspec.structs.replace(moon, through_rgb=tuple(map(float, air.ravel())))
    show(backend, moon)
    seen = (picture(backend) * solid_angles()[..., None]).sum(axis=(0, 1))
    np.testing.assert_allclose(seen, moon_samples(moon)[1].sum(axis=0), rtol=0.02)


@pytest.mark.gl
@pytest.mark.parametrize(("elevation", "height"), [(0.25, 27.0), (2.0, 29.7), (40.0, 32.0)])
def test_the_setting_sun_is_flattened(backend, elevation, height):
    """As wide as ever, 27.0' high on the horizon; heights by the table of refraction."""
    sun = {"sun_direction": around(elevation, 0.0), "sun_irradiance": (1.0,) * 3}
    light(backend, uniform_sky(0.0), **sun)
    target = np.array([0.0, 1.0, 0.0]) + 100.0 * around(elevation, 0.0)
    field = np.radians(0.75)
    seen = look(backend, (0.0, 1.0, 0.0), tuple(target), field).radiance[..., 1] > 0.0
    minutes = np.degrees(field) * 60.0 / SIZE[1]
    assert seen.any(axis=1).sum() * minutes == pytest.approx(height, abs=0.9)
    assert seen.any(axis=0).sum() * minutes == pytest.approx(32.0, abs=0.9)


@pytest.mark.gl
def test_a_half_moon_is_lit_on_the_suns_side(backend):
    """The sun to the right of the picture, at a right angle: the right half shines."""
    show(backend, moon_at(around(26.565, 0.0), (1.0, 0.0, 0.0), radius=0.1))
    seen = picture(backend)[..., 1]
    assert seen[:, 82:].sum() > 100.0 * seen[:, :78].sum()


@pytest.mark.parametrize("sky_map", [LatLongMap(64), FisheyeMap(64), CubeFaces(32)])
def test_panoramas_keep_the_light_of_every_star(sky_map):
    """Sum of radiance times solid angle is the sum of irradiances within 0.5 %."""
    rng = np.random.default_rng(3)
    direction = around(rng.uniform(1, 89, 50), rng.uniform(0, 360, 50))
    energy = rng.uniform(0.0, 1e-7, (50, 3))
    seen = points_radiance(sky_map, direction, energy)
    angles = sky_map.solid_angles()
    np.testing.assert_allclose(
        np.tensordot(angles, seen, angles.ndim), energy.sum(axis=0), rtol=0.005
    )
