"""A finished still's shadow map: as fine as its pixels, near and far."""

import numpy as np
import pytest
import trimesh
from half_shadow import DISC_WIDTH, half_shadow
from hypothesis import given
from hypothesis import strategies as st
from scene_stage import light, look_finished, square
from stateful_backend import StatefulBackend, opened
from sun_stage import BLACK, IRRADIANCE, RADIUS_RAD, SUN, box, show

from vrut_lite.messages.camera import look_at, pixel_rays
from vrut_lite.render.passes.light_axes import light_axes
from vrut_lite.render.passes.seen_points import SeenPoints, points_at
from vrut_lite.render.passes.still_shadow import INSIDE, fitted
from vrut_lite.render.passes.view import View

SIZE = (64, 48)


@pytest.fixture(scope="module")
def backend(gl_owner):
    from vrut_lite.render.pyrender_backend import PyrenderBackend

    made = PyrenderBackend(gl_owner)
    yield StatefulBackend(made, size_px=SIZE)
    made.close()


def on_plane(backend, point, normal):
    """Where each pixel (h, w, 3) sees a plane."""
    camera, normal = backend.state.camera, np.asarray(normal, float)
    y, x = np.indices(SIZE[::-1])
    rays = pixel_rays(camera, SIZE, x, y)
    reach = (np.asarray(point) - camera.eye_m) @ normal / (rays @ normal)
    return np.array(camera.eye_m) + rays * reach[..., None]


@pytest.fixture(scope="module")
def plain(backend, tmp_path_factory):
    """A plain of 4 km, and an edge above it that climbs; its foot is 1 cm above the ground."""
    corners = [(0.0, 0.01, 10.0), (0.0, 12.01, -10.0), (-6.0, 12.01, -10.0), (-6.0, 0.01, 10.0)]
    sheet = trimesh.Trimesh(corners, [[0, 1, 2], [0, 2, 3]], process=False)
    ground = box((-12.0, -1.0, -12.0), (12.0, 0.0, 12.0))
    plain = box((-2e3, -2.0, -2e3), (2e3, -0.1, 2e3))
    show(backend, tmp_path_factory.mktemp("plain"), ground, plain, sheet)
    return backend


@pytest.mark.gl
@pytest.mark.parametrize(
    ("height_m", "half_widths"), [(0.05, 8.0), (0.4, 4.0), (1.5, 8.0), (4.0, 4.0), (10.0, 8.0)]
)
def test_penumbras_are_the_suns_from_contact_to_distance(plain, height_m, half_widths):
    """Below an edge that climbs, in a scene of 4 km: width from 10 to 90 % to 15 %, and no step.

    The narrowest is 0.4 mm wide, a map's texel of all of the scene 1.4 m.
    """
    low, high = np.array([0.0, 0.01, 10.0]), np.array([0.0, 12.01, -10.0])
    on_edge = low + (high - low) * (height_m - low[1]) / (high[1] - low[1])
    foot = on_edge - SUN * (height_m / SUN[1])
    half_width_m = RADIUS_RAD * height_m / SUN[1]
    # Below the sheet; the near plane is 2 cm away.
    away_m = 0.025 + 40.0 * half_width_m
    eye = foot + away_m * np.array([0.3, 0.9, 0.2])
    picture = look_finished(plain, eye, foot, half_widths * half_width_m / away_m).radiance[..., 1]
    across = np.cross(high - low, on_edge - on_plane(plain, foot, (0.0, 1.0, 0.0)))
    t = across @ SUN / (np.linalg.norm(across, axis=-1) * RADIUS_RAD)
    share, width = half_shadow(picture, t, 0.08)
    assert width == pytest.approx(DISC_WIDTH, rel=0.15)
    assert share.mean() == pytest.approx(0.5, abs=0.015)
    assert -2e-2 <= np.diff(share).min() <= np.diff(share).max() <= 1.6 * 0.1 * 2.0 / np.pi


