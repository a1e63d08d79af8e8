"""OBJ and MTL."""

from pathlib import Path

import numpy as np
import pytest
import trimesh
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from loaded_scenes import WriteScene, material_of
from PIL import Image
from scene_files import png_bytes

from vrut_lite.errors import UserError
from vrut_lite.messages.placement import Placement
from vrut_lite.scene import obj_file, obj_kernels
from vrut_lite.scene.budget import SceneBudget
from vrut_lite.scene.loading import load_scene
from vrut_lite.scene.scene_file_error import SceneFileError


def test_obj_material(write_obj: WriteScene) -> None:
    """Kd is the base colour, d the alpha, Ns the roughness: r^4 = 2 / (Ns + 2), 30 gives 0.5."""
    mtl = "newmtl paint\nKa 1 1 1\nKd 0.1 0.2 0.3\nKs 1 1 1\nNs 30\nd 0.25\nillum 2\n"
    material = material_of(load_scene(write_obj(mtl)))
    np.testing.assert_allclose(material.baseColorFactor, [0.1, 0.2, 0.3, 0.25])
    assert material.roughnessFactor == pytest.approx(0.5)
    assert (material.metallicFactor, material.alphaMode) == (0.0, "BLEND")


def test_obj_transparency_and_pbr_words(write_obj: WriteScene) -> None:
    """Tr is the opposite of d; Pm, Pr and Ke are the physically based extension's."""
    mtl = "newmtl paint\nTr 0.4\nPm 1\nPr 0.3\nNs 500\nKe 2 1 0\n"
    material = material_of(load_scene(write_obj(mtl)))
    assert material.baseColorFactor[3] == pytest.approx(0.6)
    assert (material.metallicFactor, material.roughnessFactor) == (1.0, 0.3)
    np.testing.assert_allclose(material.emissiveFactor, [2, 1, 0])


@pytest.mark.parametrize(
    "name", ["wall.png", "a wall.png", "-s 2 2 1 wall.png", "-clamp on -bm 0.5 wall.png"]
)
def test_obj_texture(write_obj: WriteScene, name: str) -> None:
    """map_Kd is the base colour's picture, whatever options stand before its name."""
    path = write_obj(f"newmtl paint\nKd 1 1 1\nmap_Kd {name}\n")
    file = "a wall.png" if name.startswith("a ") else "wall.png"
    (path.parent / file).write_bytes(png_bytes((16, 8)))
    scene = load_scene(path)
    assert material_of(scene).baseColorTexture.size == (16, 8)
    np.testing.assert_allclose(scene.meshes[0].mesh.uv, [[0, 0], [1, 0], [1, 1], [0, 1]])


def test_obj_cut_out(write_obj: WriteScene) -> None:
    """A picture with an alpha channel cuts out: leaves, fences."""
    path = write_obj("newmtl paint\nmap_Kd leaf.png\n")
    (path.parent / "leaf.png").write_bytes(png_bytes((4, 4), "RGBA"))
    assert material_of(load_scene(path)).alphaMode == "MASK"


def test_obj_without_materials(write_obj: WriteScene) -> None:
    """Bare OBJ geometry is matt mid-grey."""
    material = material_of(load_scene(write_obj()))
    np.testing.assert_array_equal(material.baseColorFactor, [0.5, 0.5, 0.5, 1.0])


def test_obj_meshes_keep_their_own_material(write_obj: WriteScene) -> None:
    """Faces go to the material named last before them."""
    mtl = "newmtl paint\nKd 1 0 0\nnewmtl other\nKd 0 1 0\n"
    faces = "f 1/1 2/2 3/3\nusemtl other\nf 1/1 3/3 4/4"
    scene = load_scene(write_obj(mtl, faces))
    colours = {p.mesh.material.name: p.mesh.material for p in scene.meshes}
    np.testing.assert_array_equal(colours["paint"].baseColorFactor, [1, 0, 0, 1])
    np.testing.assert_array_equal(colours["other"].baseColorFactor, [0, 1, 0, 1])


