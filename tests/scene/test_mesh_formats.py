"""STL, PLY, OFF, 3MF and COLLADA: shapes, colours, axes and units, and broken files."""

import struct
import zipfile
from collections.abc import Sequence
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from scene_files import png_bytes

from vrut_lite.errors import UserError
from vrut_lite.geometry.colour import srgb_decode
from vrut_lite.scene import polygon_process, trimesh_process
from vrut_lite.scene.budget import SceneBudget
from vrut_lite.scene.loading import LoadedScene, load_scene
from vrut_lite.scene.process_limits import answered

_RED, _OLIVE = (255, 0, 0), (128, 128, 0)


def _box() -> trimesh.Trimesh:
    return trimesh.creation.box(bounds=[[0, 0, 0], [2, 3, 4]])


def _bytes(kind: str) -> bytes:
    """The box as a file of this kind."""
    if kind in ("3mf", "dae"):
        pytest.importorskip("lxml", reason="the package lxml is not installed")
    if kind == "dae":
        pytest.importorskip("collada", reason="the package pycollada is not installed")
    data = _box().export(file_type=kind)
    return data if isinstance(data, bytes) else data.encode()


def _write(folder: Path, name: str, data: bytes) -> Path:
    (folder / name).write_bytes(data)
    return folder / name


def _corner_colours(scene: LoadedScene) -> np.ndarray:
    """The linear colours (V, 3) of all vertices."""
    colours = [place.mesh.colours for place in scene.meshes]
    return np.concatenate([one[:, :3] for one in colours if one is not None])


@pytest.mark.parametrize("kind", ["stl", "stl_ascii", "ply", "off", "dae"])
def test_each_format_has_the_boxes_shape(tmp_path: Path, kind: str) -> None:
    """A box of 2 x 3 x 4 m opens with its twelve triangles, facing outwards."""
    name = "box." + kind.removesuffix("_ascii").upper()
    scene = load_scene(_write(tmp_path, name, _bytes(kind)))
    assert scene.triangles == 12
    np.testing.assert_allclose([scene.lower_m, scene.upper_m], [[0, 0, 0], [2, 3, 4]])
    for place in scene.meshes:
        a, b, c = np.moveaxis(place.world_triangles(), 1, 0)
        outward = np.sum(np.cross(b - a, c - a) * (a + b + c - [3, 4.5, 6]), axis=1)
        assert (outward > 0).all()


def test_3mf_is_in_millimetres_along_z(tmp_path: Path) -> None:
    """3MF states its unit, by default millimetres, and stands on the plane of x and y."""
    scene = load_scene(_write(tmp_path, "box.3mf", _bytes("3mf")))
    assert (scene.placement.up, scene.placement.metres_per_unit) == ("z", 0.001)
    np.testing.assert_allclose(scene.upper_m - scene.lower_m, [0.002, 0.004, 0.003])


@pytest.mark.parametrize("sides", [("<", "little"), (">", "big")])
def test_ply_with_polygons_and_colours(tmp_path: Path, sides: tuple[str, str]) -> None:
    """Binary faces of 3 to 5 corners, as Blender writes them, are fans; byte colours are sRGB."""
    order, name = sides
    points = [(0, 0, 0), (1, 0, 0), (1, 0, 1), (0, 0, 1), (2, 0, 0), (2, 0, 1), (3, 0, 0.5)]
    faces = [(0, 3, 2, 1), (1, 2, 5, 6, 4), (0, 1, 2)]
    head = f"""ply
format binary_{name}_endian 1.0
comment made by hand
element vertex {len(points)}
property float x
property float y
property float z
property uchar red
property uchar green
property uchar blue
element face {len(faces)}
property list uchar uint vertex_indices
end_header
"""
    data = head.encode()
    data += b"".join(struct.pack(order + "3f3B", *point, *_OLIVE) for point in points)
    data += b"".join(struct.pack(f"{order}B{len(f)}I", len(f), *f) for f in faces)
    scene = load_scene(_write(tmp_path, "a.ply", data))
    assert scene.triangles == 2 + 3 + 1
    np.testing.assert_allclose(scene.upper_m, [3, 0, 1])
    colours = _corner_colours(scene)
    expected = np.tile(srgb_decode(np.array(_OLIVE) / 255.0), (len(colours), 1))
    np.testing.assert_allclose(colours, expected, atol=1e-6)
    material = scene.meshes[0].mesh.material
    np.testing.assert_array_equal(material.baseColorFactor, 1.0)
    assert material.doubleSided
    with pytest.raises(UserError, match="its PLY is damaged"):
        load_scene(_write(tmp_path, "a.ply", data[:-3]))