@pytest.mark.gl
def test_no_light_below_eaves_and_no_seam_where_a_wall_meets_the_ground(backend, tmp_path):
    """In a yard of 60 m, of which a texel of one map is 2 cm wide."""
    sun = np.array([0.35, 0.7, 0.5]) / np.linalg.norm([0.35, 0.7, 0.5])
    wall, roof = box((-3.0, 0.0, -3.0), (3.0, 2.6, 0.0)), box((-3.4, 2.6, -3.4), (3.4, 2.62, 0.5))
    yard = box((-30.0, -1.0, -30.0), (30.0, 0.0, 30.0))
    show(backend, tmp_path, wall, roof, yard, sun=sun)

    # The roof's edge shades the wall by 0.5 m sun.y / sun.z from its underside on.
    end_m = 2.6 - 0.5 * sun[1] / sun[2]
    picture = look_finished(backend, (0.4, 1.6, 3.0), (0.0, end_m, 0.0), 0.4).radiance[..., 1]
    height = on_plane(backend, (0.0, 0.0, 0.0), (0.0, 0.0, 1.0))[..., 1]
    # Half a penumbra, and a pixel of 3 cm.
    edge_m = 0.5 * RADIUS_RAD / sun[2] + 0.03
    np.testing.assert_array_equal(picture[(height > end_m + edge_m) & (height < 2.58)], 0.0)
    lit = picture[height < end_m - edge_m]
    assert np.ptp(lit) < 0.01 * lit.mean()

    foot = look_finished(backend, (1.6, 0.5, 0.8), (1.5, 0.02, 0.0), 0.2).radiance[..., 1]
    height = on_plane(backend, (0.0, 0.0, 0.0), (0.0, 0.0, 1.0))[..., 1]
    for side in (foot[height > 0.004], foot[height < -0.004]):
        assert np.ptp(side) < 0.01 * side.mean()


@pytest.mark.gl
def test_a_shadow_on_stairs_has_no_steps(backend, tmp_path):
    """Of a pillar's edge, on treads near and far from it: each pixel has the light of the part of
    the sun's disc that they see, to 8 %."""
    flight = [box((0.3 * k, -1.0, -2.0), (0.3 * k + 0.3, 0.16 * (k + 1), 2.0)) for k in range(8)]
    yard = box((-30.0, -2.0, -30.0), (30.0, 0.0, 30.0))
    sun = np.array([-0.9, 0.35, 0.25]) / np.linalg.norm([-0.9, 0.35, 0.25])
    pillar = box((-3.0, 0.0, -0.5), (-2.0, 8.0, 0.5))
    show(backend, tmp_path, yard, *flight, pillar, sun=sun)
    across = np.cross(sun, (0.0, 1.0, 0.0))
    across /= np.linalg.norm(across)
    # The edge that shades farthest to one side.
    edges = np.array([[x, 0.0, z] for x in (-3.0, -2.0) for z in (-0.5, 0.5)])
    edge = edges[np.argmax(edges @ across)]
    for k in (1, 6):
        height_m, x = 0.16 * (k + 1), 0.3 * k + 0.2
        reach = (edge[0] - x) / sun[0]
        at = np.array([x, height_m, edge[2] - reach * sun[2]])
        half_m = RADIUS_RAD * reach
        eye = np.add(at, (0.0, 1.0, 0.1))
        picture = look_finished(backend, eye, at, 5.0 * half_m).radiance[..., 1]
        off = (on_plane(backend, at, (0.0, 1.0, 0.0)) - edge) @ across / half_m
        t = np.clip(off, -1.0, 1.0)
        disc = 0.5 + (np.arcsin(t) + t * np.sqrt(1.0 - t * t)) / np.pi
        wrong = abs(picture / picture.max() - disc)
        assert wrong.max() < 0.1
        assert wrong.mean() < 0.006


