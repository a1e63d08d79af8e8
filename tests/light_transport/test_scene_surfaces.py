"""What light transport takes from an opened scene: reflectance, emission, opacity, normals."""

import numpy as np
import pytest
import trimesh
from light_transport.surfaces.map_means import linear, triangle_means
from light_transport.surfaces.surfaces import GROUND, surfaces_of
from PIL import Image

from vrut_lite.geometry.reflection import all_bounces, reflectance, reflectance_table
from vrut_lite.messages.scene_content import MaterialMap, Mesh, Sampler
from vrut_lite.scene.loading import load_scene
from vrut_lite.scene.packing import packed


def opened(tmp_path, *meshes, transforms=None):
    scene = trimesh.Scene()
    for number, mesh in enumerate(meshes):
        matrix = None if transforms is None else transforms[number]
        scene.add_geometry(mesh, transform=matrix)
    path = tmp_path / "scene.glb"
    scene.export(path)
    return packed(load_scene(str(path)))


def box(**material):
    mesh = trimesh.creation.box((2, 2, 2))
    paint = trimesh.visual.material.PBRMaterial(**material)
    mesh.visual = trimesh.visual.TextureVisuals(uv=np.zeros((8, 2)), material=paint)
    return mesh


def test_paint_under_a_coat_sends_back_what_the_coat_leaves_and_the_coat(tmp_path):
    """albedo (1 - c) + c, with the coat's own mean reflectance."""
    paint = box(baseColorFactor=(255, 0, 51, 255), metallicFactor=0.0, roughnessFactor=1.0)
    found = surfaces_of(opened(tmp_path, paint))
    c = float(reflectance_table()[-1, 0, 2])
    albedo = np.array([1.0, 0.0, 0.2])
    np.testing.assert_allclose(found.reflectance_rgb[0], albedo * (1 - c) + c, atol=1e-6)


@pytest.mark.parametrize("roughness", [0.0, 0.4, 1.0])
def test_metal_sends_back_what_its_facets_do(tmp_path, roughness):
    """White all; colours whiter by grazing light, deeper by bounces between facets; black nothing.

    The mean over the hemisphere of what comes back from each direction: a gold of roughness 1
    sends back 0.16 of blue, not its 0.28.
    """
    colours = np.array([[255, 255, 255], [204, 158, 71], [0, 0, 0]])
    metals = [
        box(baseColorFactor=(*map(int, c), 255), metallicFactor=1.0, roughnessFactor=roughness)
        for c in colours
    ]
    found = surfaces_of(opened(tmp_path, *metals))
    mu = (np.arange(200) + 0.5) / 200
    a, b = reflectance(mu, roughness)
    for number, f0 in enumerate(colours[:, None] / 255.0):
        back = all_bounces(f0.T, 1.0 if f0.any() else 0.0, a, b)
        expected = (2.0 * mu * back).mean(axis=1)
        np.testing.assert_allclose(found.reflectance_rgb[12 * number], expected, atol=4e-3)


def test_light_in_candelas_leaves_as_watts(tmp_path):
    """683 lm/W: a glow of 1 cd/m2 is pi / 683 W/m2 of radiosity."""
    glowing = box(emissiveFactor=(1.0, 0.5, 0.0))
    found = surfaces_of(opened(tmp_path, glowing))
    expected = np.pi / 683.0 * np.array([1.0, 0.5, 0.0])
    np.testing.assert_allclose(found.emitted_rgb[3], expected, rtol=1e-2)


def test_triangles_stand_in_the_mesh_s_order_and_the_ground_comes_last(tmp_path):
    """The layout counts on it: triangle k of a part is the mesh's triangle k."""
    scene = opened(tmp_path, box(), trimesh.creation.icosphere(1))
    found = surfaces_of(scene)
    for part in range(2):
        expected = scene.geometry.world_triangles(part) - found.centre_m
        np.testing.assert_array_equal(found.corners_m[found.part == part], expected)
    assert found.part.tolist() == sorted(found.part.tolist(), key=lambda p: p % 1000)
    assert (found.part[-2:] == GROUND).all()
    np.testing.assert_array_equal(found.face_normals()[-2:], [[0.0, 1.0, 0.0]] * 2)


def test_a_mirrored_part_keeps_its_outside(tmp_path):
    """A matrix that mirrors winds triangles anew; faces still look away from the body."""
    mirrored = np.diag([-1.0, 2.0, 1.0, 1.0])
    found = surfaces_of(opened(tmp_path, trimesh.creation.icosphere(1), transforms=[mirrored]))
    body = found.part == 0
    outwards = np.einsum("fi,fi->f", found.face_normals(), found.corners_m.mean(axis=1))
    assert (outwards[body] > 0.0).all()


def test_a_map_is_averaged_in_linear_light_over_each_triangle(tmp_path):
    """A triangle on the black half is black; one over many tiles has the mean of both."""
    texels = np.zeros((64, 64, 3), np.uint8)
    texels[:, 32:] = 255
    uv = np.array(
        [[0, 0], [0.4, 0], [0, 1], [0.6, 0], [0.9, 0], [0.6, 1], [0, 0], [64, 0], [0, 64]]
    )
    mesh = Mesh(np.zeros((9, 3)), np.zeros((9, 3)), np.arange(9).reshape(3, 3), uv, None, None, 0)
    means = triangle_means(MaterialMap(texels, 0), mesh, linear)
    np.testing.assert_allclose(means[:2, 0], [0.0, 1.0])
    assert means[2, 0] == pytest.approx(0.5, abs=0.01)


def test_a_cut_out_lets_light_through_its_holes(tmp_path):
    """Opacity is the share of texels that are left, not their mean alpha."""
    texels = np.full((32, 32, 4), 255, np.uint8)
    texels[:, :16, 3] = 100
    sheet = trimesh.Trimesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]], process=False)
    paint = trimesh.visual.material.PBRMaterial(
        baseColorTexture=Image.fromarray(texels), alphaMode="MASK", alphaCutoff=0.5
    )
    uv = np.array([[0, 0], [8, 0], [0, 8]])
    sheet.visual = trimesh.visual.TextureVisuals(uv=uv, material=paint)
    found = surfaces_of(opened(tmp_path, sheet))
    assert found.opacity[0] == pytest.approx(0.5, abs=0.05)
    assert (found.opacity[1:] == 1.0).all()


@pytest.mark.parametrize(("wrap", "expected"), [("repeat", 0.0), ("clamp", 1.0), ("mirror", 1.0)])
def test_a_map_goes_on_beyond_its_edge_as_its_sampler_says(wrap, expected):
    """A triangle just east of a map whose western half is black and whose eastern is white."""
    texels = np.zeros((4, 4, 3), np.uint8)
    texels[:, 2:] = 255
    uv = np.array([[1.1, 0.2], [1.4, 0.2], [1.1, 0.4]])
    mesh = Mesh(np.zeros((3, 3)), np.zeros((3, 3)), np.arange(3)[None], uv, None, None, 0)
    means = triangle_means(MaterialMap(texels, 0, Sampler(wrap, "clamp")), mesh, linear)
    np.testing.assert_allclose(means[0], expected)
