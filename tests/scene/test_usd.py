"""USD: geometry, UsdPreviewSurface, instances, axes and units, and the limits of any scene file."""

import sys
from pathlib import Path

import numpy as np
import pytest
from scene_files import png_bytes

from vrut_lite.errors import UserError
from vrut_lite.scene.budget import SceneBudget
from vrut_lite.scene.loading import LoadedScene, load_scene

pytest.importorskip("pxr", reason="the package usd-core is not installed")

HEAD = '#usda 1.0\n(\n    upAxis = "Z"\n    metersPerUnit = 0.01\n)\n'
QUAD = """
    int[] faceVertexCounts = [4]
    int[] faceVertexIndices = [0, 1, 2, 3]
    point3f[] points = [(0, 0, 0), (100, 0, 0), (100, 200, 0), (0, 200, 0)]
    uniform token subdivisionScheme = "none"
"""


def _write(folder: Path, body: str, name: str = "a.usda", head: str = HEAD) -> Path:
    path = folder / name
    path.write_text(head + body)
    return path


def _corners(scene: LoadedScene) -> list[np.ndarray]:
    return [place.world_triangles().reshape(-1, 3) for place in scene.meshes]


def test_axis_and_unit_are_the_files_own(tmp_path: Path) -> None:
    """A floor of 1 x 2 m, Z-up in centimetres, lies level, facing up, without a guess."""
    scene = load_scene(_write(tmp_path, f'def Mesh "floor" {{{QUAD}}}'))
    assert scene.triangles == 2
    np.testing.assert_allclose([scene.lower_m, scene.upper_m], [[0, 0, -2], [1, 0, 0]], atol=1e-12)
    a, b, c = scene.meshes[0].world_triangles()[0]
    assert np.cross(b - a, c - a)[1] > 0
    assert (scene.placement.up, scene.placement.metres_per_unit) == ("z", 0.01)
    assert scene.notices == ()


def test_a_left_handed_mesh_is_wound_back(tmp_path: Path) -> None:
    """Left-handed faces have their outside on the other side."""
    body = f'def Mesh "floor" {{{QUAD} uniform token orientation = "leftHanded"\n}}'
    a, b, c = load_scene(_write(tmp_path, body)).meshes[0].world_triangles()[0]
    assert np.cross(b - a, c - a)[1] < 0


@pytest.mark.parametrize("orientation", ["rightHanded", "leftHanded"])
def test_a_concave_face_is_not_a_fan(tmp_path: Path, orientation: str) -> None:
    """An L of 3 square centimetres, from a corner about which a fan covers parts twice."""
    body = f"""def Mesh "l" {{
        int[] faceVertexCounts = [6]
        int[] faceVertexIndices = [0, 1, 2, 3, 4, 5]
        point3f[] points = [(2, 0, 0), (2, 1, 0), (1, 1, 0), (1, 2, 0), (0, 2, 0), (0, 0, 0)]
        uniform token orientation = "{orientation}"
    }}"""
    (triangles,) = [place.world_triangles() for place in load_scene(_write(tmp_path, body)).meshes]
    normals = 0.5 * np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    assert np.linalg.norm(normals, axis=1).sum() == pytest.approx(3e-4)
    assert np.linalg.norm(normals.sum(axis=0)) == pytest.approx(3e-4)


