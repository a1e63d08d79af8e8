"""What glossy parts see around them, as cube maps: whom their rays meet, and its light."""

from contextlib import nullcontext
from unittest.mock import patch

import numpy as np
import pytest
import trimesh
from boxes import box, floor, hour, quads
from light_transport.rays import mirror_rays
from light_transport.rays.mirror_rays import MirrorParts, mirror_parts
from light_transport.surfaces.surfaces import surfaces_of
from light_transport.transport import SceneTransport
from trimesh.visual.material import PBRMaterial

from vrut_lite.geometry.cube_map import FACES
from vrut_lite.scene.loading import load_scene
from vrut_lite.scene.packing import packed

NOBODY = 99


def parts(transport, part, centre, radius=0.05, hollow=False, facing=(0.0, 0.0, 0.0)):
    """One part that is seen from a place in metres."""
    surfaces = transport.surfaces
    place = (np.array([centre], float) - surfaces.centre_m) / surfaces.radius_m
    return MirrorParts(
        np.array([part], np.int32),
        place,
        np.array([radius]),
        np.array([hollow], bool),
        np.array([facing]),
    )


def seen(scene, now, part, centre, rays=64, **more):
    """The cube (6, e, e, 4) of a part, and the bake that it is of."""
    transport = SceneTransport(*scene)
    # No part of the scene: one point serves for it.
    nobody = patch.object(mirror_rays, "_share_from_middle", return_value=1.0)
    with nobody if part == NOBODY else nullcontext():
        transport.add_mirrors(parts(transport, part, centre, **more))
    transport.add_rays(rays)
    light = transport.light(now)
    return light.mirrors[0].astype(float), transport, light


def walls_of_a_room(ball=True):
    inner = box((0.9, 0.9, 0.9), (1.1, 1.1, 1.1)) if ball else []
    return [*box((0, 0, 0), (2, 2, 2), inwards=True), *inner]


def test_a_body_in_a_glowing_box_sees_each_wall_where_it_is():
    """Walls that glow by 1 to 6 and reflect nothing show M / pi, each in its direction, and the
    body itself, in whose middle the rays begin, is not seen."""
    scene = quads(*walls_of_a_room(), reflectance=0.0)
    # box() has +x, -x, +y, -y, +z and -z, as a cube map has its faces.
    for side in range(6):
        scene[0].emitted_rgb[2 * side : 2 * side + 2] = side + 1.0
    scene[0].part[:] = np.minimum(scene[0].part, 6)
    cube, _, _ = seen(scene, hour(), 6, (1, 1, 1))
    for side, name in enumerate(FACES):
        expected = np.append(np.full(3, (side + 1.0) / np.pi), 1.0)
        inner = cube[side, 1:-1, 1:-1]
        np.testing.assert_allclose(inner, np.broadcast_to(expected, inner.shape), rtol=1e-5,
                                   err_msg=name)  # fmt: skip


def test_a_mirror_in_a_furnace_disappears():
    """In a closed box that glows and reflects by a half all radiance is M / (1 - rho) / pi, the
    mirror's cube too."""
    scene = quads(*walls_of_a_room(ball=False), reflectance=0.5, emitted=np.pi)
    cube, _, _ = seen(scene, hour(), NOBODY, (1, 1, 1), rays=256)
    np.testing.assert_allclose(cube[..., :3], 2.0, rtol=0.01)
    assert (cube[..., 3] == 1.0).all()