def test_3mf_colours_are_the_reflectance(tmp_path: Path) -> None:
    """Base materials colour objects and triangles; colour groups colour corners (3MF materials
    extension, section 3); a component stands where its matrix says."""
    pytest.importorskip("lxml", reason="the package lxml is not installed")
    triangle = '<triangle v1="0" v2="1" v3="2" {}/>'
    model = f"""<?xml version="1.0"?>
<model unit="meter" xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02"
 xmlns:m="http://schemas.microsoft.com/3dmanufacturing/material/2015/02">
<resources>
<basematerials id="1"><base name="r" displaycolor="#FF0000"/><base name="o"
 displaycolor="#808000FF"/></basematerials>
<m:colorgroup id="2"><m:color color="#FF0000"/><m:color color="#808000"/></m:colorgroup>
<object id="3" pid="1" pindex="1"><mesh><vertices><vertex x="0" y="0" z="0"/>
<vertex x="1" y="0" z="0"/><vertex x="1" y="1" z="0"/></vertices><triangles>
{triangle.format("")}{triangle.format('pid="1" p1="0"')}
{triangle.format('pid="2" p1="0" p2="1" p3="1"')}</triangles></mesh></object>
<object id="4"><components><component objectid="3" transform="1 0 0 0 1 0 0 0 1 5 0 0"/>
</components></object></resources><build><item objectid="3"/><item objectid="4"/></build></model>"""
    data = BytesIO()
    with zipfile.ZipFile(data, "w") as archive:
        archive.writestr("3D/3dmodel.model", model)
    scene = load_scene(_write(tmp_path, "a.3mf", data.getvalue()))
    assert scene.triangles == 6
    assert scene.meshes[0].mesh is scene.meshes[1].mesh
    np.testing.assert_allclose(scene.upper_m, [6, 0, 0])
    mesh = scene.meshes[0].mesh
    corners = [_OLIVE] * 3 + [_RED] * 3 + [_RED, _OLIVE, _OLIVE]
    shown = mesh.colours[mesh.faces.reshape(-1), :3]
    np.testing.assert_allclose(shown, srgb_decode(np.array(corners) / 255.0), atol=1e-6)


def _collada(picture: str = "", tail: str = "") -> bytes:
    """A red or papered triangle of COLLADA, Z up, in inches."""
    colour = "<color>0.5 0 0 1</color>"
    if picture:
        colour = '<texture texture="s" texcoord="uv"/>'
    floats = "<float_array id='{0}a' count='{1}'>{2}</float_array><technique_common><accessor "
    floats += "source='#{0}a' count='3' stride='{3}'>{4}</accessor></technique_common>"
    xyz, uv = (
        "".join(f"<param name='{p}' type='float'/>" for p in names) for names in ("XYZ", "ST")
    )
    positions = floats.format("p", 9, "0 0 0 100 0 0 0 0 100", 3, xyz)
    coordinates = floats.format("t", 6, "0 0 1 0 0 1", 2, uv)
    return f"""<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1"><asset>
<unit name="inch" meter="0.0254"/><up_axis>Z_UP</up_axis></asset>
<library_images><image id="i"><init_from>{picture}</init_from></image></library_images>
<library_effects><effect id="e"><profile_COMMON><newparam sid="f"><surface type="2D">
<init_from>i</init_from></surface></newparam><newparam sid="s"><sampler2D><source>f</source>
</sampler2D></newparam><technique sid="c"><lambert><diffuse>{colour}</diffuse></lambert>
</technique></profile_COMMON></effect></library_effects>
<library_materials><material id="m"><instance_effect url="#e"/></material></library_materials>
<library_geometries><geometry id="g"><mesh><source id="p">{positions}</source>
<source id="t">{coordinates}</source><vertices id="v"><input semantic="POSITION" source="#p"/>
</vertices><triangles count="1" material="k"><input semantic="VERTEX" source="#v" offset="0"/>
<input semantic="TEXCOORD" source="#t" offset="1" set="0"/><p>0 0 1 1 2 2</p></triangles></mesh>
</geometry></library_geometries><library_visual_scenes><visual_scene id="w"><node id="n">
<translate>0 0 100</translate><instance_geometry url="#g"><bind_material><technique_common>
<instance_material symbol="k" target="#m"/></technique_common></bind_material>
</instance_geometry>{tail}</node></visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#w"/></scene></COLLADA>""".encode()


