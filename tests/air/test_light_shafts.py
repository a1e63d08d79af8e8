"""Shadows in the air, against a march along every ray in double precision."""

import numpy as np
import pytest
import trimesh
from air_stage import air_of, volume_of
from scene_stage import light, look, look_finished
from stateful_backend import opened

from vrut_lite.messages.camera import look_at

pytestmark = pytest.mark.gl
SIZE = (64, 48)
EXTINCTION, SHADED, SUNLIT = 3e-3, 1.0, 8.0
SUN = np.array([0.55, 0.8, 0.25]) / np.linalg.norm([0.55, 0.8, 0.25])
# Middles and sizes: two slabs with a gap between them, and the wall that closes the view.
BOXES = [
    ((-30.0, 40.0, -60.0), (40.0, 3.0, 80.0)),
    ((25.0, 40.0, -60.0), (50.0, 3.0, 80.0)),
    ((0.0, 40.0, -150.0), (220.0, 120.0, 4.0)),
]
EYE, TARGET, FIELD_OF_VIEW_RAD = (0.0, 10.0, 30.0), (5.0, 22.0, -100.0), 0.7


@pytest.fixture
def backend(gl_backend):
    return gl_backend(size_px=SIZE)


def show(backend, folder, boxes, sun=SUN, sky=0.0):
    """Black boxes, in a sun that lights the air and nothing else."""
    black = trimesh.visual.material.PBRMaterial(
        baseColorFactor=[0, 0, 0, 1.0], metallicFactor=1.0, roughnessFactor=1.0
    )
    meshes = []
    for middle, extents in boxes:
        box = trimesh.creation.box(extents).apply_translation(middle)
        box.visual = trimesh.visual.TextureVisuals(material=black)
        meshes.append(box)
    path = folder / "boxes.glb"
    trimesh.Scene(meshes).export(path)
    backend.change(scene=opened(path))
    light(backend, np.full((6, 8, 8, 3), sky), sun_direction=sun, sun_irradiance=(1.0,) * 3)
    backend.hear(air_of(volume_of(EXTINCTION, SHADED, 0.0, SUNLIT, sun_direction=tuple(sun))))


def hits(start, direction):
    """Distance (...,) of rays to the nearest box, infinite where there is none."""
    nearest = np.full(start.shape[:-1], np.inf)
    for middle, extents in BOXES:
        with np.errstate(divide="ignore"):
            a, b = ((middle + s * 0.5 * np.array(extents) - start) / direction for s in (-1, 1))
        enter = np.minimum(a, b).max(axis=-1)
        leave = np.maximum(a, b).min(axis=-1)
        nearest = np.where((leave > enter) & (leave > 0.0), np.minimum(nearest, enter), nearest)
    return nearest


def marched(rays):
    """Light added before the boxes, or in 1 km, along unit rays (n, 3): 4000 steps, lit or not."""
    far = np.minimum(hits(np.array(EYE), rays), 1e3)
    share = (np.arange(4000) + 0.5) / 4000
    metres = far[:, None] * share
    points = np.array(EYE) + rays[:, None] * metres[..., None]
    lit = ~np.isfinite(hits(points, SUN))
    source = SHADED + SUNLIT * lit
    return (source * EXTINCTION * np.exp(-EXTINCTION * metres)).mean(axis=1) * far


def pixel_rays(x, y, target=TARGET, field_of_view_rad=FIELD_OF_VIEW_RAD):
    tangent = np.tan(0.5 * field_of_view_rad)
    right = (2 * (x + 0.5) / SIZE[0] - 1) * tangent * SIZE[0] / SIZE[1]
    up = (1 - 2 * (y + 0.5) / SIZE[1]) * tangent
    rays = np.stack([right, up, -np.ones_like(up)], axis=-1) @ look_at(EYE, target)[:3, :3]
    return rays / np.linalg.norm(rays, axis=-1, keepdims=True)


@pytest.mark.long
def test_shafts_are_those_of_a_march_in_double_precision(backend, tmp_path):
    """Two slabs and a gap: nine pixels of ten within 0.2 % of the light of lit air, each in 1.5 %.

    The first is the shadow map's texels, and where edges are found: 1/2000 of the ray. The last
    is a piece of shadow shorter than a step, 1/64 of the ray, which may be passed over.
    """
    show(backend, tmp_path, BOXES)
    backend.change(light_shafts=True)
    view = (EYE, TARGET, FIELD_OF_VIEW_RAD)
    picture = look(backend, *view).radiance[..., 1]
    backend.change(light_shafts=False)
    whole = look(backend, *view).radiance[..., 1]
    x, y = (side.ravel() for side in np.meshgrid(np.arange(1, 64, 3), np.arange(1, 48, 3)))
    rays = pixel_rays(x, y)
    # Pixels on the boxes' edges are means of several depths.
    corners = [pixel_rays(x + i, y + j) for i in (-0.6, 0.6) for j in (-0.6, 0.6)]
    depths = [np.minimum(hits(np.array(EYE), ray), 1e9) for ray in corners]
    inside = (np.ptp(depths, axis=0) < 2.0) & (np.max(depths, axis=0) < 1e3)
    wanted, found = marched(rays), picture[y, x]
    lost = whole[y, x] - wanted
    assert (lost > 0.2 * whole[y, x]).sum() > 30
    assert inside.sum() > 150
    error = np.abs(found - wanted)[inside] / whole[y, x][inside]
    assert np.percentile(error, 90) < 0.002
    assert error.max() < 0.015


