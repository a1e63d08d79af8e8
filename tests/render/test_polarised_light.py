"""A polariser before the camera, and reflections of a polarised sky, against the twin on the CPU.

The sky has the same radiance everywhere and vibrates as a test says.
"""

import numpy as np
import pytest
from scene_stage import light, look, square, surface
from stateful_backend import opened
from term_stage import material

from vrut_lite.geometry.cube_map import texel_directions
from vrut_lite.geometry.polarisation import map_axis, polariser_axis, reflected, turned
from vrut_lite.messages.camera import look_at
from vrut_lite.messages.sky import SkyPolarisationChanged
from vrut_lite.sky.sky_of_hour import polarisation_message

pytestmark = pytest.mark.gl
SIZE, SKY = 32, 2.0
SUN = np.array([0.0, 0.5, -np.sqrt(0.75)])
BLACK = {**surface(0.0, 0.0, 0.0)}
F0 = 0.04


@pytest.fixture
def backend(shared_gl_backend):
    backend = shared_gl_backend(size_px=(33, 33))
    yield backend
    backend.change(polarisation=None, polariser_deg=None)


def rayleigh(degree=1.0):
    """Q and U (2, 6, n, n, 3): across view and sun, by `degree` of what molecules make of it."""
    d = texel_directions(SIZE)
    nu = d @ SUN
    across = np.cross(d, SUN)
    across /= np.maximum(np.linalg.norm(across, axis=-1, keepdims=True), 1e-9)
    q = (SKY * degree * (1.0 - nu**2) / (1.0 + nu**2))[..., None] * np.ones(3)
    q[d[..., 1] < 0.0] = 0.0
    return np.stack(turned(q, np.zeros_like(q), d, across, map_axis(d))).astype(np.float32)


def stokes_at(cube_of, d, axis):
    """Q and U (3,) of `rayleigh` in a direction, by an axis."""
    nu, across = d @ SUN, np.cross(d, SUN)
    q = SKY * cube_of * (1.0 - nu**2) / (1.0 + nu**2) * np.ones(3)
    return turned(q, np.zeros(3), d, across / np.linalg.norm(across), axis)


def lit(backend, path, degree=1.0):
    backend.change(scene=opened(path), polarisation=polarisation_message(rayleigh(degree), "test"))
    light(backend, np.full((6, SIZE, SIZE, 3), SKY))


@pytest.mark.parametrize("angle_deg", [0.0, 30.0, 90.0, -60.0])
def test_the_filter_darkens_the_sky_by_malus(backend, tmp_path, angle_deg):
    """I + Q by the filter's axis: twice what it passes, in any direction, dark 90 degrees from the
    sun where the axis points to it; at the sun the filter changes nothing."""
    lit(backend, square(tmp_path))
    backend.change(polariser_deg=angle_deg)
    eye = np.array([0.0, 5.0, 0.0])
    for d in ((0.3, 0.5, -0.2), (0.9, 0.2, 0.3), (-0.5, 0.3, 0.7), tuple(SUN)):
        d = np.array(d) / np.linalg.norm(d)
        axis = polariser_axis(look_at(np.zeros(3), d), angle_deg)
        q, _ = stokes_at(1.0, d, axis) if abs(d @ SUN) < 0.999 else (np.zeros(3), 0.0)
        seen = look(backend, eye, eye + d, 0.1).radiance[16, 16]
        np.testing.assert_allclose(seen, SKY + q, atol=0.01 * SKY)


def test_the_axis_towards_the_sun_makes_the_band_black(backend, tmp_path):
    """90 degrees from the sun molecules polarise all light, across the plane of view and sun."""
    lit(backend, square(tmp_path))
    backend.change(polariser_deg=0.0)
    d = np.array([0.0, np.sqrt(0.75), 0.5])
    eye = np.array([0.0, 5.0, 0.0])
    dark = look(backend, eye, eye + d, 0.05).radiance[16, 16].max()
    backend.change(polariser_deg=90.0)
    bright = look(backend, eye, eye + d, 0.05).radiance[16, 16].max()
    assert dark < 0.02 * SKY
    assert bright == pytest.approx(2.0 * SKY, rel=0.01)