def test_preview_surface_and_its_picture(tmp_path: Path) -> None:
    """Values of UsdPreviewSurface, and the picture of the diffuse colour, with coordinates given at
    each corner of each face."""
    (tmp_path / "brick.png").write_bytes(png_bytes((4, 2)))
    body = f"""
def Mesh "floor" (prepend apiSchemas = ["MaterialBindingAPI"]) {{{QUAD}
    texCoord2f[] primvars:st = [(0, 0), (1, 0), (1, 1), (0, 1)] (interpolation = "faceVarying")
    rel material:binding = </paint>
}}
def Material "paint" {{
    token outputs:surface.connect = </paint/surface.outputs:surface>
    def Shader "surface" {{
        uniform token info:id = "UsdPreviewSurface"
        color3f inputs:diffuseColor.connect = </paint/picture.outputs:rgb>
        float inputs:roughness = 0.25
        float inputs:metallic = 0.75
        token outputs:surface
    }}
    def Shader "picture" {{
        uniform token info:id = "UsdUVTexture"
        asset inputs:file = @./brick.png@
        float3 outputs:rgb
    }}
}}
"""
    mesh = load_scene(_write(tmp_path, body)).meshes[0].mesh
    material = mesh.material
    assert (material.roughnessFactor, material.metallicFactor) == (0.25, 0.75)
    assert material.baseColorTexture.size == (4, 2)
    np.testing.assert_allclose(mesh.uv.max(axis=0), [1, 1])
    outside = body.replace("./brick.png", "../brick.png")
    (tmp_path / "deeper").mkdir()
    scene = load_scene(_write(tmp_path / "deeper", outside))
    assert "picture ../brick.png: outside the scene's folder, left out" in scene.notices
    assert scene.meshes[0].mesh.material.baseColorTexture is None


def test_faces_of_two_materials(tmp_path: Path) -> None:
    """Subsets of faces wear materials of their own."""
    body = f"""
def Mesh "floor" {{{QUAD.replace("[4]", "[3, 3]").replace("[0, 1, 2, 3]", "[0, 1, 2, 0, 2, 3]")}
    def GeomSubset "red" (prepend apiSchemas = ["MaterialBindingAPI"]) {{
        uniform token elementType = "face"
        uniform token familyName = "materialBind"
        int[] indices = [1]
        rel material:binding = </red>
    }}
}}
def Material "red" {{
    token outputs:surface.connect = </red/s.outputs:surface>
    def Shader "s" {{
        uniform token info:id = "UsdPreviewSurface"
        color3f inputs:diffuseColor = (1, 0, 0)
        token outputs:surface
    }}
}}
"""
    scene = load_scene(_write(tmp_path, body))
    colours = [tuple(place.mesh.material.baseColorFactor) for place in scene.meshes]
    assert colours == [(1, 0, 0, 1), (0.5, 0.5, 0.5, 1)]
    assert scene.triangles == 2


def test_instances_share_their_mesh(tmp_path: Path) -> None:
    """Native instances and those of a point instancer stand where they are placed, and share."""
    body = f"""
class "tile" {{
    def Mesh "floor" {{{QUAD}}}
}}
def Xform "a" (instanceable = true; prepend inherits = </tile>) {{
    double3 xformOp:translate = (300, 0, 0)
    uniform token[] xformOpOrder = ["xformOp:translate"]
}}
def Xform "b" (instanceable = true; prepend inherits = </tile>) {{
    double3 xformOp:translate = (500, 0, 0)
    uniform token[] xformOpOrder = ["xformOp:translate"]
}}
def PointInstancer "many" {{
    rel prototypes = [</many/one>]
    int[] protoIndices = [0, 0, 0]
    point3f[] positions = [(0, 0, 0), (0, 0, 100), (0, 0, 200)]
    def Mesh "one" {{{QUAD}}}
}}
"""
    scene = load_scene(_write(tmp_path, body))
    low = sorted(tuple(np.round(corners.min(axis=0), 6) + 0.0) for corners in _corners(scene))
    assert low == [(0, 0, -2), (0, 1, -2), (0, 2, -2), (3, 0, -2), (5, 0, -2)]
    assert len({id(place.mesh) for place in scene.meshes}) == 2


def test_hidden_things_and_guides_are_not_shown(tmp_path: Path) -> None:
    """Invisible prims and those of another purpose stay out; what is no mesh is told."""
    body = f"""
def Mesh "floor" {{{QUAD}}}
def Mesh "hidden" {{{QUAD} token visibility = "invisible"
}}
def Mesh "guide" {{{QUAD} uniform token purpose = "guide"
}}
def Mesh "smooth" {{{QUAD.replace('"none"', '"catmullClark"')}}}
def BasisCurves "hair" {{}}
"""
    scene = load_scene(_write(tmp_path, body))
    assert scene.triangles == 4
    assert scene.notices == (
        "USD subdivision surface: its cage is drawn",
        "USD BasisCurves: not drawn",
    )


