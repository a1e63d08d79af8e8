"""What a file has and the scene does not show is told, and does not keep it from opening."""

import base64
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from loaded_scenes import WriteScene, add_array, give
from scene_files import png_bytes

from vrut_lite.errors import UserError
from vrut_lite.scene.import_warnings import MOST_KINDS, Notices
from vrut_lite.scene.loading import load_scene


def test_each_kind_is_told_once_with_its_count() -> None:
    """A file with a thousand points says so in one line."""
    notices = Notices()
    for _ in range(1000):
        notices.tell("point", "not drawn")
    notices.tell("lamp", "dark", 0)
    notices.tell("clip", "at rest")
    assert notices.lines() == ("point (1,000 times): not drawn", "clip: at rest")


def test_no_file_can_flood_the_notices() -> None:
    """Names of the file are escaped and cut off, and of very many kinds the first are told."""
    notices = Notices()
    for number in range(MOST_KINDS + 8):
        notices.tell(f"\n\x1b[31m{number}" + "x" * 10_000, "not drawn")
    lines = notices.lines()
    assert len(lines) == MOST_KINDS + 1
    assert all(line.isprintable() and len(line) < 400 for line in lines)
    assert lines[-1] == "and 8 other kinds of things: left out"


def test_extensions_that_are_not_read_are_told(write_square: WriteScene) -> None:
    """An unread extension is named with the number of objects that have it; unseen ones are not."""

    def edit(document: dict[str, Any]) -> None:
        document["extensionsUsed"] = ["KHR_audio", "VND_sparkle", "KHR_xmp_json_ld"]
        document["extensions"] = {"KHR_audio": {}}
        document["nodes"][0]["extensions"] = {"VND_sparkle": {}}
        document["materials"][0]["extensions"] = {"VND_sparkle": {}}

    assert load_scene(write_square(edit)).notices == (
        "extension KHR_audio: silent",
        "extension VND_sparkle (2 times): not drawn",
    )


@pytest.mark.parametrize("name", ["KHR_materials_dispersion", "KHR_audio"])
def test_a_required_extension_with_a_plain_reading_is_told(
    write_square: WriteScene, name: str
) -> None:
    """A surface without its extra layer is still a surface: the file opens."""
    path = write_square(lambda document: document.update(extensionsRequired=[name]))
    (line,) = load_scene(path).notices
    assert line.startswith(f"extension {name}: ")


def test_a_required_extension_without_a_plain_reading_is_refused(write_square: WriteScene) -> None:
    """Without what packs the numbers there is nothing to read: the line says what converts it."""
    path = write_square(lambda document: document.update(extensionsRequired=["VND_packed"]))
    with pytest.raises(UserError, match=r"VND_packed, which is not supported.*gltf-transform"):
        load_scene(path)


def test_points_and_other_scenes_are_told(write_square: WriteScene) -> None:
    """Whatever else the file has beside triangles is named."""

    def edit(document: dict[str, Any]) -> None:
        primitives = document["meshes"][0]["primitives"]
        primitives += [{"attributes": {"POSITION": 0}, "mode": mode} for mode in (0, 1, 3)]
        document["scenes"].append({"nodes": []})

    assert load_scene(write_square(edit)).notices == (
        "points or lines (3 times): one pixel wide, in their colours; not path traced, and without "
        "shadows",
        "scene beside the default one: not drawn",
    )


def test_textures_without_coordinates_are_told(write_square: WriteScene) -> None:
    """A map whose coordinates are missing, or are a third set, is left out and named."""

    def edit(document: dict[str, Any]) -> None:
        uv = np.zeros((4, 2), "<f4")
        give(document, **{f"TEXCOORD_{n}": add_array(document, uv) for n in (0, 2)})
        png = base64.b64encode(png_bytes()).decode()
        document["images"] = [{"uri": f"data:image/png;base64,{png}"}]
        document["textures"] = [{"source": 0}]
        document["materials"][0] = {
            "pbrMetallicRoughness": {"baseColorTexture": {"index": 0}},
            "normalTexture": {"index": 0, "texCoord": 1},
            "emissiveTexture": {"index": 0, "texCoord": 2},
        }

    assert load_scene(write_square(edit)).notices == (
        "emissiveTexture on a third set of texture coordinates: left out",
        "textures without their TEXCOORD_1: left out",
    )


def test_what_obj_and_mtl_have_more_is_told(write_obj: WriteScene) -> None:
    """Lines, bump maps and materials that nobody defines are named."""
    path = write_obj(
        "newmtl paint\nKd 1 0 0\nmap_Bump bumps.png\n",
        faces="f 1 2 3 4\nl 1 2\nl 2 3\nusemtl lost\nf 1 2 3",
    )
    assert set(load_scene(path).notices) == {
        "points or lines (2 times): one pixel wide, in their colours; not path traced, and without "
        "shadows",
        "map_bump of the MTL: left out",
        "material that no MTL defines: grey instead",
    }


def test_a_face_without_coordinates_leaves_the_others_theirs(write_obj: WriteScene) -> None:
    """A floor that nobody unwrapped does not take the walls' bricks away, and is told."""
    path = write_obj("newmtl paint\nmap_Kd paint.png\n", faces="f 1/1 2/2 3/3 4/4\nf 3 2 1")
    (path.parent / "paint.png").write_bytes(png_bytes())
    (place,) = load_scene(path).meshes
    uv = np.asarray(place.mesh.uv)[place.mesh.faces]
    np.testing.assert_allclose(uv[0], [[0, 0], [1, 0], [1, 1]])
    np.testing.assert_allclose(uv[2], 0.0)
    assert load_scene(path).notices == (
        "triangle without coordinates of its texture: in one colour of it",
    )


@pytest.mark.parametrize(("name", "says"), [("a.fbx", "Blender"), ("a.xyz", "export it as one")])
def test_other_formats_name_what_converts_them(tmp_path: Path, name: str, says: str) -> None:
    """Where a common program reads the format, the sentence names it."""
    (tmp_path / name).write_bytes(b"x")
    with pytest.raises(UserError, match=says):
        load_scene(tmp_path / name)


def test_an_obj_that_came_alone_opens(write_obj: WriteScene) -> None:
    """Its library or its pictures are often not beside it: it is grey, and says why."""
    path = write_obj("newmtl paint\nmap_Kd brick.png\n")
    assert load_scene(path).notices == ("picture brick.png: missing, left out",)
    (path.parent / "square.mtl").unlink()
    assert load_scene(path).notices == (
        "material library square.mtl: missing, grey instead",
        "material that no MTL defines: grey instead",
    )


def test_variants_and_maps_by_their_mean_are_told(write_square: WriteScene) -> None:
    """Which other looks a file has, and which of its maps are not drawn texel by texel."""

    def edit(document: dict[str, Any]) -> None:
        variants = {"variants": [{"name": "beach"}, {"name": "midnight"}]}
        document["extensions"] = {"KHR_materials_variants": variants}
        document["extensionsUsed"] = ["KHR_materials_variants", "KHR_materials_sheen"]
        png = base64.b64encode(png_bytes()).decode()
        document["images"] = [{"uri": f"data:image/png;base64,{png}"}]
        document["textures"] = [{"source": 0}]
        sheen = {"sheenColorFactor": [1, 1, 1], "sheenColorTexture": {"index": 0}}
        document["materials"][0] = {"extensions": {"KHR_materials_sheen": sheen}}

    assert load_scene(write_square(edit)).notices == (
        "sheenColorTexture: its mean is taken",
        "material variants beach, midnight: the default materials are shown (--variant NAME, or "
        "Variant in the Scene panel)",
    )