@pytest.mark.parametrize("filter_deg", [None, 0.0, 45.0, 90.0])
@pytest.mark.parametrize("elevation_deg", [15.0, 33.7, 60.0])
@pytest.mark.parametrize("azimuth_deg", [0.0, 50.0, 90.0])
def test_a_black_glass_reflects_as_fresnel_says(
    backend, tmp_path, filter_deg, elevation_deg, azimuth_deg
):
    """The mirror image of a polarised sky, without and behind a filter, as Mueller's matrix of the
    twin makes of it: relative to the reflection of an unpolarised sky."""
    path = square(tmp_path, BLACK)
    e, a = np.radians([elevation_deg, azimuth_deg])
    towards_eye = np.array([np.cos(e) * np.sin(a), np.sin(e), np.cos(e) * np.cos(a)])
    lit(backend, path, 0.0)
    plain = look(backend, 3.0 * towards_eye, (0.0, 0.0, 0.0), 0.05).radiance[16, 16]
    lit(backend, path, 0.8)
    backend.change(polariser_deg=filter_deg)
    seen = look(backend, 3.0 * towards_eye, (0.0, 0.0, 0.0), 0.05).radiance[16, 16]
    across = np.cross(towards_eye, [0.0, 1.0, 0.0])
    across /= np.linalg.norm(across)
    to_sky = towards_eye * [-1.0, 1.0, -1.0]
    q, u = stokes_at(0.8, to_sky, across)
    i, q, u = reflected(np.full(3, SKY), q, u, np.sin(e), F0)
    if filter_deg is not None:
        view = -towards_eye
        axis = polariser_axis(look_at(np.zeros(3), view), filter_deg)
        i = i + turned(q, u, view, across, axis)[0]
    np.testing.assert_allclose(seen / plain, i / SKY, atol=0.015)


def test_a_matte_wall_looks_the_same_through_the_filter(backend, tmp_path):
    """Diffuse light is unpolarised, and the filter is taken to pass all of it."""
    lit(backend, square(tmp_path, surface(0.0, 1.0, 0.5)))
    eye, seen = (0.0, 2.0, 0.5), []
    for angle_deg in (None, 0.0, 90.0):
        backend.change(polariser_deg=angle_deg)
        seen.append(look(backend, eye, (0.0, 0.0, 0.0), 0.05).radiance[16, 16])
    np.testing.assert_array_equal(seen[0], seen[1])
    np.testing.assert_array_equal(seen[0], seen[2])


def test_a_second_coat_polarises_as_glass_does(backend, tmp_path):
    """Paint under a clear coat at Brewster's angle: across the plane of incidence alone."""
    path = square(tmp_path, material((0, 0, 0), 1.0, clearcoat={"clearcoatFactor": 1.0}))
    e = 0.5 * np.pi - np.arctan(1.5)
    eye = 3.0 * np.array([np.cos(e), np.sin(e), 0.0])
    backend.change(scene=opened(path), polarisation=SkyPolarisationChanged(cube=None, source="t"))
    light(backend, np.full((6, SIZE, SIZE, 3), SKY))
    seen = []
    for angle_deg in (None, 0.0, 90.0):
        backend.change(polariser_deg=angle_deg)
        seen.append(look(backend, eye, (0.0, 0.0, 0.0), 0.05).radiance[16, 16].mean())
    plain, along, across = seen
    assert along < 0.55 * plain
    assert across > 1.45 * plain


def test_a_sky_that_knows_no_polarisation_looks_the_same_through_the_filter(backend, tmp_path):
    """Another sky's filter must not darken by the textures of the sky before."""
    lit(backend, square(tmp_path))
    backend.change(
        polarisation=SkyPolarisationChanged(cube=None, source="test"), polariser_deg=20.0
    )
    eye = np.array([0.0, 5.0, 0.0])
    seen = look(backend, eye, (0.2, 5.6, 0.5)).radiance
    np.testing.assert_allclose(seen[16, 16], SKY, rtol=1e-3)
