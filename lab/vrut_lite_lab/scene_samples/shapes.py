"""Samples of what stands where: bent, packed, placed, moved and seen meshes, and lamps."""

import base64
import struct
from collections.abc import Callable

import meshopt
import numpy as np

from vrut_lite_lab.scene_samples.document import BALL_AT, PANEL_AT, Document
from vrut_lite_lab.scenes.shapes import box, sphere

# Half a turn about x points a lamp's -Z down, where its node has none.
_DOWN = [-0.70710678, 0.0, 0.0, 0.70710678]
# A downlight that is four times dimmer across than along.
_IES = """IESNA:LM-63-1995
TILT=NONE
1 1000 1 4 3 1 2 0.1 0.1 0 1 1 10
0 30 50 90
0 45 90
900 600 100 0
900 400 50 0
900 100 10 0
"""


def morphed(document: Document) -> None:
    """A ball that a target, at a weight of 0.6, pulls into an egg."""
    shape = sphere(0.5, 48)
    number = document.mesh(shape, document.material((0.7, 0.4, 0.2)))
    taller = shape.positions * [0.0, 1.2, 0.0]
    mesh = document.json["meshes"][number]
    mesh["primitives"][0]["targets"] = [{"POSITION": document.array(taller)}]
    mesh["weights"] = [0.6]
    document.place(number, (0.0, 0.8, 0.0))


def skinned(document: Document) -> None:
    """A post that its second joint bends by 60 degrees."""
    angle, height = np.meshgrid(np.linspace(0, 2 * np.pi, 25), np.linspace(0, 1.6, 33))
    around = np.stack([np.cos(angle), 0 * angle, np.sin(angle)], -1).reshape(-1, 3)
    positions = 0.15 * around + np.stack([0 * angle, height, 0 * angle], -1).reshape(-1, 3)
    corner = (np.arange(32)[:, None] * 25 + np.arange(24)).ravel()
    faces = np.concatenate(
        [
            np.stack([corner, corner + 25, corner + 26], 1),
            np.stack([corner, corner + 26, corner + 1], 1),
        ]
    )
    upper = np.clip((height.ravel() - 0.6) / 0.4, 0.0, 1.0)
    weights = np.stack([1 - upper, upper, 0 * upper, 0 * upper], 1)
    joints = np.tile([0, 1, 0, 0], (len(weights), 1))
    attributes = {
        "POSITION": document.array(positions), "NORMAL": document.array(around),
        "JOINTS_0": document.array(joints, "<u1"), "WEIGHTS_0": document.array(weights),
    }  # fmt: skip
    material = document.material((0.2, 0.5, 0.4))
    primitive = {"attributes": attributes, "material": material,
                 "indices": document.array(faces.reshape(-1), "<u4")}  # fmt: skip
    mesh = document.add("meshes", {"primitives": [primitive]})
    elbow = document.add("nodes", {"translation": [0, 0.8, 0], "rotation": [0, 0, 0.5, 0.8660254]})
    root = document.node(children=[elbow])
    inverse = np.tile(np.eye(4), (2, 1, 1))
    inverse[1, 3, 1] = -0.8
    skin = {"joints": [root, elbow], "inverseBindMatrices": document.array(inverse)}
    document.node(mesh=mesh, skin=document.add("skins", skin))