@pytest.mark.gl
def test_gaps_between_a_satellites_cells_are_dark_at_dusk_without_dashes(backend, tmp_path):
    """Cells 5 mm above their panel, 24 mm apart; a sun of 1.5 degrees shines into no gap."""
    x0 = 0.4 * np.arange(-4, 4)
    cells = [
        trimesh.Trimesh(
            [(x + 0.012, 0.005, 0.5), (x + 0.388, 0.005, 0.5), (x + 0.388, 0.005, -0.5),
             (x + 0.012, 0.005, -0.5)],
            [[0, 1, 2], [0, 2, 3]],
            process=False,
        )
        for x in x0
    ]  # fmt: skip
    panel = box((-1.6, -0.04, -0.55), (1.6, 0.0, 0.55))
    away = np.radians(1.5)
    sun = np.array([np.cos(away), np.sin(away), 0.0])
    far_off = box((7.9, -8.0, -8.0), (8.0, -7.9, -7.9))
    show(backend, tmp_path, panel, far_off, *cells, sun=sun)
    picture = look_finished(backend, (-0.4, 4.0, 0.01), (-0.4, 0.0, 0.0), 0.12).radiance[..., 1]
    x = on_plane(backend, (0.0, 0.0, 0.0), (0.0, 1.0, 0.0))[..., 0]
    in_gap = abs(x + 0.4) < 0.006
    assert in_gap.sum() > 40
    assert picture[in_gap].max() < 0.05 * np.median(picture)


@pytest.mark.gl
def test_leaves_behind_one_another_shade_one_another(backend, tmp_path):
    """Of eight leaves, each half holes finer than texels, hardly any light is left, not half."""
    chance = np.random.default_rng(5)
    alpha = np.full((1024, 1024, 4), 255, np.uint8)
    alpha[..., 3] *= chance.random((1024, 1024)) < 0.5
    material = {
        "alphaMode": "MASK", "doubleSided": True,
        "pbrMetallicRoughness": {"baseColorTexture": {"index": 0}, "metallicFactor": 0.0},
    }  # fmt: skip
    path = square(tmp_path, material, [alpha])
    leaf = trimesh.load(path, force="mesh")
    leaf.apply_scale(3.0)
    aside_m = chance.uniform(-0.2, 0.2, (8, 2))
    leaves = [
        leaf.copy().apply_translation((x, 1.0 + 0.1 * k, z)) for k, (x, z) in enumerate(aside_m)
    ]
    ground = box((-20.0, -1.0, -20.0), (20.0, 0.0, 20.0))
    ground.visual = trimesh.visual.TextureVisuals(
        material=trimesh.visual.material.PBRMaterial(metallicFactor=0.0, roughnessFactor=1.0)
    )
    trimesh.Scene([trimesh.util.concatenate(leaves), ground]).export(tmp_path / "leaves.glb")
    backend.change(scene=opened(tmp_path / "leaves.glb"))
    light(backend, BLACK, sun_direction=(0.0, 1.0, 1e-3), sun_irradiance=(IRRADIANCE,) * 3)
    picture = look_finished(backend, (0.0, 0.9, 0.01), (0.0, 0.0, 0.0), 1.0).radiance[..., 1]
    beside = look_finished(backend, (9.0, 0.9, 0.01), (9.0, 0.0, 0.0), 1.0).radiance[..., 1]
    assert picture.mean() < 0.05 * beside.mean()


metres = st.floats(-50.0, 50.0)


@given(st.lists(st.tuples(metres, metres, metres), min_size=1, max_size=40), st.floats(1e-4, 1e-2))
def test_squares_hold_what_is_seen_each_where_coarser_ones_are_too_wide(places, pixel_rad):
    """All points lie in the first square's inner part; texels are finer from square to square."""
    at = np.add(places, (0.0, -60.0, 0.0))
    points = SeenPoints(at, pixel_rad * np.linalg.norm(at, axis=1))
    squares = fitted(points, SUN, RADIUS_RAD, np.array([0.0, -60.0, 0.0]), np.full(3, 50.0))
    assert len(squares) <= 4
    halves = [square.half_m for square in squares]
    assert halves == sorted(halves, reverse=True)
    seen = at @ light_axes(SUN).T
    first = squares[0]
    assert np.all(np.abs(seen[:, :2] - first.centre_m[:2]) <= INSIDE * first.half_m)
    assert np.all(np.abs(seen[:, 2] - first.centre_m[2]) <= first.half_depth_m)
    # The finest holds what is nearest.
    nearest, last = seen[np.argmin(points.pixel_m)], squares[-1]
    assert np.all(np.abs(nearest[:2] - last.centre_m[:2]) <= INSIDE * last.half_m)