def test_collada_states_its_axes_unit_and_colour(tmp_path: Path) -> None:
    """Up axis and unit are the file's own; a material's colour is the reflectance as stated."""
    pytest.importorskip("collada", reason="the package pycollada is not installed")
    lamp = '<instance_light url="#l"/>'
    scene = load_scene(_write(tmp_path, "a.dae", _collada(tail=lamp)))
    assert (scene.placement.up, scene.placement.metres_per_unit) == ("z", 0.0254)
    np.testing.assert_allclose([scene.lower_m, scene.upper_m], [[0, 2.54, 0], [2.54, 5.08, 0]])
    colour = scene.meshes[0].mesh.material.baseColorFactor
    np.testing.assert_allclose(colour, [0.5, 0, 0, 1], atol=0.5 / 255)
    assert scene.notices == ("lamp of the COLLADA: left out",)


def test_a_file_of_skinned_meshes_alone_says_so(tmp_path: Path) -> None:
    """Skinned meshes are left out; who has no other learns why nothing is there."""
    pytest.importorskip("collada", reason="the package pycollada is not installed")
    skinned = _collada().replace(b"instance_geometry", b"instance_controller")
    with pytest.raises(UserError, match=r"no triangles \(skinned mesh of the COLLADA: left out\)"):
        load_scene(_write(tmp_path, "a.dae", skinned))


def test_pictures_of_collada_lie_in_the_scenes_folder(tmp_path: Path) -> None:
    """A picture beside the scene is its colour; one elsewhere has a notice and is never opened."""
    pytest.importorskip("collada", reason="the package pycollada is not installed")
    folder = tmp_path / "scene"
    folder.mkdir()
    for place in (folder, tmp_path):
        _write(place, "my brick.png", png_bytes((4, 2)))
    scene = load_scene(_write(folder, "a.dae", _collada("file://my%20brick.png")))
    picture = scene.meshes[0].mesh.material.baseColorTexture
    assert picture is not None
    assert picture.size == (4, 2)
    (folder / "my brick.png").unlink()
    scene = load_scene(_write(folder, "a.dae", _collada("../my%20brick.png")))
    assert scene.meshes[0].mesh.material.baseColorTexture is None
    assert "outside the scene's folder" in scene.notices[0]


@pytest.mark.parametrize(
    ("name", "data", "fault"),
    [
        ("a.stl", bytes(80) + b"\xff\xff\xff\xff" + bytes(50), "4,294,967,295 triangles"),
        ("a.stl", b"solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\n", "'endsolid'"),
        ("a.stl", b"", "fewer than the head"),
        ("a.ply", b"ply\nformat ascii 1.0\nelement vertex 99999999\nend_header\n", "99,999,999"),
        ("a.ply", b"plot", "does not begin with 'ply'"),
        (
            "a.off",
            b"OFF\n353535235358 4 4\n0 0 0\n",
            "353,535,235,358 vertices, 4 faces; lines after it: 1",
        ),
        ("a.off", b"{}", "does not begin with OFF"),
        ("a.3mf", b"PK\3\4" + bytes(60), "no ZIP archive"),
        ("a.dae", b"<COLLADA>", "damaged"),
    ],
)
def test_broken_files_end_in_one_sentence(
    tmp_path: Path, name: str, data: bytes, fault: str
) -> None:
    """The sentence says what is wrong and what to do."""
    with pytest.raises(UserError) as error:
        load_scene(_write(tmp_path, name, data))
    assert fault in str(error.value)
    assert "export it again" in str(error.value)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize("kind", ["stl", "stl_ascii", "ply", "off", "3mf", "dae"])