def test_open_sky_and_ground_are_left_to_the_frame():
    """Above the floor alpha is 0 and no light; below it is 1, at the floor's distance."""
    scene = quads(floor(-9, 9, -9, 9), reflectance=0.5)
    cube, transport, _ = seen(scene, hour(2.0), NOBODY, (0, 3, 0))
    assert (cube[2] == 0.0).all()
    np.testing.assert_array_equal(cube[3, ..., 3], 1.0)
    nearness = transport.mirrors.nearness[0] / transport.surfaces.radius_m
    edge = nearness.shape[1]
    assert 1.0 / nearness[3, edge // 2, edge // 2] == pytest.approx(3.0, rel=1e-3)
    assert (nearness[2] == 0.0).all()


def corridor(*walls):
    """A floor of 12 by 2 m (part 0), 2.5 m below a ceiling, between walls; and more of these."""
    x, y = (-1.0, 1.0), (0.0, 2.5)
    inner = box((x[0], y[0], -6.0), (x[1], y[1], 6.0), inwards=True)
    return quads(inner[3], *(inner[side] for side in (0, 1, 2, 4, 5)), *walls, texels=12)


def test_the_long_floor_of_a_room_has_a_cube():
    """All of a convex room is seen from its middle, however long it is; and the ground below a
    thin floor, which no eye sees in it, does not count."""
    below = floor(-1, 1, -6, 6, y=-0.1)
    transport = SceneTransport(*corridor(below))
    transport.add_mirrors(parts(transport, 0, (0, -0.05, 0), radius=0.9))
    assert transport.mirrors is not None


def test_a_floor_that_goes_round_a_corner_has_none():
    """Behind two walls across, one point sees a third of what the floor does."""
    across = [[[-1, 0, z], [1, 0, z], [1, 2.5, z], [-1, 2.5, z]] for z in (-2.0, 2.0)]
    transport = SceneTransport(*corridor(*across, *(wall[::-1] for wall in across)))
    transport.add_mirrors(parts(transport, 0, (0, 0.1, 0), radius=0.9))
    assert transport.mirrors is None


def test_a_door_to_the_sky_is_as_near_as_its_frame():
    """Texels of an opening have the distance of those around it, not infinity; and no light."""
    inner = box((-1, 0, -3), (1, 2, 3), inwards=True)
    sides = [inner[side] for side in (3, 0, 1, 2, 4)]
    end = [
        [[x0, y0, -3], [x1, y0, -3], [x1, y1, -3], [x0, y1, -3]]
        for x0, x1, y0, y1 in ((-1, -0.4, 0, 2), (0.4, 1, 0, 2), (-0.4, 0.4, 1.6, 2))
    ]
    transport = SceneTransport(*quads(*sides, *end))
    transport.add_mirrors(parts(transport, 0, (0, 0.5, 0), radius=0.9))
    rays, middle = transport.mirrors, transport.mirrors.nearness.shape[-1] // 2
    assert (rays.target[0, 5, middle, middle] == mirror_rays.SKY).all()
    distance = 1.0 / (rays.nearness[0, 5, middle, middle] / transport.surfaces.radius_m)
    assert distance == pytest.approx(3.0, rel=0.05)


def test_cubes_agree_with_a_sum_in_double_precision():
    """Each texel is the mean over its rays of (M + rho (E + sun)) / pi of the map's texel there,
    the shadow of a box in the sun's way among them."""
    scene = quads(
        floor(-4, 4, -4, 4), *box((-1, 1, -1), (1, 1.5, 1)), texels=16, reflectance=[0.8, 0.5, 0.2]
    )
    scene[0].emitted_rgb[:2] = 1.5
    now = hour(2.0, irradiance=30.0, key=(0.1, 1.0, 0.05))
    cube, transport, light = seen(scene, now, NOBODY, (2.5, 0.5, 0.0), rays=128)
    rays, texels = transport.mirrors, transport.texels
    assert (rays.row < len(texels.pixel)).all()
    column, row = texels.pixel[rays.row].T
    irradiance = light.texels[row, column, :3].astype(float)
    surfaces = transport.surfaces
    triangle = texels.triangle[rays.row]
    # Texels in the shadow's middle and far from it: its edge depends on where in a texel one asks.
    place = (texels.place[rays.row] * surfaces.radius_m + surfaces.centre_m).astype(float)
    cosine = np.clip(transport.receivers.geometry.faces[triangle] @ now.key_direction, 0.0, None)
    at_level = place[:, [0, 2]] - np.array([0.1, 0.05]) * (place[:, 1:2] - 1.0)
    from_shadow = np.abs(at_level).max(axis=1) - 1.0
    below = place[:, 1] < 1.0
    share = np.where(below & (from_shadow < 0.0), 0.0, cosine)
    known = ~below | (np.abs(from_shadow) > 0.6)
    sent = surfaces.emitted_rgb[triangle] + surfaces.reflectance_rgb[triangle] * (
        irradiance + share[:, None] * np.array(now.key_irradiance_rgb)
    )
    sent = np.concatenate([sent / np.pi, np.zeros((1, 3))])
    known = np.append(known, True)[rays.target[0]].all(axis=-1)
    expected = sent[rays.target[0]].mean(axis=-2)
    assert known.mean() > 0.8
    assert (share[below] == 0.0).any()
    np.testing.assert_allclose(cube[known][:, :3], expected[known], rtol=1e-4, atol=1e-5)
    np.testing.assert_array_equal(cube[..., 3], (rays.target[0] >= 0).mean(axis=-1))


def test_light_does_not_depend_on_mirrors():
    """Texels are the same to the bit with and without cubes beside them."""
    scene = quads(*walls_of_a_room(), reflectance=0.5, emitted=1.0)
    now = hour(1.0, irradiance=9.0)
    _, _, beside = seen(scene, now, 6, (1, 1, 1))
    transport = SceneTransport(*scene)
    transport.add_rays(64)
    alone = transport.light(now)
    assert alone.mirrors is None
    np.testing.assert_array_equal(alone.texels, beside.texels)


def test_a_flat_mirror_does_not_see_behind_itself():
    """Before a wall that glows by 3, behind a hidden one that glows by 9: 3 to all sides of it."""
    wall = [[-9, 4, -9], [9, 4, -9], [9, 4, 9], [-9, 4, 9]]
    scene = quads(floor(-9, 9, -9, 9, y=-1.0), wall, reflectance=0.0)
    scene[0].emitted_rgb[:2], scene[0].emitted_rgb[2:] = 9.0, 3.0
    cube, _, _ = seen(scene, hour(), NOBODY, (0, 0, 0), facing=(0.0, 1.0, 0.0))
    np.testing.assert_allclose(cube[2, 8:-8, 8:-8, 0], 3.0 / np.pi, rtol=1e-5)
    np.testing.assert_allclose(cube[3, 8:-8, 8:-8, 0], 3.0 / np.pi, rtol=1e-5)


def test_parts_are_seen_from_where_their_surroundings_are(tmp_path):
    """Glossy parts alone, the largest first: a ball from its middle, a sheet from before it, a
    room from within, where it mirrors itself too."""
    ball = trimesh.creation.icosphere(2, 0.5)
    sheet = trimesh.Trimesh([[0, 0, 0], [4, 0, 0], [4, 4, 0], [0, 4, 0]], [[0, 1, 2], [0, 2, 3]])
    room = trimesh.creation.box((6, 6, 6))
    room.invert()
    dull = trimesh.creation.box((1, 1, 1))
    stage = trimesh.Scene()
    for mesh, roughness in ((ball, 0.1), (sheet, 0.1), (room, 0.1), (dull, 0.5)):
        material = PBRMaterial(metallicFactor=1.0, roughnessFactor=roughness)
        mesh.visual = trimesh.visual.TextureVisuals(material=material)
        stage.add_geometry(mesh)
    stage.export(tmp_path / "parts.glb")
    scene = packed(load_scene(tmp_path / "parts.glb"))
    surfaces = surfaces_of(scene)
    found = mirror_parts(scene, surfaces)
    assert found.part.tolist() == [2, 1, 0]
    assert found.hollow.tolist() == [True, False, False]
    np.testing.assert_array_equal(found.facing, [[0, 0, 0], [0, 0, 1], [0, 0, 0]])
    centre_m = found.centre * surfaces.radius_m + surfaces.centre_m
    expected = [[0, 0, 0], [2, 2, 0.1 * np.sqrt(8.0)], [0, 0, 0]]
    np.testing.assert_allclose(centre_m, expected, atol=1e-6)
