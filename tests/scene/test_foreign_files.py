"""Files that other programs have written."""

import contextlib
from io import BytesIO
from pathlib import Path

import DracoPy
import msgspec
import numpy as np
import pytest
import trimesh
from hypothesis import given
from hypothesis import strategies as st
from loaded_scenes import MODELS, material_of
from PIL import Image
from scene_files import SQUARE, TRIANGLES, png_bytes

from vrut_lite.errors import UserError
from vrut_lite.scene.budget import SceneBudget
from vrut_lite.scene.draco_header import read_draco_counts
from vrut_lite.scene.gltf_file import read_gltf_file
from vrut_lite.scene.gltf_scene import GltfScene
from vrut_lite.scene.import_warnings import Notices
from vrut_lite.scene.loading import load_scene
from vrut_lite.scene.scene_file_error import SceneFileError


def test_foreign_model() -> None:
    """A model that others made: interleaved vertices, a JPEG inside (counts by its header)."""
    scene = load_scene(MODELS / "pmndrs.glb")
    assert scene.triangles == 4656 // 3
    np.testing.assert_allclose(scene.upper_m, [3.499999761581421] * 2 + [1.0000207424163818])
    material = material_of(scene)
    assert material.baseColorTexture.size == (2048, 2048)
    assert (material.metallicFactor, material.roughnessFactor) == (0.0, 0.5)
    mesh = scene.meshes[0].mesh
    assert mesh.uv.shape == (1074, 2)
    assert 0.0 <= mesh.uv.min() <= mesh.uv.max() <= 1.0


def test_foreign_model_packed_by_draco() -> None:
    """The same model as it was published, packed by Draco, has the unpacked one's triangles.

    Draco keeps 14 bits of a position (glTF-Transform's default), so corners agree to 1e-3.
    """
    packed, plain = load_scene(MODELS / "pmndrs_draco.glb"), load_scene(MODELS / "pmndrs.glb")
    assert packed.triangles == plain.triangles
    np.testing.assert_allclose(packed.upper_m, plain.upper_m, atol=1e-3)
    assert material_of(packed).baseColorTexture.size == (2048, 2048)
    ours, theirs = packed.meshes[0].mesh, plain.meshes[0].mesh
    areas = [trimesh.Trimesh(mesh.vertices, mesh.faces).area for mesh in (ours, theirs)]
    np.testing.assert_allclose(*areas, rtol=1e-3)
    np.testing.assert_allclose(ours.uv.max(axis=0), theirs.uv.max(axis=0), atol=1e-3)


@pytest.mark.parametrize("seed", range(20))
def test_mangled_draco_is_refused_or_read(tmp_path: Path, seed: int) -> None:
    """Packed bytes with flipped bits either unpack to a scene or give one sentence."""
    data = bytearray((MODELS / "pmndrs_draco.glb").read_bytes())
    rng = np.random.default_rng(seed)
    for at in rng.integers(len(data) // 2, len(data), 12):
        data[at] ^= int(rng.integers(1, 256))
    path = tmp_path / "mangled.glb"
    path.write_bytes(data)
    with contextlib.suppress(UserError):
        load_scene(path)


@pytest.mark.parametrize("level", [0, 1, 7, 10])
def test_dracos_own_counts_are_read(level: int) -> None:
    """Triangles and vertices as Draco's encoder reports them, sequential (level 0) or not."""
    packed = DracoPy.encode(SQUARE, TRIANGLES.astype(np.uint32), compression_level=level)
    assert read_draco_counts(packed) == (2, 4)


@given(st.data())
def test_damaged_draco_heads(data: st.DataObject) -> None:
    """A truncated or changed header gives counts, or is refused as damaged."""
    packed = bytearray(DracoPy.encode(SQUARE, TRIANGLES.astype(np.uint32)))
    for at in data.draw(st.lists(st.integers(0, 24), max_size=4)):
        packed[at] = data.draw(st.integers(0, 255))
    end = data.draw(st.integers(0, len(packed)))
    with contextlib.suppress(SceneFileError):
        assert min(read_draco_counts(bytes(packed[:end]))) >= 0


@pytest.mark.parametrize("promised", [("indices", 3), ("POSITION", 3)])
def test_draco_may_not_hold_more_than_is_promised(promised: tuple[str, int]) -> None:
    """Draco data that exceed the glTF's accessors are refused."""
    path = MODELS / "pmndrs_draco.glb"
    file = read_gltf_file(path, SceneBudget(4 * 2**30), Notices())
    primitive = file.document.meshes[0].primitives[0]
    name, count = promised
    number = primitive.indices if name == "indices" else primitive.attributes[name]
    assert number is not None
    file.document.accessors[number] = msgspec.structs.replace(
        file.document.accessors[number], count=count
    )
    with pytest.raises(SceneFileError, match=r"promised"):
        GltfScene(file).posed(None)


def test_glb_of_trimesh(tmp_path: Path) -> None:
    """trimesh's own export of a textured, placed ball loads as trimesh has it."""
    ball = trimesh.creation.icosphere(subdivisions=2)
    uv = np.random.default_rng(1).random((len(ball.vertices), 2))
    picture = BytesIO(png_bytes((4, 2)))
    material = trimesh.visual.material.PBRMaterial(
        baseColorTexture=Image.open(picture), roughnessFactor=0.25
    )
    ball.visual = trimesh.visual.TextureVisuals(uv=uv, material=material)
    scene = trimesh.Scene()
    scene.add_geometry(ball, transform=trimesh.transformations.translation_matrix([1, 2, 3]))
    scene.export(tmp_path / "ball.glb")
    loaded = load_scene(tmp_path / "ball.glb")
    np.testing.assert_allclose(loaded.meshes[0].mesh.uv, uv, atol=1e-6)
    np.testing.assert_allclose((loaded.lower_m + loaded.upper_m) / 2, [1, 2, 3], atol=1e-6)
    assert material_of(loaded).baseColorTexture.size == (4, 2)
    assert material_of(loaded).roughnessFactor == 0.25