def instanced(document: Document) -> None:
    """One box in twelve places of EXT_mesh_gpu_instancing, each turned a little more."""
    document.uses("EXT_mesh_gpu_instancing", required=True)
    number = np.arange(12)
    at = np.stack([0.5 * (number % 4 - 1.5), 0.15 + 0 * number, 0.5 * (number // 4) - 0.5], 1)
    half = 0.1 * number
    turned = np.stack([0 * half, np.sin(half), 0 * half, np.cos(half)], 1)
    places = {"TRANSLATION": document.array(at), "ROTATION": document.array(turned)}
    extension = {"EXT_mesh_gpu_instancing": {"attributes": places}}
    mesh = document.mesh(box((-0.15,) * 3, (0.15,) * 3), document.material((0.7, 0.5, 0.2)))
    document.node(mesh=mesh, extensions=extension)


def meshopt_packed(document: Document) -> None:
    """A ball whose vertices and triangles meshoptimizer packed."""
    document.uses("EXT_meshopt_compression", required=True)
    shape = sphere(0.5, 32)
    mesh = document.mesh(shape, document.material((0.3, 0.6, 0.3)))
    primitive = document.json["meshes"][mesh]["primitives"][0]
    for key, values in (("POSITION", shape.positions), ("NORMAL", shape.normals)):
        accessor = document.json["accessors"][primitive["attributes"][key]]
        view = document.json["bufferViews"][accessor["bufferView"]]
        packed = bytes(meshopt.encode_gltf_buffer(values.astype("<f4"), "ATTRIBUTES"))
        found = document.json["bufferViews"][document.view(packed)]
        view["extensions"] = {"EXT_meshopt_compression": {
            **found, "byteStride": 12, "count": len(values), "mode": "ATTRIBUTES"}}  # fmt: skip
    document.place(mesh, (0.0, 0.55, 0.0))


def ktx2(document: Document) -> None:
    """A panel with a KTX 2 picture: red and green above blue and a clear grey."""
    document.uses("KHR_texture_basisu", required=True)
    view = document.view(base64.b64decode(_KTX2))
    image = document.add("images", {"bufferView": view, "mimeType": "image/ktx2"})
    texture = document.add("textures", {"extensions": {"KHR_texture_basisu": {"source": image}}})
    document.panel(document.material((1, 1, 1), pbr={"baseColorTexture": {"index": texture}}))
    webp = np.indices((32, 32)).sum(axis=0)[..., None] * np.array([4, 2, 1])
    document.uses("EXT_texture_webp")
    found = document.texture(webp, "WEBP")
    source = document.json["textures"][found["index"]].pop("source")
    document.json["textures"][found["index"]]["extensions"] = {
        "EXT_texture_webp": {"source": source}
    }
    paint = document.material((1, 1, 1), pbr={"baseColorTexture": found})
    document.panel(paint, (-0.75, 0.6, 0.0))


def quantised(document: Document) -> None:
    """Positions in 16 bits, normals in 8 (KHR_mesh_quantization)."""
    document.uses("KHR_mesh_quantization", required=True)
    shape = sphere(0.5, 48)
    mesh = document.mesh(shape, document.material((0.3, 0.4, 0.7)))
    attributes = document.json["meshes"][mesh]["primitives"][0]["attributes"]
    stored = np.pad(np.round(shape.positions * 32000), ((0, 0), (0, 1)))
    for key, values, dtype, stride in (
        ("POSITION", stored, "<i2", 8),
        ("NORMAL", np.pad(np.round(shape.normals * 127), ((0, 0), (0, 1))), "<i1", 4),
    ):
        number = document.array(values, dtype, normalized=True)
        accessor = document.json["accessors"][number]
        accessor["type"] = "VEC3"
        document.json["bufferViews"][accessor["bufferView"]]["byteStride"] = stride
        attributes[key] = number
    document.place(mesh, (0.0, 0.55, 0.0), scale=[1.024] * 3)


def stroked(document: Document) -> None:
    """A wire cube and a cloud of coloured points, beside a ball."""
    corners = np.array(np.meshgrid([-1, 1], [-1, 1], [-1, 1])).reshape(3, -1).T * 0.45
    pairs = [(i, j) for i in range(8) for j in range(i) if np.sum(corners[i] != corners[j]) == 1]
    paint = document.material((0.9, 0.3, 0.1))
    lines = {"attributes": {"POSITION": document.array(corners)}, "mode": 1, "material": paint,
             "indices": document.array(np.ravel(pairs), "<u4")}  # fmt: skip
    document.place(document.add("meshes", {"primitives": [lines]}), PANEL_AT)
    turn = np.linspace(0, 12 * np.pi, 600)
    spiral = np.stack([0.4 * np.cos(turn), turn / 40, 0.4 * np.sin(turn)], 1)
    colours = 0.5 + 0.5 * np.stack([np.cos(turn / 6), np.sin(turn / 9), np.cos(turn / 4)], 1)
    attributes = {"POSITION": document.array(spiral), "COLOR_0": document.array(colours)}
    points = {"attributes": attributes,
              "mode": 0, "material": document.material((1, 1, 1))}  # fmt: skip
    document.place(document.add("meshes", {"primitives": [points]}), (0.0, 0.1, -0.6))
    document.ball(document.material())


def _lamp(kind: str, **more: object) -> Callable[[Document], None]:
    def make(document: Document) -> None:
        document.ball(document.material((0.7, 0.7, 0.7)))
        document.uses("KHR_lights_punctual")
        lamp = {"type": kind, "intensity": 300.0, "color": [1.0, 0.8, 0.5], **more}
        document.json["extensions"] = {"KHR_lights_punctual": {"lights": [lamp]}}
        document.node(
            translation=[0.4, 2.0, 0.4], rotation=_DOWN,
            extensions={"KHR_lights_punctual": {"light": 0}},
        )  # fmt: skip

    return make


def luminaire(document: Document) -> None:
    """An IES file in the document."""
    document.ball(document.material((0.7, 0.7, 0.7)))
    document.uses("EXT_lights_ies")
    view = document.view(_IES.encode())
    profile = {"bufferView": view, "mimeType": "application/x-ies-lm-63"}
    document.json["extensions"] = {"EXT_lights_ies": {"lights": [profile]}}
    extension = {"EXT_lights_ies": {"light": 0}}
    document.node(translation=[0.4, 2.0, 0.4], rotation=_DOWN, extensions=extension)


def animated(document: Document) -> None:
    """A ball that rises by 1 m in a second, at half of it; another scene beside the first."""
    document.json["scenes"].append({"nodes": []})
    node = document.ball(document.material((0.7, 0.2, 0.2)), (0.0, 0.5, 0.0))
    times, places = document.array([0.0, 1.0]), document.array([[0, 0.5, 0], [0, 1.5, 0]])
    channel = {"sampler": 0, "target": {"node": node, "path": "translation"}}
    sampler = {"input": times, "output": places}
    document.add("animations", {"channels": [channel], "samplers": [sampler]})


def filming(document: Document) -> None:
    """A second camera, from above, that a project asks for."""
    document.ball(document.material((0.2, 0.2, 0.7)))
    document.panel(document.material((0.2, 0.6, 0.2)))
    lens = {"type": "perspective", "perspective": {"yfov": 0.9, "znear": 0.1}}
    camera = document.add("cameras", lens)
    document.node(name="above", camera=camera, translation=[0, 3.5, 0.01], rotation=_DOWN)


def dressed(document: Document) -> None:
    """A ball that is red, and blue in the variant that is asked for."""
    name = "KHR_materials_variants"
    document.uses(name)
    document.json["extensions"] = {name: {"variants": [{"name": "blue"}]}}
    red, blue = document.material((0.7, 0.1, 0.1)), document.material((0.1, 0.1, 0.7))
    mapping = {"mappings": [{"material": blue, "variants": [0]}]}
    mesh = document.mesh(sphere(0.5, 48), red, extensions={name: mapping})
    document.place(mesh, BALL_AT)


def sparse(document: Document) -> None:
    """A box of which sparse values lift one corner; another that a matrix mirrors."""
    shape = box((-0.4, 0.0, -0.4), (0.4, 0.8, 0.4))
    mesh = document.mesh(shape, document.material((0.6, 0.5, 0.7)))
    corner = np.flatnonzero(np.all(shape.positions > [0.3, 0.7, 0.3], axis=1))
    moved = shape.positions[corner] + [0.0, 0.5, 0.0]
    attributes = document.json["meshes"][mesh]["primitives"][0]["attributes"]
    document.json["accessors"][attributes["POSITION"]]["sparse"] = {
        "count": len(corner),
        "indices": {"bufferView": document.view(struct.pack(f"<{len(corner)}H", *corner)),
                    "componentType": 5123},
        "values": {"bufferView": document.view(moved.astype("<f4").tobytes())},
    }  # fmt: skip
    document.place(mesh, (-0.75, 0.0, 0.0))
    document.place(mesh, (0.75, 0.0, 0.0), scale=[-1, 1, 1])


SHAPES: dict[str, Callable[[Document], None]] = {
    "morph targets": morphed,
    "skin": skinned,
    "sparse, mirrored": sparse,
    "instancing": instanced,
    "meshopt": meshopt_packed,
    "KTX2 and WebP": ktx2,
    "quantisation": quantised,
    "points and lines": stroked,
    "point lamp": _lamp("point"),
    "spot lamp": _lamp("spot", spot={"innerConeAngle": 0.35, "outerConeAngle": 0.6}),
    "IES lamp": luminaire,
    "animation, scenes": animated,
    "cameras": filming,
    "variants": dressed,
}
# 8 x 8 pixels in four fields, by basis_universal's encoder (ETC1S).
_KTX2 = (
    "q0tUWCAyMLsNChoKAAAAAAEAAAAIAAAACAAAAAAAAAAAAAAAAQAAAAEAAAABAAAAaAAAADwAAACkAAAAJAAA"
    "AMgAAAAAAAAAkgAAAAAAAABaAQAAAAAAAAQAAAAAAAAAAAAAAAAAAAA8AAAAAAAAAAIAOACjAQIAAwMAAAgI"
    "AAAAAAAAAAA/AAAAAAAAAAAA/////0AAPw8AAAAAAAAAAP////8fAAAAS1RYd3JpdGVyAEJhc2lzIFVuaXZl"
    "cnNhbCAyLjEwAAAGAAIAMgAAAAkAAAAvAAAAAAAAAAAAAAAAAAAAAgAAAAIAAAACAAAAIMCUAAAAAAAQ5Aui"
    "GcCUAAAAAAAQdEEbEcCEAAEAAAAAkgcQgCkAAAAAABAoC4D+p1msqqqqUlVVVQUAwUQAAAAAAADy3yeIATAF"
    "QAAAAACAZBgBIgQIAAAAQGKCCQKACQAAAAAAAAQQAJsecAU="
)