def test_mangled_files_have_a_fault_or_content(kind: str) -> None:
    """Files with bytes cut, changed or put in are read, or refused in one sentence."""
    whole, suffix = _bytes(kind), "." + kind.removesuffix("_ascii")
    process = polygon_process if kind in ("ply", "off") else trimesh_process

    @settings(max_examples=25, deadline=None, suppress_health_check=list(HealthCheck))
    @given(st.integers(0, len(whole)), st.integers(0, 40), st.binary(max_size=12))
    def mangled(at: int, gone: int, put: bytes) -> None:
        told = answered(process.read, suffix, whole[:at] + put + whole[at + gone :])
        assert told.fault or isinstance(told.parts, list)

    mangled()


def test_what_takes_too_much_memory_is_refused(tmp_path: Path) -> None:
    """A 3MF of 3 MB that unpacks to 700 MB ends at the limit, in a sentence that names it."""
    pytest.importorskip("lxml", reason="the package lxml is not installed")
    data = BytesIO()
    with (
        zipfile.ZipFile(data, "w", zipfile.ZIP_DEFLATED, compresslevel=1) as archive,
        archive.open("3D/3dmodel.model", "w", force_zip64=True) as file,
    ):
        for _ in range(700):
            file.write(b" " * 2**20)
    path = _write(tmp_path, "a.3mf", data.getvalue())
    with pytest.raises(UserError, match=r"takes more than .* GiB to read.*VRUT_LITE_MEMORY_GIB"):
        load_scene(path, SceneBudget(600 * 2**20))


