"""Deferred shading draws the same picture as meshes that are shaded at once."""

import msgspec
import numpy as np
import pytest
import trimesh
from hypothesis import given
from hypothesis import strategies as st
from light_map_stage import even, laid, lit
from scene_stage import light, look, look_finished, square, surface
from stateful_backend import opened

from vrut_lite.array import Array
from vrut_lite.messages.ground_disc import GroundDisc
from vrut_lite.messages.light_map import ReflectionProbes
from vrut_lite.messages.section import section_of
from vrut_lite.render.frustum import bounds
from vrut_lite.render.passes import deferred_meshes

SIZE = (120, 90)
SKY = np.linspace(9.0, 1.0, 16)[None, :, None, None] * np.ones((6, 1, 16, 3))
EYE, TARGET = (5.0, 3.0, 7.0), (0.5, 0.8, 0.5)


@pytest.fixture
def backend(gl_backend):
    backend = gl_backend(size_px=SIZE)
    light(backend, SKY, sun_direction=(0.6, 0.8, 0.0), sun_irradiance=(90.0, 80.0, 70.0))
    return backend


@pytest.fixture
def both(monkeypatch, gl_owner):
    """Pictures of a call, first with meshes shaded at once and then with all that fit deferred."""

    def drawn(backend, draw):
        if not gl_owner.opened.device.choices.takes_over:
            pytest.skip("a graphics card shades all meshes at once")
        monkeypatch.setattr(deferred_meshes, "LEAST_TRIANGLES", 1)
        pictures = []
        for most_px in (0.0, np.inf):
            monkeypatch.setattr(deferred_meshes, "MOST_TRIANGLE_PX", most_px)
            before = backend.counters.done["deferred mesh"]
            pictures.append(draw().radiance.astype(float))
            assert (backend.counters.done["deferred mesh"] > before) == (most_px > 0.0)
        return pictures

    return drawn


def show_spheres(backend, folder):
    """Spheres of several materials, one of them blended, on a box and the ground."""
    scene = trimesh.Scene()
    materials = [(1.0, 0.0, 255), (1.0, 0.3, 255), (0.0, 0.1, 255), (0.0, 0.9, 255), (0.0, 0.3, 90)]
    for number, (metallic, roughness, alpha) in enumerate(materials):
        place = (0.8 * number - 1.5, 0.7, 0.9 * number - 1.5)
        sphere = trimesh.creation.icosphere(3, 0.6).apply_translation(place)
        sphere.visual = trimesh.visual.TextureVisuals(
            material=trimesh.visual.material.PBRMaterial(
                baseColorFactor=[200, 120, 60, alpha],
                alphaMode="OPAQUE" if alpha == 255 else "BLEND",
                metallicFactor=metallic,
                roughnessFactor=roughness,
            )
        )
        scene.add_geometry(sphere)
    scene.add_geometry(trimesh.creation.box((5, 0.2, 5)))
    path = folder / "spheres.glb"
    scene.export(path)
    backend.change(scene=opened(path, GroundDisc((0, 0), -0.2, 300)))


def assert_same(at_once, deferred, few=0.0):
    """All but a share of `few` pixels, at mirrored horizons, are within a step of 8 bits."""
    apart = np.abs(at_once - deferred).max(axis=-1) / at_once.max(axis=-1).clip(1e-3)
    assert np.mean(apart > 4e-3) <= few
    assert np.isfinite(deferred).all()
    assert deferred.min() >= 0.0


@pytest.mark.gl
@pytest.mark.parametrize("shot", [look, look_finished])
@pytest.mark.parametrize("keeps", ["off", "below"])
def test_spheres_are_as_if_shaded_at_once(backend, both, tmp_path, shot, keeps):
    """Mirrors, plastic and stone under sun and sky; whole, and cut by a plane."""
    show_spheres(backend, tmp_path)
    backend.change(section=section_of("x", 0.6, keeps))
    at_once, deferred = both(backend, lambda: shot(backend, EYE, TARGET))
    assert_same(at_once, deferred, few=5e-4)
    assert np.ptp(at_once) > 10.0


@pytest.mark.gl
@pytest.mark.parametrize("two_sided", ["red", "green"])
def test_at_one_depth_the_same_mesh_shows(backend, both, tmp_path, two_sided):
    """A red and a green sphere in one place, of which one is deferred: the first shows."""
    scene = trimesh.Scene()
    for name, colour in (("red", [255, 0, 0, 255]), ("green", [0, 255, 0, 255])):
        sphere = trimesh.creation.icosphere(3, 1.0)
        sphere.visual = trimesh.visual.TextureVisuals(
            material=trimesh.visual.material.PBRMaterial(
                name=name, baseColorFactor=colour, doubleSided=name == two_sided
            )
        )
        scene.add_geometry(sphere, node_name=name)
    path = tmp_path / "two.glb"
    scene.export(path)
    backend.change(scene=opened(path))
    at_once, deferred = both(backend, lambda: look(backend, EYE, (0, 0, 0)))
    assert_same(at_once, deferred)


@pytest.mark.gl
def test_light_maps_and_mirrored_surroundings_are_as_if_shaded_at_once(backend, both, tmp_path):
    """A square with texels of light and a cube of a room in a pattern, seen askew."""
    scene = opened(square(tmp_path, surface(1.0, 0.1)))
    layout = laid(scene, ((1, 2),))
    texels = even(layout, 3.0, 0.4) * np.linspace(0.2, 1.0, layout.size_px[0])[None, :, None]
    cube = np.random.default_rng(1).random((1, 6, 32, 32, 4))
    mirrors = ReflectionProbes(
        part=Array(np.zeros(1, np.int32)),
        centre_m=Array(np.zeros((1, 3))),
        nearness=Array(np.full((1, 6, 32, 32), 0.5, np.float32)),
    )
    changed = msgspec.structs.replace(lit(layout, texels), mirrors=Array(cube.astype(np.float16)))
    layout = msgspec.structs.replace(layout, mirrors=mirrors)
    backend.change(scene=scene)
    backend.hear(layout, changed)
    at_once, deferred = both(backend, lambda: look(backend, (0.6, 0.7, 0.5), (0, 0, 0)))
    assert_same(at_once, deferred)
    assert np.ptp(at_once) > 1.0


metres = st.floats(-30.0, 30.0)


@given(st.tuples(metres, metres, metres), st.floats(0.01, 20.0), st.booleans())
def test_bounds_hold_a_sphere_and_touch_it(centre, radius_m, is_parallel):
    """In a view along -z bounds hold the projection of every point and end where it ends."""
    clip = np.diag([1.5, 2.0, 0.0, 0.0])
    clip[3] = (0.0, 0.0, 0.0, 20.0) if is_parallel else (0.0, 0.0, -1.0, 0.0)
    centre = np.array(centre)
    low, high = bounds(clip, centre, radius_m)
    points = centre + radius_m * trimesh.creation.icosphere(4).vertices
    at = points @ clip[:, :3].T + clip[:, 3]
    if at[:, 3].min() <= 0.0:
        assert (low, high) == (pytest.approx([-1, -1]), pytest.approx([1, 1]))
        return
    at = at[:, :2] / at[:, 3:]
    least, most = at.min(axis=0).clip(-1, 1), at.max(axis=0).clip(-1, 1)
    assert (low <= least + 1e-9).all()
    assert (high >= most - 1e-9).all()
    if centre[2] + 2.0 * radius_m < 0.0 or is_parallel:
        np.testing.assert_allclose([low, high], [least, most], atol=0.02 * np.ptp([low, high]))
