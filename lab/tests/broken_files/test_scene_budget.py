"""The memory budget of a scene: repeated references are read once, small files stay small."""

import contextlib
import os
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from vrut_lite.errors import UserError
from vrut_lite.memory_limit import VARIABLE
from vrut_lite.scene.budget import (
    BASE_BYTES,
    PEAK_PER_BYTE,
    SceneBudget,
    budget_of_environment,
)
from vrut_lite.scene.loading import LoadedScene, load_scene
from vrut_lite.scene.scene_file_error import SceneFileError
from vrut_lite_lab.broken_files.bombs import BOMBS, Files, bomb, document, gltf, obj, png
from vrut_lite_lab.broken_files.measure import measured, open_scene, scene_files, table

GIB = 2**30
# Larger than what the document takes, so that a file that is read twice shows.
REST_BYTES = 4 * 2**20
quick = settings(
    max_examples=25, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)


def open_files(folder: Path, files: Files, limit_gib: float = 4.0) -> tuple[LoadedScene, float]:
    """The scene in the first of the files, and the bytes that were counted for it."""
    folder.mkdir(exist_ok=True)
    for name, content in files.items():
        (folder / name).write_bytes(content)
    return open_counted(folder / next(iter(files)), limit_gib)


def open_counted(path: Path, limit_gib: float = 4.0) -> tuple[LoadedScene, float]:
    """A scene, and the bytes that were counted for it."""
    budget = SceneBudget(limit_gib * GIB)
    scene = load_scene(path, budget)
    return scene, (budget.peak_bytes - BASE_BYTES) / PEAK_PER_BYTE


def refusal(folder: Path, files: Files, limit_gib: float = 4.0) -> str:
    """The sentence with which files are refused."""
    with pytest.raises(UserError) as refused:
        open_files(folder, files, limit_gib)
    assert "\n" not in str(refused.value)
    return str(refused.value)


def spelled(name: str) -> st.SearchStrategy[str]:
    """Spellings of one file's name: dots, doubled slashes, per cent signs, hard and soft links."""
    letters = [st.sampled_from([letter, f"%{ord(letter):02x}", f"%{ord(letter):02X}"])
               for letter in name]  # fmt: skip
    plain = st.tuples(*letters).map("".join)
    dots = st.lists(st.sampled_from(["./", ".//", "%2e/"]), max_size=4).map("".join)
    return st.tuples(dots, plain | st.sampled_from(["symbolic", "hard"])).map("".join)


def link(folder: Path, name: str) -> None:
    (folder / "symbolic").unlink(missing_ok=True)
    (folder / "hard").unlink(missing_ok=True)
    (folder / "symbolic").symlink_to(name)
    (folder / "hard").hardlink_to(folder / name)


@quick
@given(st.lists(spelled("a.bin"), min_size=2, max_size=12))
def test_a_buffer_of_many_names_is_read_once(tmp_path, names):
    """A buffer that is named by links, dots and per cent signs is in memory only once."""
    uris = [{"byteLength": 36, "uri": name} for name in ["a.bin", *names]]
    files = gltf({"buffers": uris})
    files["a.bin"] += bytes(REST_BYTES)
    (tmp_path / "a.bin").write_bytes(files["a.bin"])
    link(tmp_path, "a.bin")
    scene, counted = open_files(tmp_path, files)
    assert scene.triangles == 1
    assert counted < 1.5 * REST_BYTES


@quick
@given(st.lists(spelled("a.png"), min_size=2, max_size=12), st.booleans())
def test_a_picture_of_many_names_is_decoded_once(tmp_path, names, as_obj):
    """glTF images and MTL maps that name the same picture share the decoded one."""
    side_px = 1024
    picture = png(side_px, side_px)
    if as_obj:
        names = [re.sub("%(..)", lambda code: chr(int(code[1], 16)), name) for name in names]
        mtl = "".join(f"newmtl m{k}\nmap_Kd -clamp on {name}\n" for k, name in enumerate(names))
        lines = "".join(f"usemtl m{k}\nf 1 2 3\n" for k in range(len(names)))
        files = obj(lines, mtl, a_png=picture)
    else:
        numbers = range(len(names))
        worn = [{"pbrMetallicRoughness": {"baseColorTexture": {"index": n}}} for n in numbers]
        primitives = [{"attributes": {"POSITION": 0}, "material": n} for n in numbers]
        files = gltf(
            {
                "images": [{"uri": name} for name in names],
                "textures": [{"source": n} for n in numbers],
                "materials": worn,
                "meshes": [{"primitives": primitives}],
            },
            a_png=picture,
        )
    (tmp_path / "a.png").write_bytes(picture)
    link(tmp_path, "a.png")
    scene, counted = open_files(tmp_path, files)
    worn_pictures = {id(p.mesh.material.baseColorTexture) for p in scene.meshes}
    assert (len(scene.meshes), len(worn_pictures)) == (len(names), 1)
    assert counted < 4 * side_px**2 + 2**20