def test_a_missing_package_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Without pycollada the sentence names the extra, and the way by Blender."""
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    _write(tmp_path, "collada.py", b"raise ImportError('no collada')")
    with pytest.raises(UserError, match=r"vrut-lite\[formats\].*Blender"):
        load_scene(_write(tmp_path, "a.dae", _collada()))


# An L of six corners: a fan about its first corner covers 5 units of area, the L has 3.
_L = [(2, 2, 0), (1, 2, 0), (1, 1, 0), (0, 1, 0), (0, 0, 0), (2, 0, 0)]


def _l_file(kind: str) -> bytes:
    points = "".join(f"{x} {y} {z}\n" for x, y, z in _L)
    if kind == "off":
        return f"OFF # an L\n6 1 0\n{points}6 0 1 2 3 4 5\n".encode()
    head = f"ply\nformat {kind} 1.0\nelement vertex 6\n"
    head += "".join(f"property float {axis}\n" for axis in "xyz")
    head += "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
    if kind == "ascii":
        return f"{head}{points}6 0 1 2 3 4 5\n".encode()
    order = "<" if "little" in kind else ">"
    body = b"".join(struct.pack(order + "3f", *point) for point in _L)
    return head.encode() + body + struct.pack(order + "B6i", 6, *range(6))


@pytest.mark.parametrize("kind", ["off", "ascii", "binary_little_endian", "binary_big_endian"])
def test_a_concave_polygon_keeps_its_shape(tmp_path: Path, kind: str) -> None:
    """A fan about a corner that does not see all others draws too much; an L has its own area."""
    name = "a.off" if kind == "off" else "a.ply"
    scene = load_scene(_write(tmp_path, name, _l_file(kind)))
    assert scene.triangles == 4
    a, b, c = np.moveaxis(scene.meshes[0].world_triangles(), 1, 0)
    area = 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1).sum()
    assert area == pytest.approx(3.0)


def _nested_3mf(levels: int, loops: bool = False) -> bytes:
    """A triangle, and objects of two components each above it."""
    whole = ['<object id="0"><mesh><vertices><vertex x="0" y="0" z="0"/><vertex x="1" y="0" z="0"/>'
             '<vertex x="0" y="1" z="0"/></vertices><triangles><triangle v1="0" v2="1" v3="2"/>'
             "</triangles></mesh></object>"]  # fmt: skip
    for level in range(1, levels + 1):
        at = f'transform="1 0 0 0 1 0 0 0 1 {2**level} 0 0"'
        below = level if loops and level == 1 else level - 1
        whole.append(
            f'<object id="{level}"><components><component objectid="{level - 1}"/>'
            f'<component objectid="{below}" {at}/></components></object>'
        )
    text = (
        '<model unit="meter" xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02">'
        f"<resources>{''.join(whole)}</resources><build><item objectid='{levels}'/></build></model>"
    )
    data = BytesIO()
    with zipfile.ZipFile(data, "w") as archive:
        archive.writestr("3D/3dmodel.model", text)
    return data.getvalue()


def test_components_of_components_are_all_placed_or_refused(tmp_path: Path) -> None:
    """Each level doubles the places; more than the limit, and a loop, end in a sentence at once."""
    pytest.importorskip("lxml", reason="the package lxml is not installed")
    scene = load_scene(_write(tmp_path, "a.3mf", _nested_3mf(5)))
    assert scene.triangles == 32
    assert not any("left out" in line for line in scene.notices)
    for data, said in (
        (_nested_3mf(40), "places 1,099,511,627,776"),
        (_nested_3mf(3, True), "contain"),
    ):
        with pytest.raises(UserError, match=said):
            load_scene(_write(tmp_path, "b.3mf", data))


def test_numbers_of_an_offs_comments_are_no_vertices(tmp_path: Path) -> None:
    """A comment after each vertex, as of a cube of Geomview, does not count; points of four
    dimensions are named."""
    lines = "".join(f"{x} {y} {z}\t# {n}  \n" for n, (x, y, z) in enumerate(_L))
    scene = load_scene(_write(tmp_path, "a.off", f"OFF\n6 1 0\n\n{lines}\n3 0 1 2\n".encode()))
    np.testing.assert_allclose([scene.lower_m, scene.upper_m], [[1, 1, 0], [2, 2, 0]])
    with pytest.raises(UserError, match="more than three dimensions"):
        load_scene(_write(tmp_path, "b.off", b"4OFF\n3 1 0\n0 0 0 1\n1 0 0 1\n0 1 0 1\n3 0 1 2\n"))


def test_3mf_that_lies_across_y_has_a_hint(tmp_path: Path) -> None:
    """Ten of fourteen plates of printers in Cura are written with +Y up, against the standard."""
    pytest.importorskip("lxml", reason="the package lxml is not installed")
    for extents, hinted in (((200, 5, 200), True), ((200, 200, 5), False)):
        data = trimesh.creation.box(extents).export(file_type="3mf")
        scene = load_scene(_write(tmp_path, "a.3mf", data))
        assert any("across Y (else --up y" in line for line in scene.notices) == hinted


_FORMATS = {"ascii": "", "binary_little_endian": "<", "binary_big_endian": ">"}
_CODES = {"uchar": "B", "short": "h", "int": "i", "uint": "I", "float": "f", "double": "d"}


def _ply(
    form: str, elements: Sequence[tuple[str, list[str], Sequence[Sequence[object]]]], more: str = ""
) -> bytes:
    """A PLY of elements: name, properties as in its head without the first word, rows."""
    head = f"ply\nformat {form} 1.0\n{more}"
    words, binary = [], b""
    for name, properties, rows in elements:
        head += f"element {name} {len(rows)}\n"
        head += "".join(f"property {one}\n" for one in properties)
        for row in rows:
            line: list[str] = []
            for one, value in zip(properties, row, strict=True):
                kinds = one.split()[:-1]
                if kinds[0] == "list":
                    assert isinstance(value, list | tuple)
                    line += [str(len(value)), *map(str, value)]
                    binary += struct.pack(
                        f"{_FORMATS[form]}{_CODES[kinds[1]]}{len(value)}{_CODES[kinds[2]]}"
                        if form != "ascii"
                        else f"={_CODES[kinds[1]]}{len(value)}{_CODES[kinds[2]]}",
                        len(value),
                        *value,
                    )
                else:
                    line.append(str(value))
                    binary += struct.pack((_FORMATS[form] or "=") + _CODES[kinds[0]], value)
            words.append(" ".join(line))
    head += "end_header\n"
    return head.encode() + ("\n".join([*words, ""]).encode() if form == "ascii" else binary)


_XYZ = ["float x", "float y", "float z"]
_SQUARE = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 0.0, 1.0], [0.0, 0.0, 1.0]]
_CORNERS = "list uchar int vertex_indices"
_VERTICES = ("vertex", _XYZ, _SQUARE)


@settings(max_examples=40, deadline=None, suppress_health_check=list(HealthCheck))
@given(st.data())
def test_ply_of_any_elements_and_properties(data: st.DataObject) -> None:
    """Unknown elements and properties, lists among them, are passed over in text and binary: the
    mesh is that of the positions and corners alone."""
    form = data.draw(st.sampled_from(sorted(_FORMATS)))
    lists = st.lists(st.integers(0, 9), max_size=3)

    def with_more(properties: list[str], rows: list[list[Any]], name: str) -> tuple[Any, ...]:
        for number in range(data.draw(st.integers(0, 2))):
            at = data.draw(st.integers(0, len(properties)))
            is_list = data.draw(st.booleans())
            kind = data.draw(st.sampled_from(sorted(_CODES)))
            size = data.draw(st.sampled_from(["uchar", "int", "short"]))
            properties = [*properties]
            properties.insert(
                at, f"list {size} {kind} m{number}" if is_list else f"{kind} m{number}"
            )
            rows = [[*row] for row in rows]
            for row in rows:
                row.insert(at, data.draw(lists if is_list else st.integers(0, 9)))
        return name, properties, rows

    faces = data.draw(
        st.lists(st.lists(st.integers(0, 3), min_size=3, max_size=3, unique=True), min_size=1)
    )
    other = ("edge", ["int vertex1", "list uchar short more"], [[1, [2, 3]], [2, []]])
    elements = [
        with_more([*_XYZ], [*_SQUARE], "vertex"),
        with_more([_CORNERS], [[face] for face in faces], "face"),
    ]
    elements.insert(data.draw(st.integers(0, 2)), other)
    (part,) = polygon_process.read(".ply", _ply(form, elements)).parts
    vertices = np.frombuffer(part.vertices).reshape(-1, 3)
    np.testing.assert_array_equal(vertices, _SQUARE)
    triangles = np.frombuffer(part.triangles, np.int64).reshape(-1, 3)
    np.testing.assert_array_equal(triangles, faces)


@pytest.mark.parametrize("form", sorted(_FORMATS))
def test_ply_has_pictures_by_its_corners(tmp_path: Path, form: str) -> None:
    """MeshLab states coordinates at each corner of a face, and each face's picture by number; the
    picture is the colour, and colours beside it are left out."""
    for name, rgb in (("a b.png", 1), ("c.png", 2)):
        _write(tmp_path, name, png_bytes((rgb, 1)))
    faces = [
        [[0, 1, 2], [0.0, 0.0, 0.5, 0.0, 0.5, 0.25], 0, 9, 9, 9],
        [[0, 2, 3], [0.0, 0.0, 0.5, 0.25, 0.0, 0.25], 1, 9, 9, 9],
    ]
    properties = [_CORNERS, "list uchar float texcoord", "int texnumber"]
    properties += ["uchar red", "uchar green", "uchar blue"]
    pictures = "comment TextureFile a b.png\ncomment TextureFile c.png\n"
    data = _ply(form, [_VERTICES, ("face", properties, faces)], pictures)
    scene = load_scene(_write(tmp_path, "a.ply", data))
    assert scene.triangles == 2
    pictures_shown = [place.mesh.material.baseColorTexture for place in scene.meshes]
    assert [picture.size[0] for picture in pictures_shown if picture is not None] == [1, 2]
    assert scene.notices == ("colours of the PLY beside its picture: left out",)
    file = polygon_process.read(".ply", data)
    uv = np.concatenate([np.frombuffer(part.uv).reshape(-1, 2) for part in file.parts])
    points = np.concatenate([np.frombuffer(part.vertices).reshape(-1, 3) for part in file.parts])
    np.testing.assert_allclose(uv, points[:, [0, 2]] * [0.5, 0.25])


@pytest.mark.parametrize(
    ("kind", "colour"), [("uchar", (255, 0, 128)), ("float", (1.0, 0.0, 128 / 255))]
)
def test_ply_colours_of_faces(tmp_path: Path, kind: str, colour: tuple[float, ...]) -> None:
    """A face's own colour holds for all its corners; fractions of 1 are as good as bytes."""
    properties = [_CORNERS, *(f"{kind} {name}" for name in ("red", "green", "blue"))]
    rows = [[[0, 1, 2, 3], *colour], [[0, 1, 2], 0, 0, 0]]
    data = _ply("ascii", [_VERTICES, ("face", properties, rows)])
    shown = _corner_colours(load_scene(_write(tmp_path, "a.ply", data)))
    expected = srgb_decode(np.array([255, 0, 128]) / 255.0)
    assert len(shown) == 9
    np.testing.assert_allclose(shown[:6], np.tile(expected, (6, 1)), atol=1e-6)
    np.testing.assert_array_equal(shown[6:], 0.0)