@pytest.mark.parametrize(
    ("faces", "triangles"),
    [
        ("f 1 2 3 4", 2),
        ("f 1/1 2/2 3/3 4/4", 2),
        ("f 1/1/1 2/2/1 3/3/1 4/4/1", 2),
        ("f 1//1 2//1 3//1 4//1", 2),
        ("f 1 2 3\nf 1 3 4", 2),
        ("f -4 -3 -2 -1", 2),
        ("f -4/-4 -3/-3 -2/-2 -1/-1", 2),
        ("f\t1  2\t3 4 ", 2),
        ("f 1 2 3\nf 1 2 3 4", 3),
        ("v 0.5 1.5 0\nf 1 2 3 5 4", 3),
    ],
)
def test_obj_faces(write_obj: WriteScene, faces: str, triangles: int) -> None:
    """Polygons are cut into fans; every way to write a corner is read."""
    scene = load_scene(write_obj(faces=f"vn 0 0 1\n{faces}"))
    assert scene.triangles == triangles
    np.testing.assert_allclose(scene.meshes[0].mesh.normals[:, 2], 1.0)


def test_obj_counts_back_from_the_present_line(write_obj: WriteScene) -> None:
    """-1 is the last vertex so far, not the last of the file."""
    faces = "f -4 -3 -2 -1\nv 50 50 50\nv 60 60 60"
    np.testing.assert_array_equal(load_scene(write_obj(faces=faces)).upper_m, [1, 1, 0])


def test_obj_normals_stay(write_obj: WriteScene) -> None:
    """vn is kept, also where it is not the triangle's normal."""
    faces = "vn 0 0.6 0.8\nf 1//1 2//1 3//1"
    mesh = load_scene(write_obj(faces=faces)).meshes[0].mesh
    np.testing.assert_allclose(mesh.normals, [[0, 0.6, 0.8]] * 3)


def test_obj_of_trimesh(tmp_path: Path) -> None:
    """trimesh's own export of a textured box loads."""
    box = trimesh.creation.box((1, 2, 3))
    image = Image.new("RGB", (5, 5), (255, 0, 0))
    material = trimesh.visual.material.SimpleMaterial(image=image, glossiness=1.0)
    uv = box.vertices[:, :2] - box.vertices[:, :2].min(axis=0)
    box.visual = trimesh.visual.TextureVisuals(uv=uv, material=material)
    box.export(tmp_path / "box.obj")
    scene = load_scene(tmp_path / "box.obj")
    assert scene.triangles == 12
    assert material_of(scene).baseColorTexture.size == (5, 5)
    np.testing.assert_allclose(scene.upper_m, [0.5, 1.0, 1.5])


TWO_QUADS = """# two quads
mtllib {libraries}
v 0 0 0 # a remark
v 1 0 0
v 1 1 0
v 0 1 0
usemtl red#1
f 1 2 3 4 # in front
usemtl grün
f 4 3 2 1
"""
RED, GREEN = "newmtl red#1\nKd 1 0 0 # red\n", "newmtl grün\nKd 0 1 0\n"


@pytest.mark.parametrize("libraries", ["a.mtl b.mtl", "a.mtl\nmtllib b.mtl", "b.mtl a.mtl"])
@pytest.mark.parametrize("line_end", ["\n", "\r\n", "\r"])
@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "utf-16-be", "cp1252"])
def test_obj_of_any_program_has_both_its_materials(
    tmp_path: Path, libraries: str, line_end: str, encoding: str
) -> None:
    """Several libraries, remarks behind numbers, every encoding and line end."""
    texts = {"a.mtl": RED, "b.mtl": GREEN, "s.obj": TWO_QUADS.format(libraries=libraries)}
    for name, text in texts.items():
        (tmp_path / name).write_bytes(text.replace("\n", line_end).encode(encoding))
    scene = load_scene(tmp_path / "s.obj")
    assert scene.notices == ()
    colours = {
        place.name: place.mesh.material.baseColorFactor[:3].tolist() for place in scene.meshes
    }
    assert colours["red#1"][1:] == [0.0, 0.0]
    assert colours["grün"][::2] == [0.0, 0.0]


def test_a_library_in_quotes_is_found(tmp_path: Path) -> None:
    """Programs quote a name that has a space."""
    (tmp_path / "a b.mtl").write_text("newmtl red\nKd 1 0 0\n")
    text = 'mtllib "a b.mtl"\nv 0 0 0\nv 1 0 0\nv 0 0 1\nusemtl red\nf 1 2 3\n'
    (tmp_path / "a.obj").write_text(text)
    scene = load_scene(tmp_path / "a.obj")
    assert scene.meshes[0].mesh.material.name == "red"
    assert scene.notices == ()


