"""Walls in Bruneton's air: the way from the solved atmosphere to the pixel, against float64."""

import numpy as np
import pytest
import trimesh
from air_stage import air_of
from bruneton_sky.air_exact import light_before
from bruneton_sky.air_volume import air_volume
from bruneton_sky.ground_light import SKYLIGHT_EXPONENT
from bruneton_sky.phase import mie_phase, rayleigh_phase
from bruneton_sky.presets import earth_spectral
from bruneton_sky.solver import solve
from scene_stage import light, look

from vrut_lite.geometry.colour import SKYLIGHT_NM, rgb_from_spectrum
from vrut_lite.scene.loading import load_scene

pytestmark = pytest.mark.gl
EYE_M = 300.0


@pytest.fixture(scope="module")
def field():
    """Earth's air at the wavelengths of skylight."""
    return solve(earth_spectral(SKYLIGHT_NM), orders=3)


@pytest.fixture
def backend(gl_owner):
    from vrut_lite.render.pyrender_backend import PyrenderBackend

    backend = PyrenderBackend(gl_owner)
    backend.set_size(16, 16)
    yield backend
    backend.close()


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


def exact(field, view, sun, distance_m):
    """RGB of what the air adds (3,) before a point, in float64."""
    air, nu = field.atmosphere, float(view @ sun)
    found = light_before(field, EYE_M, float(view[1]), float(sun[1]), nu, np.array([distance_m]))
    once = found.molecules * rayleigh_phase(nu) + found.aerosol * mie_phase(air, nu)
    return rgb_from_spectrum((once + found.more)[0], air.wavelength_nm, SKYLIGHT_EXPONENT)


@pytest.mark.parametrize("elevation_deg", [60.0, 25.0, 6.0])
def test_black_walls_have_the_light_of_the_air_before_them(backend, field, tmp_path, elevation_deg):
    """By day, at 1, 10 and 100 km, three azimuths from the sun: within 1 % of the integral."""
    azimuth, elevation = 0.4, np.radians(elevation_deg)
    sun = np.array(
        [
            np.cos(elevation) * np.cos(azimuth),
            np.sin(elevation),
            np.cos(elevation) * np.sin(azimuth),
        ]
    )
    backend.show_scene(walls(tmp_path, 0.0), None)
    light(backend, np.zeros((6, 8, 8, 3)), sun_direction=sun)
    backend.set_air(air_of(air_volume(field, EYE_M, sun, 1.5e5)))
    eye = np.array([0.0, EYE_M, 0.0])
    for distance_m, ahead in ((1e3, (1, 0, 0)), (1e4, (0, 0, 1)), (1e5, (-1, 0, 0))):
        way = np.add(distance_m * np.array(ahead, float), (0.0, 0.02 * distance_m, 0.0))
        picture = look(backend, eye, eye + way, 0.01)
        metres = np.linalg.norm(way)
        wanted = exact(field, way / metres, sun, metres)
        np.testing.assert_allclose(picture.radiance[8, 8], wanted, rtol=0.01)