def test_ply_of_strips(tmp_path: Path) -> None:
    """Scans of Stanford's are strips of triangles that -1 ends; all faces look one way."""
    strips = ("tristrips", ["list int int vertex_indices"], [[[0, 1, 3, 2, -1, 0, 1, 2]]])
    data = _ply("binary_big_endian", [_VERTICES, strips])
    scene = load_scene(_write(tmp_path, "a.ply", data))
    assert scene.triangles == 3
    a, b, c = np.moveaxis(scene.meshes[0].world_triangles(), 1, 0)
    assert (np.cross(b - a, c - a)[:, 1] < 0).all()


@pytest.mark.parametrize(
    ("head", "tail", "colours"),
    [
        ("COFF", "", [(255, 0, 0, 255), (0, 0, 128, 255), (0, 255, 0, 255)]),
        ("STCNOFF", "", [(0, 1, 0, 1.0, 0, 0, 1, 0, 0), (0, 1, 0, 0, 0, 0.502, 1, 0, 0)]),
        ("OFF", " 255 0 128", []),
        ("OFF", " 1.0 0.0 0.502 1.0", []),
    ],
)
def test_off_colours(tmp_path: Path, head: str, tail: str, colours: list[tuple]) -> None:
    """Colours of vertices (with normals and coordinates beside them) and of faces are read, as
    whole numbers to 255 or as fractions."""
    colours = [*colours, *colours[-1:]][:3] or [()] * 3
    lines = [" ".join(map(str, (*p, *c))) for p, c in zip(_SQUARE[:3], colours, strict=True)]
    text = "\n".join([head, "3 1 0", *lines, f"3 0 1 2{tail}", ""])
    scene = load_scene(_write(tmp_path, "a.off", text.encode()))
    shown = _corner_colours(scene)
    first = (255, 0, 128) if tail else (255, 0, 0)
    np.testing.assert_allclose(shown[0], srgb_decode(np.array(first) / 255.0), atol=1e-6)
    last = {"COFF": (0, 255, 0), "STCNOFF": (0, 0, 128), "OFF": (255, 0, 128)}[head]
    np.testing.assert_allclose(shown[2], srgb_decode(np.array(last) / 255.0), atol=1e-6)
    assert scene.notices == ()


