"""Walls in Bruneton's air: the way from the solved atmosphere to the pixel, against float64."""

import numpy as np
import pytest
import trimesh
from air_stage import EARTH_M, air_of
from bruneton_sky.air_volume import air_volume
from bruneton_sky.atmosphere import KOSCHMIEDER
from bruneton_sky.ground_light import SKYLIGHT_EXPONENT
from bruneton_sky.phase import mie_phase, rayleigh_phase
from bruneton_sky.presets import earth_spectral
from bruneton_sky.solver import solve
from long_parameters import mostly_long
from scene_stage import light, look
from stateful_backend import opened

from vrut_lite.geometry.colour import SKYLIGHT_NM, rgb_from_spectrum
from vrut_lite.scene.loading import load_scene
from vrut_lite_lab.air_exact import light_before

pytestmark = pytest.mark.gl
EYE_M = 300.0


@pytest.fixture(scope="module")
def field():
    """Earth's air at the wavelengths of skylight."""
    return solve(earth_spectral(SKYLIGHT_NM), orders=3)


@pytest.fixture
def backend(gl_backend):
    return gl_backend(size_px=(16, 16))


def walls(folder, albedo):
    """Walls of one albedo, without a coat, at 1, 10 and 100 km to the east, south and west."""
    material = trimesh.visual.material.PBRMaterial(
        baseColorFactor=[albedo, albedo, albedo, 1.0], metallicFactor=1.0, roughnessFactor=1.0
    )
    scene = trimesh.Scene()
    for distance_m, turn in ((1e3, 0.0), (1e4, 1.0), (1e5, 2.0)):
        box = trimesh.creation.box((0.01 * distance_m, distance_m, distance_m))
        box.apply_translation((1.005 * distance_m, EYE_M, 0.0))
        box.apply_transform(trimesh.transformations.rotation_matrix(-turn * np.pi / 2, [0, 1, 0]))
        box.visual = trimesh.visual.TextureVisuals(material=material)
        scene.add_geometry(box)
    path = folder / "walls.glb"
    scene.export(path)
    return load_scene(path)


def exact(field, view, sun, metres, altitude_m=EYE_M):
    """RGB (n, 3) in float64 of what the air adds before points, and of what it lets through."""
    air, nu = field.atmosphere, float(view @ sun)
    found = light_before(field, altitude_m, float(view[1]), float(sun[1]), nu, np.asarray(metres))
    once = found.molecules * rayleigh_phase(nu) + found.aerosol * mie_phase(air, nu)
    nm, white = air.wavelength_nm, np.asarray(air.solar_irradiance)
    passed = rgb_from_spectrum(white * found.transmittance, nm, SKYLIGHT_EXPONENT)
    return (
        rgb_from_spectrum(once + found.more, nm, SKYLIGHT_EXPONENT),
        passed / rgb_from_spectrum(white, nm, SKYLIGHT_EXPONENT),
    )


def sun_at(elevation_deg, azimuth=0.4):
    """The unit vector; azimuth in radians from the east, southwards."""
    elevation = np.radians(elevation_deg)
    level = np.cos(elevation)
    return np.array([level * np.cos(azimuth), np.sin(elevation), level * np.sin(azimuth)])


@pytest.mark.parametrize("elevation_deg", mostly_long([60.0, 25.0, 6.0], (25.0).__ne__))
@pytest.mark.parametrize("albedo", [0.0, 1.0])
def test_walls_have_the_light_of_the_air_before_them(
    backend, field, tmp_path, albedo, elevation_deg
):
    """White and black walls by day, at 1, 10 and 100 km, three azimuths from the sun: within 1 % of
    the integral. The white ones give back the light of an even sky, the sun's over pi."""
    sun = sun_at(elevation_deg)
    sky = 1360.0 / 6.0 / np.pi * sun[1]
    backend.change(scene=opened(walls(tmp_path, albedo)))
    light(backend, np.full((6, 8, 8, 3), sky), sun_direction=sun)
    backend.hear(air_of(air_volume(field, EYE_M, sun, 1.5e5)))
    eye = np.array([0.0, EYE_M, 0.0])
    for distance_m, ahead in ((1e3, (1, 0, 0)), (1e4, (0, 0, 1)), (1e5, (-1, 0, 0))):
        way = np.add(distance_m * np.array(ahead, float), (0.0, 0.02 * distance_m, 0.0))
        picture = look(backend, eye, eye + way, 0.01)
        metres = np.linalg.norm(way)
        added, passed = exact(field, way / metres, sun, [metres])
        wanted = (added + albedo * np.float16(sky) * passed)[0]
        np.testing.assert_allclose(picture.radiance[8, 8], wanted, rtol=0.01)


