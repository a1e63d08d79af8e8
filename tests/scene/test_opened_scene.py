"""An opened scene as a message: its arrays, its key, and what a journal keeps of it."""

import io
from pathlib import Path

import msgspec
import numpy as np
import pytest
import trimesh

from vrut_lite.array import Array
from vrut_lite.errors import UserError
from vrut_lite.kernel.bus import Kernel
from vrut_lite.message_codec import arrays_of, digest_of, to_plain
from vrut_lite.messages.scene import LoadScene, SceneOpened
from vrut_lite.recording.comparison import entry_difference
from vrut_lite.recording.earlier_names import in_todays_words
from vrut_lite.recording.entry import Entry
from vrut_lite.recording.recorder import Recorder
from vrut_lite.scene.loading import load_scene
from vrut_lite.scene.manager import SceneManager
from vrut_lite.scene.packing import packed

SCENES = Path(__file__).parents[2] / "scenes"


@pytest.mark.parametrize("name", ["pavilion.gltf", "street.obj", "spheres.glb"])
def test_parts_stand_as_the_file_has_them(name):
    """Triangles, coordinates, colours, materials and their maps: those of the loaded meshes."""
    loaded = load_scene(SCENES / name)
    opened = packed(loaded)
    opened.check()
    opened.check_arrays()
    materials = opened.materials.all()
    for part, place in enumerate(loaded.meshes):
        np.testing.assert_array_equal(
            opened.geometry.world_triangles(part), place.world_triangles()
        )
        mesh = opened.geometry.mesh(opened.geometry.part_mesh.values[part])
        np.testing.assert_array_equal(mesh.normals, place.mesh.normals)
        uv = place.mesh.uv
        assert (mesh.uv is None) is (uv is None)
        if uv is not None:
            np.testing.assert_array_equal(mesh.uv, uv)
        source, material = place.mesh.material, materials[mesh.material]
        assert (material.name, material.alpha_mode) == (source.name, source.alphaMode)
        np.testing.assert_array_equal(material.base_colour_rgba, source.baseColorFactor)
        assert (source.baseColorTexture is None) is ("base_colour" not in material.maps)
        if source.baseColorTexture is not None:
            texels = material.maps["base_colour"].texels
            np.testing.assert_array_equal(texels, np.asarray(source.baseColorTexture))


def test_repeated_meshes_are_stored_once():
    """The pavilion's columns are one mesh in many places: no vertex is repeated for them."""
    loaded = load_scene(SCENES / "pavilion.gltf")
    geometry = packed(loaded).geometry
    meshes = {id(place.mesh): place.mesh for place in loaded.meshes}
    assert geometry.mesh_count == len(meshes) < len(loaded.meshes)
    assert geometry.positions_m.shape[0] == sum(len(mesh.vertices) for mesh in meshes.values())


def test_the_content_key_is_of_the_content(tmp_path):
    """The same box under another name has the same key, a larger one another."""
    for name, size_m in (("a.glb", 2), ("b.glb", 2), ("c.glb", 3)):
        trimesh.creation.box((size_m,) * 3).export(tmp_path / name)
    a, b, c = (packed(load_scene(tmp_path / f"{name}.glb")).content_key for name in "abc")
    assert a == b != c


def test_an_opened_scene_is_read_only():
    """Every module hears the same arrays."""
    opened = packed(load_scene(SCENES / "spheres.glb"))
    arrays = arrays_of(opened)
    assert len(arrays) > 20
    assert not any(array.values.flags.writeable for array in arrays)


def test_a_mesh_beyond_its_arrays_is_refused():
    """Numbers of a stranger would be read from beyond the end."""
    opened = packed(load_scene(SCENES / "spheres.glb"))
    table = opened.geometry.meshes.values.copy()
    table[0, 1] = 10**6
    geometry = msgspec.structs.replace(opened.geometry, meshes=Array(table))
    with pytest.raises(UserError, match="reach beyond its arrays"):
        msgspec.structs.replace(opened, geometry=geometry).check_arrays()


def test_a_light_journal_of_a_large_scene_is_small():
    """The terrain's 100,000 vertices take less than 8 kB: digests, and some sampled values."""
    journal, kernel = io.BytesIO(), Kernel()
    kernel.add_module(SceneManager)
    recorder = Recorder(kernel, journal)
    kernel.inject(LoadScene(path=str(SCENES / "large" / "terrain.glb")))
    kernel.pump_until_idle()
    recorder.close()
    assert kernel.last(SceneOpened).geometry.positions_m.shape[0] > 100_000
    assert len(journal.getvalue()) < 16_000
    assert len(msgspec.json.encode(to_plain(kernel.last(SceneOpened)))) < 16_000


def test_a_journal_from_before_scenes_told_their_content_agrees():
    """A SceneOpened with the same bounds is the same scene; with others it is not."""
    opened = packed(load_scene(SCENES / "spheres.glb"))
    here = to_plain(opened)
    told = {name: here[name] for name in ("path", "lower_m", "upper_m", "triangles")}
    for message, same in ((told, True), ({**told, "triangles": 5}, False)):
        name, there = in_todays_words("SceneOpened", message)
        entries = [
            Entry(
                kind="derived", type_name=kind, sender="scene",
                digest=digest_of(kind, plain), message=plain,
            )
            for kind, plain in ((name, there), ("SceneOpened", here))
        ]  # fmt: skip
        assert (entry_difference(*entries, by_value=False) is None) is same