@pytest.mark.parametrize(
    ("kind", "attributes", "lower_m", "upper_m", "volume_m3"),
    [
        ("Cube", "double size = 3", (-1.5, -1.5, -1.5), (1.5, 1.5, 1.5), 27.0),
        ("Sphere", "double radius = 2", (-2, -2, -2), (2, 2, 2), 32 / 3 * np.pi),
        (
            "Cylinder",
            "double radius = 2\ndouble height = 5",
            (-2, -2, -2.5),
            (2, 2, 2.5),
            20 * np.pi,
        ),
        (
            "Cylinder",
            'double height = 6\nuniform token axis = "X"',
            (-3, -1, -1),
            (3, 1, 1),
            6 * np.pi,
        ),
        ("Cone", 'double height = 6\nuniform token axis = "Y"', (-1, -3, -1), (1, 3, 1), 2 * np.pi),
        (
            "Capsule",
            "double radius = 1\ndouble height = 3",
            (-1, -1, -2.5),
            (1, 1, 2.5),
            13 / 3 * np.pi,
        ),
        ("Plane", 'double width = 4\nuniform token axis = "X"', (0, -1, -2), (0, 1, 2), 0.0),
        ("Plane", 'double width = 4\nuniform token axis = "Y"', (-2, 0, -1), (2, 0, 1), 0.0),
    ],
)
def test_shapes_are_closed_surfaces_of_their_size(
    tmp_path: Path,
    kind: str,
    attributes: str,
    lower_m: tuple[float, ...],
    upper_m: tuple[float, ...],
    volume_m3: float,
) -> None:
    """Extent and signed volume, positive where triangles face outwards, are the shape's (UsdGeom's
    schema), with the colour that is displayed."""
    body = f"""def {kind} "thing" {{
{attributes}
color3f[] primvars:displayColor = [(0.1, 0.2, 0.3)]
}}"""
    head = '#usda 1.0\n(\n    upAxis = "Y"\n    metersPerUnit = 1\n)\n'
    scene = load_scene(_write(tmp_path, body, head=head))
    np.testing.assert_allclose([scene.lower_m, scene.upper_m], [lower_m, upper_m], atol=1e-12)
    triangles = scene.meshes[0].world_triangles()
    assert np.linalg.det(triangles).sum() / 6 == pytest.approx(volume_m3, rel=0.01)
    colour = scene.meshes[0].mesh.material.baseColorFactor[:3]
    np.testing.assert_allclose(colour, [0.1, 0.2, 0.3], atol=1e-6)
    assert scene.notices == ()
    if kind == "Plane":
        a, b, c = triangles[0]
        assert np.cross(b - a, c - a).max() > 0


def test_layers_keep_to_the_folder(tmp_path: Path) -> None:
    """A reference beside the scene is followed, one out of its folder is refused."""
    (tmp_path / "in").mkdir()
    tile = f'def Mesh "floor" {{{QUAD}}}'
    part = HEAD.replace("(\n", '(\n    defaultPrim = "floor"\n', 1)
    _write(tmp_path / "in", tile, "part.usda", part)
    _write(tmp_path, tile, "part.usda", part)
    for name, good in (("./part.usda", True), ("../part.usda", False)):
        path = _write(tmp_path / "in", f'def "x" (prepend references = @{name}@) {{}}', "b.usda")
        if good:
            assert load_scene(path).triangles == 2
        else:
            with pytest.raises(UserError, match="leads out of the scene's folder"):
                load_scene(path)