def test_where_nothing_casts_shafts_change_nothing(backend, tmp_path):
    """One wall, its shadow behind it: the same picture within 2e-4, a texel's own shade."""
    show(backend, tmp_path, BOXES[2:], sun=np.array([0.0, 0.6, 0.8]))
    view = (EYE, TARGET, 0.3)
    without = look(backend, *view).radiance
    backend.change(light_shafts=True)
    np.testing.assert_allclose(look(backend, *view).radiance, without, rtol=2e-4)
    assert backend.counters.done["light shafts"] == 1


def test_what_hides_the_sun_shades_the_glow_before_it(backend, tmp_path):
    """Without light shafts too, a wall before the sun must not show the sun's glow: half of 25
    degrees from the sun its air is as shafts have it, beyond 25 degrees all of it is lit."""
    show(backend, tmp_path, BOXES[2:], sun=np.array([0.0, 0.0995, -0.995]))
    view = (EYE, np.add(EYE, (0.0, 0.1, -1.0)), 1.2)
    without = look(backend, *view).radiance[..., 1]
    assert backend.counters.done["air: shade in the sun's glow"] == 1
    backend.change(light_shafts=True)
    shafts = look(backend, *view).radiance[..., 1]
    x, y = (side.ravel() for side in np.meshgrid(np.arange(1, 64, 3), np.arange(1, 48, 3)))
    rays = pixel_rays(x, y, *view[1:])
    far_m = (EYE[2] + 148.0) / -rays[:, 2]
    at = np.array(EYE) + far_m[:, None] * rays
    on_wall = (np.abs(at[:, 0]) < 100.0) & (at[:, 1] > 0.0) & (at[:, 1] < 90.0)
    turn = np.degrees(np.arccos(rays @ (0.0, 0.0995, -0.995)))
    lit = (SHADED + SUNLIT) * -np.expm1(-EXTINCTION * far_m)
    inside, outside = on_wall & (turn < 12.0), on_wall & (turn > 25.5)
    assert min(inside.sum(), outside.sum()) > 10
    assert shafts[y, x][inside].max() < 0.2 * lit[inside].min()
    np.testing.assert_allclose(without[y, x][inside], shafts[y, x][inside], rtol=0.02)
    np.testing.assert_allclose(without[y, x][outside], lit[outside], rtol=2e-3)


def test_a_finished_still_has_no_grain_at_the_edges_of_the_glows_shade(backend, tmp_path):
    """Beside a hole in a wall before a low sun, a step along a ray is longer than the beam is wide:
    the pictures of a still look at different places, so that their mean has less of the grain."""
    sides = [((s * 54.0, 10.0, -40.0), (100.0, 80.0, 1.0)) for s in (-1, 1)]
    above_below = [((0.0, y, -40.0), (8.0, 32.0, 1.0)) for y in (40.0, 0.0)]
    show(backend, tmp_path, [*sides, *above_below], sun=np.array([0.1, 0.2, -0.974]))
    view = (EYE, np.add(EYE, (-0.03, 0.05, -1.0)), 0.3)
    few, finished = (shown(backend, *view).radiance[..., 1] for shown in (look, look_finished))
    backend.change(light_shafts=True)
    shafts = look_finished(backend, *view).radiance[..., 1]
    # Neighbours' difference from their mean: the glow itself fades smoothly.
    grain_of_few, grain = (
        np.abs(np.diff(seen - shafts, 2, axis=1)).mean() for seen in (few, finished)
    )
    assert grain < 0.47 * grain_of_few


def test_away_from_the_sun_no_glow_is_shaded(backend, tmp_path):
    """Pictures that do not show the glow are those of before, without a shadow map for it."""
    show(backend, tmp_path, BOXES[2:], sun=np.array([0.0, 0.6, 0.8]))
    look(backend, EYE, TARGET, 0.3)
    assert backend.counters.done["air: shade in the sun's glow"] == 0


def test_the_sky_behind_a_shadow_is_darker(backend, tmp_path):
    """Under a slab, towards the free sky: less by the sunlit light of the shaded piece, 0.2 %."""
    slab = [((0.0, 50.0, 0.0), (100.0, 2.0, 100.0))]
    show(backend, tmp_path, slab, sun=np.array([0.0, 1.0, 1e-3]), sky=20.0)
    backend.change(light_shafts=True)
    eye = np.array([0.0, 5.0, 0.0])
    picture = look(backend, eye, np.add(eye, (0.0, 0.05, -1.0)), 0.02)
    shaded_m = 50.0 * np.hypot(1.0, 0.05)
    expected = 20.0 - SUNLIT * (1.0 - np.exp(-EXTINCTION * shaded_m))
    np.testing.assert_allclose(picture.radiance[24, 32], expected, rtol=2e-3)


def test_shafts_cost_nothing_when_off_or_without_sun(backend, tmp_path):
    """Off by default; without a sun there is nothing to shade: the plain shader, bit for bit."""
    show(backend, tmp_path, BOXES)
    light(backend, np.full((6, 8, 8, 3), 2.0), sun_direction=SUN)
    view = (EYE, TARGET, FIELD_OF_VIEW_RAD)
    plain = look(backend, *view).radiance
    backend.change(light_shafts=True)
    np.testing.assert_array_equal(look(backend, *view).radiance, plain)
    assert backend.counters.done["light shafts"] == 0
    assert backend.counters.done["air"] == 2
