"""Lamps in the frame: the irradiance that their own values give, and shadows of what is near."""

import msgspec
import numpy as np
import pytest
import trimesh
from lamp_maker import lamps_of, spot_table
from long_parameters import mostly_long
from scene_stage import light, look, square, surface
from stateful_backend import opened

from vrut_lite.geometry.colour import LUMENS_PER_WATT
from vrut_lite.geometry.cube_map import texel_directions
from vrut_lite.messages.camera import pixel_rays
from vrut_lite.messages.ground_disc import GroundDisc
from vrut_lite.messages.lamps import MOST_DRAWN

pytestmark = pytest.mark.gl
SIZE = (48, 32)
ALBEDO = 0.3
EYE, TARGET = (0.0, 6.0, 0.1), (0.0, 0.0, 0.0)
LAMPS = {
    "point": {"position_m": (0.5, 2.0, 0.0), "intensity_rgb": (3.0, 2.0, 1.0)},
    "spot": {"position_m": (-1.0, 3.0, 0.3), "cone_rad": (0.3, 0.7), "axis": (0.2, -0.9, 0.1)},
    "luminaire": {"position_m": (0.0, 2.5, 0.6), "table": spot_table(), "across": (0, 0, 1)},
}


@pytest.fixture
def backend(shared_gl_backend):
    return shared_gl_backend(size_px=SIZE, ground_albedo_rgb=(ALBEDO,) * 3)


@pytest.fixture(scope="module")
def far_box(tmp_path_factory):
    path = tmp_path_factory.mktemp("scene") / "box.glb"
    trimesh.creation.box((0.1,) * 3).apply_translation((8.0, 0.05, 0.0)).export(path)
    return path


def night(backend, path, *lamps, ground=True):
    """A scene under a black sky, lit by lamps alone."""
    disc = GroundDisc((0.0, 0.0), 0.0, 100.0) if ground else None
    light(backend, np.zeros((6, 8, 8, 3)))
    show(backend, msgspec.structs.replace(opened(path, disc), lamps=lamps_of(*lamps)))


def show(backend, scene):
    """Open the scene, for the part too."""
    backend.change(scene=scene)
    backend.hear(scene)


def irradiance_of(lamps, camera):
    """What lamps send to the ground y = 0 in the middle of each pixel (h, w, 3)."""
    found = np.zeros((SIZE[1], SIZE[0], 3))
    for y in range(SIZE[1]):
        for x in range(SIZE[0]):
            ray = pixel_rays(camera, SIZE, x, y)
            point = np.asarray(camera.eye_m) - ray * (camera.eye_m[1] / ray[1])
            for lamp in range(lamps.count):
                found[y, x] += lamps.irradiance_at(lamp, point, (0.0, 1.0, 0.0))
    return found


@pytest.mark.parametrize("name", mostly_long(LAMPS, "point".__ne__))
def test_matte_ground_under_a_lamp_has_the_radiance_of_its_irradiance(backend, far_box, name):
    """At all pixels of three closely seen places, to 1 % of the brightest."""
    night(backend, far_box, LAMPS[name])
    for x, z in ((0.0, 0.5), (-0.6, 0.2), (0.5, -0.7)):
        found = look(backend, (x, 6.0, z + 0.1), (x, 0.0, z), 0.1).radiance
        lamps = backend.state.scene.lamps
        expected = irradiance_of(lamps, backend.state.camera) * ALBEDO / np.pi
        np.testing.assert_allclose(found, expected, atol=0.01 * expected.max())
        np.testing.assert_allclose(found.mean(axis=(0, 1)), expected.mean(axis=(0, 1)), rtol=0.01)


def test_lamps_add_up_and_the_brightest_are_drawn(backend, far_box):
    """Eight of twelve are drawn; the light map has the light of the others."""
    lamps = [{"position_m": (0.2 * k, 2.0, 0.0)} for k in range(MOST_DRAWN + 4)]
    night(backend, far_box, *lamps)
    found = look(backend, EYE, TARGET).radiance
    expected = irradiance_of(lamps_of(*lamps[:MOST_DRAWN]), backend.state.camera) * ALBEDO / np.pi
    np.testing.assert_allclose(found, expected, rtol=0.04)
    np.testing.assert_allclose(found.mean(), expected.mean(), rtol=5e-3)
    assert backend.counters.done["lamp"] >= MOST_DRAWN


@pytest.mark.parametrize("around_deg", [0.0, 40.0, 90.0, 200.0])
def test_a_thing_between_lamp_and_ground_casts_its_shadow(backend, tmp_path, around_deg):
    """A lamp 3 m up beside a post: black ground behind, lit beside; the light meter agrees."""
    angle = np.radians(around_deg)
    out = np.array([np.cos(angle), 0.0, np.sin(angle)])
    path = tmp_path / "post.glb"
    trimesh.creation.box((0.4, 2.0, 0.4)).apply_translation(tuple(2.0 * out + (0, 1, 0))).export(
        path
    )
    night(backend, path, {"position_m": (0.0, 3.0, 0.0)})
    lux = []
    # The top of the post, 2 m up and 2 m away, casts to 6 m.
    for metres, is_lit in ((1.0, True), (3.0, False), (4.5, False), (8.0, True)):
        at = metres * out
        shown = look(backend, np.add(at, (0.0, 5.0, 0.01)), at, 0.02).radiance[16, 24, 1]
        expected = ALBEDO / np.pi * 2.0 * 3.0 / (9.0 + metres**2) ** 1.5
        assert shown == pytest.approx(expected if is_lit else 0.0, rel=0.01, abs=1e-9)
        lux.append(backend.backend.illuminance(backend.state, at, (0.0, 1.0, 0.0)).lamp_lux)
    candela = 2.0 * LUMENS_PER_WATT
    wanted = [candela * 3.0 / (9.0 + metres**2) ** 1.5 for metres in (1.0, 8.0)]
    assert lux == pytest.approx([wanted[0], 0.0, 0.0, wanted[1]])


def test_a_smooth_surface_mirrors_a_lamp_where_a_mirror_would(backend, tmp_path):
    """The highlight of a polished metal stands where the angles are equal."""
    path = square(tmp_path, surface(1.0, 0.2))
    night(backend, path, {"position_m": (-2.0, 2.0, 0.0)}, ground=False)
    shown = look(backend, (2.0, 2.0, 0.0), (0.0, 0.0, 0.0), 0.3).radiance[..., 1]
    brightest = np.unravel_index(shown.argmax(), shown.shape)
    np.testing.assert_allclose(brightest, (15.5, 23.5), atol=2.0)


def test_without_lamps_nothing_is_done_for_them(backend, far_box):
    """No program is compiled with them and no map drawn; by day the picture is the same."""
    light(backend, 1.0 + 0.0 * texel_directions(8), sun_irradiance=(5.0,) * 3)
    show(backend, opened(far_box, GroundDisc((0.0, 0.0), 0.0, 100.0)))
    drawn = backend.counters.done["lamp"]
    before = look(backend, EYE, TARGET).radiance
    assert backend.counters.done["lamp"] == drawn
    assert backend.counters.skipped["lamps: none in the scene"] >= 1
    dim = lamps_of({"position_m": (0, 2, 0), "intensity_rgb": (1e-9,) * 3})
    show(backend, msgspec.structs.replace(backend.state.scene, lamps=dim))
    np.testing.assert_allclose(look(backend, EYE, TARGET).radiance, before, rtol=1e-5)
    faces = backend.counters.done["lamp shadow face"]
    look(backend, EYE, TARGET)
    assert backend.counters.done["lamp shadow face"] == faces
