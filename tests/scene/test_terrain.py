"""The terrain: without cracks, on a round planet, with plausible heights and colours."""

from collections import Counter
from pathlib import Path

import numpy as np
import pytest
from loaded_scenes import front_cosines

from vrut_lite.project import load_project
from vrut_lite.scene.ground import has_own_ground
from vrut_lite.scene.loading import load_scene

SCENES = Path(__file__).resolve().parents[2] / "scenes" / "large"
PLANET_M = 6.36e6
SPACING_M = 0.125


@pytest.fixture(scope="module")
def terrain():
    return load_scene(SCENES / "terrain.glb")


@pytest.fixture(scope="module")
def land(terrain):
    """Corners (F, 3, 3) of the land's triangles, in world axes."""
    return np.concatenate([p.world_triangles() for p in terrain.meshes if "land" in p.name])


def fall_m(x, z):
    """Depth (m) of the planet's surface below y = 0, which it touches at the origin."""
    return PLANET_M - np.sqrt(PLANET_M**2 - x**2 - z**2)


def normals(triangles):
    a, b, c = np.moveaxis(triangles, 1, 0)
    return np.cross(b - a, c - a)


def height_at(land, x, z):
    """World y of the land at one place."""
    across = normals(land)
    a = land[:, 0]
    y = a[:, 1] - (across[:, 0] * (x - a[:, 0]) + across[:, 2] * (z - a[:, 2])) / across[:, 1]
    b, c = land[:, 1] - a, land[:, 2] - a
    area = b[:, 0] * c[:, 2] - b[:, 2] * c[:, 0]
    u = ((x - a[:, 0]) * c[:, 2] - (z - a[:, 2]) * c[:, 0]) / area
    v = (b[:, 0] * (z - a[:, 2]) - b[:, 2] * (x - a[:, 0])) / area
    inside = (u >= -1e-9) & (v >= -1e-9) & (u + v <= 1 + 1e-9)
    return float(y[inside][0])


def test_the_land_is_small_enough_to_open_at_once(terrain):
    """Below 4 MB and 300,000 triangles."""
    assert (SCENES / "terrain.glb").stat().st_size < 4e6
    assert 100_000 < terrain.triangles < 300_000
    assert has_own_ground(terrain)


def test_the_land_has_no_crack(land):
    """Every edge occurs once in each direction, except at the rim of the square."""
    corners = np.round(land / SPACING_M).astype(np.int64)
    np.testing.assert_array_equal(corners * SPACING_M, land)
    points, number = np.unique(corners.reshape(-1, 3), axis=0, return_inverse=True)
    faces = number.reshape(-1, 3)
    edges = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    keys = edges[:, 0] * len(points) + edges[:, 1]
    assert len(np.unique(keys)) == len(keys)
    alone = edges[~np.isin(keys, edges[:, 1] * len(points) + edges[:, 0])]
    ends = points[alone] * SPACING_M
    on_rim = [
        np.all(ends[:, :, axis] == side, axis=1)
        for axis, sides in ((0, (-34560.0, 6400.0)), (2, (-20480.0, 20480.0)))
        for side in sides
    ]
    assert np.all(np.any(on_rim, axis=0))


def test_the_land_covers_its_square_once(land):
    """All triangles face up, and their areas seen from above sum to (40.96 km)^2."""
    up = normals(land)[:, 1] / 2.0
    assert np.all(up > 0.0)
    np.testing.assert_allclose(up.sum(), 40960.0**2, rtol=1e-12)


def test_heights_are_those_of_mountains(land):
    """Valleys near the level of 0, peaks to about 2,500 m, slopes mostly below 50 degrees."""
    above_m = land[..., 1] + fall_m(land[..., 0], land[..., 2])
    assert 2200.0 < above_m.max() < 2600.0
    assert above_m.min() > -40.0
    across = normals(land)
    area = np.linalg.norm(across, axis=1)
    steep = across[:, 1] < np.cos(np.radians(50.0)) * area
    assert area[steep].sum() < 0.05 * area.sum()