def black_wall(folder, distance_m):
    """To the south, as wide and high as it is far."""
    black = trimesh.visual.material.PBRMaterial(
        baseColorFactor=[0, 0, 0, 1.0], metallicFactor=1.0, roughnessFactor=1.0
    )
    box = trimesh.creation.box((4 * distance_m, 4 * distance_m, 0.01 * distance_m))
    box.apply_translation((0.0, 0.0, 1.005 * distance_m))
    box.visual = trimesh.visual.TextureVisuals(material=black)
    path = folder / "wall.glb"
    trimesh.Scene([box]).export(path)
    return load_scene(path)


def test_black_walls_in_fog_fade_as_koschmieder_says(backend, tmp_path):
    """Contrast to the fog behind is exp(-3.912 d / V) on the level, 2 % at the visibility V.

    Within 0.005: the fog is not quite as bright near the eye as far off, and its air has colour.
    """
    visibility_m, sun = 400.0, sun_at(30.0)
    foggy = earth_spectral(SKYLIGHT_NM).with_fog(visibility_m, 200.0)
    volume = air_volume(solve(foggy, orders=4), 2.0, sun, 1e4)
    shown = []
    for share in (0.25, 0.5, 1.0, 4.0):
        backend.change(scene=opened(black_wall(tmp_path, share * visibility_m)))
        light(backend, np.zeros((6, 8, 8, 3)), sun_direction=sun)
        backend.hear(air_of(volume))
        picture = look(backend, (0.0, 2.0, 0.0), (0.0, 2.0, 10.0), 0.001)
        shown.append(picture.radiance[8, 8, 1])
    contrast = 1.0 - np.array(shown[:3]) / shown[3]
    expected = np.exp(-KOSCHMIEDER * np.array([0.25, 0.5, 1.0]))
    np.testing.assert_allclose(contrast, expected, atol=0.005)


@pytest.mark.parametrize(
    ("height_m", "distance_m"),
    [
        (2.0, 8e4),
        (3000.0, 1e4),
        pytest.param(2.0, 1e4, marks=pytest.mark.long),
        pytest.param(3000.0, 3e4, marks=pytest.mark.long),
    ],
)
def test_no_line_and_no_bands_across_a_black_wall(backend, field, tmp_path, height_m, distance_m):
    """About the horizon, row by row of a minute of arc: pixels over the integral are 1 within
    0.5 %, and change by less than half a step of 8 bits, 0.2 %, from one row to the next."""
    sun, half = sun_at(20.0, 2.0), np.radians(1.25)
    backend.change(size_px=(16, 150))
    backend.change(scene=opened(black_wall(tmp_path, distance_m)))
    light(backend, np.zeros((6, 8, 8, 3)), sun_direction=sun)
    backend.hear(air_of(air_volume(field, height_m, sun, 1.5 * distance_m)))
    horizon = -np.arccos(EARTH_M / (EARTH_M + height_m))
    eye = np.array([0.0, height_m, 0.0])
    away = np.array([0.0, np.sin(horizon), np.cos(horizon)])
    radiance = look(backend, eye, eye + away, 2 * half).radiance[:, 8]
    angle = horizon + np.arctan(np.tan(half) * (1.0 - (np.arange(150) + 0.5) / 75))
    # What of the wall stands on the ground, and before the horizon or above it.
    there = np.hypot(EARTH_M + height_m + distance_m * np.tan(angle), distance_m) - EARTH_M
    beyond = distance_m > EARTH_M * -np.tan(horizon)
    rows = np.flatnonzero((there > 0.0) & ((angle > horizon) | ~beyond))
    views = np.stack([0 * angle, np.sin(angle), np.cos(angle)], axis=-1)
    wanted = [
        exact(field, views[row], sun, [distance_m / views[row, 2]], height_m)[0][0] for row in rows
    ]
    ratio = radiance[rows] / wanted
    assert len(rows) > 60
    np.testing.assert_allclose(ratio, 1.0, atol=0.005)
    assert np.abs(np.diff(ratio, axis=0)).max() < 2e-3