def test_primitives_of_the_same_arrays_share_them(tmp_path):
    """The same triangles in many materials are many meshes with one geometry."""
    primitives = [{"attributes": {"POSITION": 0}, "material": k} for k in range(5)]
    files = gltf({"materials": [{}] * 5, "meshes": [{"primitives": primitives}]})
    first, *others = (p.mesh for p in open_files(tmp_path, files)[0].meshes)
    assert len(others) == 4
    for mesh in others:
        assert np.shares_memory(mesh.vertices, first.vertices)
        assert np.shares_memory(mesh.faces, first.faces)


@quick
@given(
    attribute=st.sampled_from(["POSITION", "NORMAL", "COLOR_0", "TEXCOORD_0", "indices"]),
    count=st.integers(2**23, 2**31),
    component=st.sampled_from([5120, 5121, 5122, 5123, 5125, 5126]),
    kind=st.sampled_from(["SCALAR", "VEC2", "VEC3", "VEC4", "MAT4"]),
    normalized=st.booleans(),
    sparse=st.booleans(),
    mode=st.sampled_from([4, 5, 6]),
)
def test_accessors_without_data_are_refused(
    tmp_path, attribute, count, component, kind, normalized, sparse, mode
):
    """A few hundred bytes that declare millions of zeros are refused before memory is taken."""
    accessor = {"componentType": component, "count": count, "type": kind, "normalized": normalized}
    if sparse:
        at = {"bufferView": 0, "componentType": 5121}
        accessor["sparse"] = {"count": 1, "indices": at, "values": {"bufferView": 0}}
    primitive: dict[str, Any] = {"attributes": {"POSITION": 0}, "mode": mode}
    if attribute == "indices":
        primitive["indices"] = 1
    else:
        primitive["attributes"][attribute] = 1
    accessors = [*document()["accessors"], accessor]
    files = gltf({"accessors": accessors, "meshes": [{"primitives": [primitive]}]})
    assert "limit" in refusal(tmp_path, files)


# Counts for which the files hold some ten kilobytes and ask for gigabytes.
TOO_MUCH = [
    "images: overlapping views",
    "image: scans of a JPEG",
    "arrays: zero vertices",
    "arrays: zero colours",
    "arrays: a sparse one",
    "arrays: overlapping",
    "triangles: Draco's",
    "nodes: of many primitives",
]


@pytest.mark.parametrize("kind", TOO_MUCH)
def test_a_small_file_that_asks_for_much_is_refused(tmp_path, kind):
    """Overlapping arrays and pictures, JPEG scans, placed meshes: one sentence each."""
    assert re.search("limit|more than|too many", refusal(tmp_path, bomb(kind)[1]))


# Counts for which a quadratic reader would take minutes or hours.
MANY = {
    "buffers: the file itself": 10_000,
    "buffers: spellings of a file": 500,
    "images: one view": 300,
    "nodes: a chain": 20_000,
    "nodes: empty": 20_000,
    "OBJ: empty lines in the MTL": 300_000,
    "OBJ: spaces in a map": 1_000_000,
    "OBJ: options of a map": 100_000,
    "OBJ: newmtl": 10_000,
    "OBJ: usemtl of two": 30_000,
    "OBJ: o, g and s": 20_000,
    "OBJ: continued lines": 50_000,
    "OBJ: one long face": 20_000,
    "OBJ: faces of other lengths": 100,
    "OBJ: corners of other forms": 2_000,
    "OBJ: faces that count back": 10_000,
    "OBJ: words": 50_000,
}


@pytest.mark.parametrize("kind", MANY)
def test_many_parts_are_read_in_linear_time(tmp_path, kind, no_hang):
    """Files of many lines or parts open, or are refused, in linear time.

    `no_hang` ends the test after a minute, a hundred times what it takes and a hundredth of
    what a time that grows with the square would be.
    """
    no_hang()
    files = bomb(kind, MANY[kind])[1]
    with contextlib.suppress(UserError):
        assert open_files(tmp_path, files)[0].triangles > 0