@pytest.mark.parametrize(
    ("name", "data", "fault"),
    [
        (
            "a.ply",
            b"ply\nformat ascii 1.0\nelement vertex 1\nproperty half x\nend_header\n0\n",
            "half",
        ),
        ("a.ply", b"ply\nformat zip 1.0\nend_header\n", "neither ascii nor binary"),
        ("a.ply", _ply("ascii", [("vertex", _XYZ[:2], [[0, 0]])]), "no x, y and z"),
        ("a.ply", _ply("ascii", [_VERTICES, ("face", [_CORNERS], [[[0, 1, 9]]])]), "vertex 9 of 4"),
        (
            "a.ply",
            _ply("ascii", [_VERTICES, ("face", [_CORNERS], [[[0, 1, 2]]])])[:-4],
            "ends before row 1 of 1",
        ),
        ("a.off", b"OFF BINARY\n\0\0\0\4", "binary OFF"),
        ("a.off", b"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1\n3 0 1 2\n", "fewer than three"),
        ("a.off", b"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n4 0 1 2\n", "fewer corners"),
    ],
)
def test_broken_ply_and_off_name_the_place(name: str, data: bytes, fault: str) -> None:
    """The refusal names the head, row or face that is wrong."""
    assert fault in answered(polygon_process.read, Path(name).suffix, data).fault