def test_obj_counts_vertices_from_1_in_its_refusal(write_obj: WriteScene) -> None:
    """As the file that the user looks at does."""
    with pytest.raises(UserError, match="a face refers to vertex 9, and it has 4"):
        load_scene(write_obj(faces="f 1 2 9"))


@pytest.mark.parametrize(
    "name", ["textures/../textures/b.png", "./textures//b.png", "textures/b.png"]
)
def test_a_path_that_stays_in_the_folder_is_inside(tmp_path: Path, name: str) -> None:
    """Wherever it goes in between."""
    (tmp_path / "textures").mkdir()
    Image.new("RGB", (2, 2), (255, 0, 0)).save(tmp_path / "textures" / "b.png")
    (tmp_path / "a.mtl").write_text(f"newmtl a\nmap_Kd {name}\n")
    rows = "v 0 0 0\nv 1 0 0\nv 1 1 0\nvt 0 0\nvt 1 0\nvt 1 1\n"
    (tmp_path / "s.obj").write_text(f"mtllib a.mtl\n{rows}usemtl a\nf 1/1 2/2 3/3\n")
    scene = load_scene(tmp_path / "s.obj")
    assert scene.notices == ()
    assert material_of(scene).baseColorTexture.size == (2, 2)


@st.composite
def _obj_texts(draw: st.DrawFn) -> str:
    """Three vertices or more of a parabola, and convex faces of any lengths and forms over them."""
    count = draw(st.integers(3, 9))
    number = st.integers(-50, 50).map(lambda value: value / 8)
    start, lean = draw(number), draw(number)
    lines = [f"v {start + x:g} {x * x / 8:g} {lean * x:g}" for x in range(count)]
    lines += ["vt 0.25 0.5"] * count + ["vn 0 1 0"] * count
    form = st.sampled_from(["{}", "{}/{}", "{}//{}", "{}/{}/{}"])
    alike = draw(st.none() | form)
    for _ in range(draw(st.integers(1, 12))):
        corners = draw(st.lists(st.integers(1, count), min_size=3, max_size=7, unique=True))
        corners.sort(reverse=draw(st.booleans()))
        if alike is None:
            # trimesh takes "f 1 2 3 4 5 6" after "f 1/1 2/2 3/3" for a triangle: six numbers both.
            corners = corners[: (len(corners) - 1) // 2 * 2 + 1]
        way = alike or draw(form)
        gap = draw(st.sampled_from([" ", "  ", "\t", " \\\n"]))
        lines.append("f " + gap.join(way.format(*[at] * way.count("{}")) for at in corners))
        lines.append(draw(st.sampled_from(["", "# f 9 9 9", "g a", "s off", "usemtl a b", "o c"])))
    return draw(st.sampled_from(["\n", "\r\n"])).join(lines)


@settings(deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(text=_obj_texts())
def test_obj_has_the_triangles_that_trimesh_finds(tmp_path: Path, text: str) -> None:
    """The triangles equal those of trimesh's reader, in whatever form faces are written."""
    (tmp_path / "a.obj").write_bytes(text.encode())
    scene = load_scene(tmp_path / "a.obj", placement=Placement(up="y", metres_per_unit=1.0))
    ours = np.concatenate([place.world_triangles() for place in scene.meshes])
    theirs = trimesh.load_scene(tmp_path / "a.obj", process=False).to_mesh().triangles
    assert _sorted_triangles(ours) == _sorted_triangles(theirs)


def _sorted_triangles(triangles: np.ndarray) -> list[tuple[tuple[float, ...], ...]]:
    """Triangles rotated to begin at their least corner, and sorted."""
    corners = [[tuple(corner) for corner in triangle] for triangle in triangles.tolist()]
    return sorted(tuple(min(c[k:] + c[:k] for k in range(3))) for c in corners)


def test_obj_blocks_meet(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Faces keep their order and material across the blocks in which the text is read."""
    random = np.random.default_rng(5)
    lines = ["mtllib a.mtl"]
    for number in range(40):
        lines += [f"v {number} {k} {number * k % 7}" for k in range(3)]
        lines += [f"usemtl m{number % 3}", "f -1 -2 \\", "-3" if number % 2 else "-3 1"]
    (tmp_path / "a.obj").write_text("\n".join(lines))
    (tmp_path / "a.mtl").write_text("newmtl m0\nnewmtl m1\nnewmtl m2\n")
    whole = load_scene(tmp_path / "a.obj")
    monkeypatch.setattr("vrut_lite.scene.obj_file._SHORT_BYTES", 0)
    for size in random.integers(1, 200, 8):
        monkeypatch.setattr("vrut_lite.scene.obj_file._BLOCK_BYTES", int(size))
        pieces = load_scene(tmp_path / "a.obj")
        assert [place.name for place in pieces.meshes] == [place.name for place in whole.meshes]
        for one, other in zip(pieces.meshes, whole.meshes, strict=True):
            np.testing.assert_array_equal(one.world_triangles(), other.world_triangles())


def test_obj_line_without_end(write_obj: WriteScene) -> None:
    """A line of megabytes is refused."""
    with pytest.raises(UserError, match="longer than 4 MB"):
        load_scene(write_obj(faces="f 1 2 3" + " 4" * 5_000_000))
    with pytest.raises(UserError, match="longer than 4 MB"):
        load_scene(write_obj("newmtl paint\nKd " + "1 " * 2_500_000))


def test_obj_without_a_material_has_no_back_faces(tmp_path: Path) -> None:
    """As with one: OBJ does not know single-sided surfaces, and its faces are often turned."""
    path = tmp_path / "a.obj"
    path.write_text("v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\n")
    assert load_scene(path).meshes[0].mesh.material.doubleSided


_ROWS = st.sampled_from(
    [
        "v 1 2 3", "v -1.5e-3 +2. .25", "v\t7 8 9", "v 1 2 3 0.5 0.5 0.5", "vt 0.25 0.5",
        "vt 1 2 0", "vn 0 0 1", "f 1 2 3", "f 1/1 2/2 3/3 4/4", "f 1//1 2//1 3//1", "f -1 -2 -3",
        "f 1/1/1 2 3//1", "f 1/1/ 2/2/ 3/3/", "f 1 2", "l 1 2", "usemtl a", "usemtl b",
        "mtllib x.mtl", "# v 1 2 3", "", "o thing", "  v 4 5 6  ", "v 1e400 0 0", "v nan 0 0",
        "f 1 2 3 # 4", "v 1 2 3 #", "f 1 3 2 4", "f 1 2 4 3 1", "f 0 1 2", "f 1 2 x",
        "v 1 2", "vx 1 2 3", "f 1 2 99999999999",
        "v 0.1234567890123456789 12345678901234567890 1e-30",
    ]
)  # fmt: skip


@settings(deadline=None, max_examples=300)
@given(rows=st.lists(_ROWS, max_size=12))
def test_the_compiled_reading_is_the_reading_word_by_word(rows: list[str]) -> None:
    """What is read fast is what is read slowly, and both refuse the same files."""
    block = ("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvn 0 0 1\n" + "\n".join(rows)).encode()
    slow = _read(block)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(obj_file, "_SHORT_BYTES", 0)
        fast = _read(block)
    if isinstance(slow, str) or isinstance(fast, str):
        assert fast == slow
        return
    for name in ("positions", "uv", "normals"):
        np.testing.assert_allclose(getattr(fast, name), getattr(slow, name), rtol=1e-15)
    np.testing.assert_array_equal(fast.corners, slow.corners)
    np.testing.assert_array_equal(fast.group, slow.group)
    assert (fast.materials, fast.libraries, fast.unread) == (
        slow.materials,
        slow.libraries,
        slow.unread,
    )
    for one, other in zip(fast.strokes, slow.strokes, strict=True):
        np.testing.assert_array_equal(one.vertices, other.vertices)


def _read(block: bytes) -> obj_file.ObjFile | str:
    try:
        return obj_file.parse_obj(block, SceneBudget(2**32))
    except SceneFileError as fault:
        return str(fault)


@settings(deadline=None, max_examples=200)
@given(value=st.decimals(-1000, 1000, places=9))
def test_numbers_are_read_exactly(value: object) -> None:
    """Up to 15 digits a number is the nearest double to its text, as Python's own float."""
    plain = obj_kernels.read_plain_block(f"v {value} 0 0\n".encode(), (0, 0, 0))
    assert plain is not None
    assert plain.rows[0][0, 0] == float(str(value))