def test_depths_of_a_view_are_points_of_the_scene():
    """Of a plane 5 m ahead: pixels of 1 cm there, all points on it."""
    rotation = look_at((0.0, 0.0, 0.0), (0.0, 0.0, -1.0))
    projection = np.array([[2.0, 0, 0, 0], [0, 2.0, 0, 0], [0, 0, 0, 0.02], [0, 0, -1, 0]])
    depth = np.full((4, 6), 0.02 / 5.0)
    depth[0, 0] = 0.0
    points = points_at(depth, View(np.zeros(3), rotation, projection), (600, 500))
    assert points.from_eye_m.shape == (23, 3)
    np.testing.assert_allclose(points.from_eye_m[:, 2], -5.0)
    np.testing.assert_allclose(points.pixel_m, 0.01)
    np.testing.assert_allclose(points.from_eye_m[-1, :2], [2.5 * 5.0 / 6.0, 2.5 * 0.75])


@pytest.mark.gl
def test_the_map_is_drawn_once_for_a_view_and_not_without_a_sun(plain):
    """The same view needs no other, another view does; by night surfaces are black without one."""

    def drawn():
        return plain.counters.done["still shadow map"]

    view = (0.0, 2.0, 3.0), (0.0, 0.0, 0.0)
    look_finished(plain, *view)
    before = drawn()
    look_finished(plain, *view)
    assert drawn() == before
    look_finished(plain, (0.0, 2.5, 3.0), (0.0, 0.0, 0.0))
    assert drawn() == before + 1
    light(plain, BLACK, sun_direction=tuple(SUN), sun_irradiance=(0.0,) * 3)
    np.testing.assert_array_equal(
        look_finished(plain, (0.0, 3.0, 3.0), (0.0, 0.0, 0.0)).radiance, 0.0
    )
    assert drawn() == before + 1
    assert plain.counters.skipped["still shadow map: no sun to cast one"] >= 1


@pytest.mark.gl
def test_what_lies_deeper_than_a_fine_square_has_all_its_casters(backend, tmp_path):
    """A shelf close to the eye has a fine square, in the sun's view over a floor whose light a low
    wall takes: beyond the square's depth casters are missing, and the floor was bright."""
    sun = np.array([0.7, 0.7, 0.1]) / np.linalg.norm([0.7, 0.7, 0.1])
    floor, wall = box((-4.0, -0.1, -4.0), (4.0, 0.0, 4.0)), box((1.0, 0.0, -4.0), (1.1, 1.2, 4.0))
    shelf = box((2.7, 2.5, -0.3), (3.3, 2.52, 0.3))
    tower = box((3.8, 0.0, 3.8), (4.0, 4.0, 4.0))
    show(backend, tmp_path, floor, wall, shelf, tower, sun=sun)
    look = look_finished(backend, (1.6, 2.9, 0.0), (1.9, 2.2, 0.0), 1.9)
    at = on_plane(backend, (0.0, 0.0, 0.0), (0.0, 1.0, 0.0))
    # In the shadow of the wall, 1.2 m long, and not hidden by it.
    shaded = (at[..., 0] > 0.1) & (at[..., 0] < 0.6) & (np.abs(at[..., 2]) < 1.5)
    assert shaded.sum() > 50
    np.testing.assert_array_equal(look.radiance[shaded], 0.0)