def test_peaks_stand_near_and_far(land):
    """In view, within 25 degrees of west, land rises above 900 m at 5, 15 and 29 km."""
    x, z = land[:, 0, 0], land[:, 0, 2]
    away_m = np.hypot(x, z)
    ahead = (x < 0) & (np.abs(z) < np.tan(np.radians(25.0)) * -x)
    above_m = land[:, 0, 1] + fall_m(x, z)
    for near_m, far_m in ((4e3, 7e3), (13e3, 17e3), (27e3, 32e3)):
        assert above_m[ahead & (away_m > near_m) & (away_m < far_m)].max() > 900.0


def test_the_rim_lies_on_the_round_planet(land):
    """At its rim the land is the planet's surface, R - sqrt(R^2 - d^2) below 0, within rounding."""
    x, y, z = np.moveaxis(land.reshape(-1, 3), 1, 0)
    rim = (x == -34560.0) | (x == 6400.0) | (np.abs(z) == 20480.0)
    below_m = fall_m(x[rim], z[rim])
    np.testing.assert_allclose(-y[rim], below_m, atol=SPACING_M / 2 + 1e-6)
    assert below_m.max() > 120.0


def test_there_is_no_cliff_at_the_rim(land):
    """Within 400 m of the rim the land stays flatter than one in ten beyond its curvature."""
    middle = land.mean(axis=1)
    inwards = np.minimum.reduce([
        middle[:, 0] + 34560.0, 6400.0 - middle[:, 0], 20480.0 - np.abs(middle[:, 2])
    ])  # fmt: skip
    near = normals(land[inwards < 400.0])
    assert np.hypot(near[:, 0], near[:, 2]).max() < 0.1 * np.linalg.norm(near, axis=1).max()
    rise = np.hypot(near[:, 0], near[:, 2]) / near[:, 1]
    assert np.percentile(rise, 99) < 0.1


def test_normals_agree_with_the_land(terrain):
    """Unit normals on the front side of their triangles."""
    for place in terrain.meshes:
        assert front_cosines(place.mesh).min() > 0.0, place.name


def test_normals_have_no_seam_between_tiles(terrain):
    """Where tiles meet, each point has one normal and one colour, so that no line shows."""
    found: dict[tuple[float, ...], set[tuple[float, ...]]] = {}
    for place in terrain.meshes:
        if "land" in place.name:
            mesh = place.mesh
            world = np.asarray(mesh.vertices) * SPACING_M + place.world_from_model[:3, 3]
            looks = np.column_stack([mesh.normals, mesh.colours])
            for point, look in zip(world.tolist(), looks.round(6).tolist(), strict=True):
                found.setdefault(tuple(point), set()).add(tuple(look))
    several = Counter(len(looks) for looks in found.values())
    assert set(several) == {1}


def test_albedos_are_those_of_land(terrain):
    """From dark spruces (2 %) to old snow (65 % on average, never above 90 %)."""
    for place in terrain.meshes:
        colours = place.mesh.colours
        material = place.mesh.material
        if colours is None:
            assert material.baseColorFactor[:3].max() < 0.3
            continue
        mean = peak = 1.0
        if material.baseColorTexture is not None:
            texels = np.asarray(material.baseColorTexture.convert("RGB")) / 255.0
            linear = np.where(texels > 0.04045, ((texels + 0.055) / 1.055) ** 2.4, texels / 12.92)
            mean, peak = linear.mean(), linear.max()
        assert colours[:, :3].max() * peak <= 1.0
        assert colours[:, :3].max() * mean < 0.7
        assert colours[:, :3].min() * mean > 0.005


def test_the_rim_has_the_bare_grounds_albedo(terrain):
    """The rim is grey 0.1, the skies' default ground, within a step of 8 bits."""
    for place in terrain.meshes:
        if "land" in place.name:
            world = np.asarray(place.mesh.vertices) * SPACING_M + place.world_from_model[:3, 3]
            rim = (world[:, 0] == -34560.0) | (np.abs(world[:, 2]) == 20480.0)
            albedo = place.mesh.colours[rim, :3] * (2.0 / 3.0)
            np.testing.assert_allclose(albedo, 0.1, atol=0.5 / 255)


def test_the_project_stands_on_the_land(land):
    """The view's eye is at a person's height above the meadow, and it looks west."""
    project = load_project(SCENES / "terrain.toml")
    assert project.camera is not None
    eye, target = np.array(project.camera.eye_m), np.array(project.camera.target_m)
    assert 1.5 < eye[1] - height_at(land, eye[0], eye[2]) < 6.0
    assert target[0] < eye[0]