def test_usd_at_rest_says_so(tmp_path: Path) -> None:
    """What moves over time is shown as it begins, and told."""
    body = f"""
def Mesh "floor" {{{QUAD}
    double3 xformOp:translate.timeSamples = {{ 1: (100, 0, 0), 24: (900, 0, 0) }}
    uniform token[] xformOpOrder = ["xformOp:translate"]
}}
"""
    head = HEAD.replace("(\n", "(\n    startTimeCode = 1\n    endTimeCode = 24\n", 1)
    scene = load_scene(_write(tmp_path, body, head=head))
    np.testing.assert_allclose(scene.lower_m, [1, 0, -2], atol=1e-12)
    assert scene.notices == ("USD animation: at rest, at the first of its times",)


@pytest.mark.parametrize("text", ["", "#usda 1.0\ndef Mesh {", "noise"])
def test_damaged_usd_gives_one_sentence(tmp_path: Path, text: str) -> None:
    """What is no USD, or ends early, is refused."""
    (tmp_path / "a.usda").write_text(text)
    with pytest.raises(UserError, match="cannot open the scene"):
        load_scene(tmp_path / "a.usda")


def test_a_stage_beyond_the_budget_is_refused(tmp_path: Path) -> None:
    """The file's size is counted before usd-core reads it."""
    path = _write(tmp_path, f'def Mesh "floor" {{{QUAD}}}' + " " * 2**22)
    with pytest.raises(UserError, match="its USD stage would hold"):
        load_scene(path, SceneBudget(600 * 2**20))


def test_without_the_package_the_line_says_what_to_do(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Where usd-core is not installed the sentence names the extra, and Blender."""
    monkeypatch.setitem(sys.modules, "pxr", None)
    with pytest.raises(UserError, match=r"vrut-lite\[usd\].*Blender"):
        load_scene(_write(tmp_path, f'def Mesh "floor" {{{QUAD}}}'))


DISPLAYED = [(1.0, 0.0, 0.0), (0.0, 0.5, 0.0), (0.2, 0.2, 0.2), (0.8, 0.1, 0.9)]


@pytest.mark.parametrize(
    ("how", "count"), [("constant", 1), ("uniform", 1), ("vertex", 4), ("faceVarying", 4)]
)
def test_display_colour_without_a_material(tmp_path: Path, how: str, count: int) -> None:
    """displayColor is linear, and all the colour of a mesh to which no material is bound."""
    colours = ", ".join(map(str, DISPLAYED[:count]))
    body = f"""
def Mesh "floor" {{{QUAD}
    color3f[] primvars:displayColor = [{colours}] (interpolation = "{how}")
}}
"""
    (place,) = load_scene(_write(tmp_path, body)).meshes
    mesh = place.mesh
    shown = np.tile(mesh.material.baseColorFactor[:3], (len(mesh.vertices), 1))
    if mesh.colours is not None:
        shown = shown * mesh.colours[:, :3]
    for corner, point in enumerate([(0, 0, 0), (100, 0, 0), (100, 200, 0), (0, 200, 0)]):
        at = int(np.argmin(np.abs(mesh.vertices - point).sum(axis=1)))
        expected = DISPLAYED[corner if count > 1 else 0]
        np.testing.assert_allclose(shown[at], expected, atol=1e-6)


def test_display_colour_is_inherited_and_gives_way(tmp_path: Path) -> None:
    """A constant one of a parent holds; a bound material goes before it."""
    body = f"""
def Xform "house" {{
    color3f[] primvars:displayColor = [(0.1, 0.2, 0.3)]
    def Mesh "floor" {{{QUAD}}}
    def Mesh "roof" (prepend apiSchemas = ["MaterialBindingAPI"]) {{{QUAD}
        rel material:binding = </red>
    }}
}}
def Material "red" {{
    token outputs:surface.connect = </red/shader.outputs:surface>
    def Shader "shader" {{
        uniform token info:id = "UsdPreviewSurface"
        color3f inputs:diffuseColor = (1, 0, 0)
        token outputs:surface
    }}
}}
"""
    colours = {
        place.name: place.mesh.material.baseColorFactor[:3]
        for place in load_scene(_write(tmp_path, body)).meshes
    }
    np.testing.assert_allclose(colours["floor"], [0.1, 0.2, 0.3], atol=1e-6)
    np.testing.assert_allclose(colours["roof"], [1.0, 0.0, 0.0])