@pytest.mark.parametrize("part", ["scene", "children", "nodes"])
def test_nodes_are_counted_before_they_are_placed(tmp_path, part):
    """The limit of places counts nodes that are roots, children, or both."""
    many = [1] * 200_001
    parts: dict[str, dict[str, Any]] = {
        "scene": {"scenes": [{"nodes": [0, *many]}], "nodes": [{"mesh": 0}, {}]},
        "children": {"nodes": [{"mesh": 0, "children": many}, {}]},
        "nodes": {"nodes": [{"mesh": 0}, *[{}] * 200_000]},
    }
    assert "more than 200000 nodes" in refusal(tmp_path, gltf(parts[part]))


def test_repeated_references_take_no_memory(tmp_path):
    """Three bombs load in a process that may take only 300 MiB of memory.

    Read as often as they are named, the first would take 6 GB, the second 20 GB, the last 6 GB.
    """
    kinds = ("buffers: the file itself", "images: one view", "arrays: zero colours")
    numbers = (10_000, 2_000, 49_000_000)
    for kind, number in zip(kinds, numbers, strict=True):
        folder = tmp_path / kind.replace(" ", "_").replace(":", "")
        folder.mkdir()
        for name, content in bomb(kind, number)[1].items():
            (folder / name).write_bytes(content)
    script = """
import resource, sys
from pathlib import Path
from vrut_lite.errors import UserError
from vrut_lite.scene.loading import load_scene
pages = int(Path("/proc/self/statm").read_text().split()[0])
most = pages * resource.getpagesize() + 300 * 2**20
resource.setrlimit(resource.RLIMIT_AS, (most, most))
for path in sys.argv[1:]:
    try:
        print(load_scene(path).triangles)
    except UserError as error:
        print(error)
"""
    paths = [str(path) for path in sorted(tmp_path.glob("*/a.gltf"))]
    told = subprocess.run(
        [sys.executable, "-c", script, *paths], capture_output=True, text=True, check=True
    )
    assert len(told.stdout.splitlines()) == 3, told.stdout


def test_a_refusal_tells_what_how_large_and_what_to_do(tmp_path):
    """The sentence gives name, size and limit, and how to raise it; then the scene loads."""
    picture = png(4000, 4000)
    files = gltf(
        {
            "images": [{"uri": "a.png"}],
            "textures": [{"source": 0}],
            "materials": [{"normalTexture": {"index": 0}}],
        },
        a_png=picture,
    )
    sentence = refusal(tmp_path, files, limit_gib=0.55)
    for part in ("a.gltf", "the image number 0", "61 MiB", "0.55 GiB", VARIABLE):
        assert part in sentence
    assert open_files(tmp_path, files, limit_gib=0.75)[0].triangles == 1


def test_the_environment_raises_the_limit(tmp_path, monkeypatch):
    """VRUT_LITE_MEMORY_GIB is the limit of `load_scene`, 4 GiB without it."""
    files = gltf({"nodes": [{"mesh": 0}, *[{}] * 30_000]})
    files["a.bin"] += bytes(REST_BYTES)
    path = tmp_path / "a.gltf"
    for name, content in files.items():
        (tmp_path / name).write_bytes(content)
    huge = tmp_path / "a.bin"
    os.truncate(huge, 800 * 2**20)
    monkeypatch.setenv(VARIABLE, "2")
    with pytest.raises(UserError, match="above the limit of 2 GiB"):
        load_scene(path)
    os.truncate(huge, REST_BYTES)
    assert load_scene(path).triangles == 1
    monkeypatch.delenv(VARIABLE)
    budget_of_environment().check(GIB, "a thing")
    with pytest.raises(SceneFileError, match="limit of 4 GiB"):
        budget_of_environment().check(2 * GIB, "a thing")


def test_the_table_of_broken_files(tmp_path):
    """Each file is opened in a process of its own, and none takes more than the rule allows."""
    few = ("arrays: zero vertices", "buffers: a data URI")
    rows = list(measured(scene_files(tmp_path, 3, few), open_scene))
    assert len(rows) == 5
    for row in rows:
        assert row.opened is not None, row
        assert 0 < row.peak_bytes < row.opened.allowed_bytes
    assert len(list(table(rows))) == 2 + len(few) + 1


def test_every_kind_of_bomb_is_a_scene_when_it_is_small(tmp_path):
    """Small versions of the bombs load: the large ones are refused for their size alone."""
    never = {
        "image: scans of a JPEG",
        "images: five of 49 megapixels",
        "triangles: Draco's",
        "OBJ: options of a map",
        "OBJ: spaces in a map",
        "arrays: zero colours",
        "buffers: a data URI",
        "buffers: the file itself",
    }
    for number, kind in enumerate(BOMBS):
        if kind not in never:
            assert open_files(tmp_path / str(number), bomb(kind, 6)[1])[0].triangles > 0, kind
