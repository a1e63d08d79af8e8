"""Every sample as files in a folder, and the project that opens it."""

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from PIL import Image

from vrut_lite.messages.placement import PlacedFile, Placement
from vrut_lite.project import CameraView, Project
from vrut_lite_lab.scene_samples.document import Document
from vrut_lite_lab.scene_samples.shapes import SHAPES
from vrut_lite_lab.scene_samples.surfaces import SURFACES

_EYE_M, _TARGET_M = (0.0, 1.35, 3.7), (0.0, 0.5, 0.0)
_DAY, _NIGHT = "2026-06-21T10:30", "2026-06-21T23:30"
# What a project says besides, by the sample's name.
_MORE: dict[str, dict[str, Any]] = {
    "point lamp": {"at": _NIGHT},
    "spot lamp": {"at": _NIGHT},
    "IES lamp": {"at": _NIGHT},
    "emissive strength": {"at": "2026-06-21T20:40"},
    "animation, scenes": {"animation": "time", "animation_time_s": 0.5},
    "cameras": {"scene_camera": "above", "camera": None},
    "variants": {"variant": "blue"},
}
# A house with a roof on its plot, Z up, in metres.
_HOUSE = (
    "v 0 0 0\nv 4 0 0\nv 4 3 0\nv 0 3 0\nv 0 0 2\nv 4 0 2\nv 4 3 2\nv 0 3 2\n"
    "v 0 1.5 3.2\nv 4 1.5 3.2\nvt 0 0\nvt 2 0\nvt 2 1\nvt 0 1\n"
    "usemtl wall\nf 1/1 2/2 6/3 5/4\nf 2/1 3/2 7/3 6/4\nf 3/1 4/2 8/3 7/4\nf 4/1 1/2 5/3 8/4\n"
    "f 4 3 2 1\nusemtl roof\nf 5 6 10 9\nf 7 8 9 10\nf 8 5 9\nf 6 7 10\n"
    "v -3 -3 0\nv 7 -3 0\nv 7 6 0\nv -3 6 0\nusemtl plot\nf 11 12 13 14\n"
)
_MTL = "newmtl wall\nKd 1 1 1\nmap_Kd C:\\models\\maps\\bricks.png\nnewmtl roof\nKd 0.5 0.1 0.06\n"
_MTL += "newmtl plot\nKd 0.2 0.25 0.12\n"
_USD = """#usda 1.0
( upAxis = "Z"
  metersPerUnit = 0.01 )
def Xform "Row" {
  def Mesh "Pyramid" (prepend apiSchemas = ["MaterialBindingAPI"]) {
    int[] faceVertexCounts = [4, 3, 3, 3, 3]
    int[] faceVertexIndices = [3, 2, 1, 0, 0, 1, 4, 1, 2, 4, 2, 3, 4, 3, 0, 4]
    point3f[] points = [(-60, -60, 0), (60, -60, 0), (60, 60, 0), (-60, 60, 0), (0, 0, 110)]
    uniform token subdivisionScheme = "none"
    rel material:binding = </Row/Paint>
  }
  def Material "Paint" {
    token outputs:surface.connect = </Row/Paint/Shader.outputs:surface>
    def Shader "Shader" {
      uniform token info:id = "UsdPreviewSurface"
      color3f inputs:diffuseColor = (0.6, 0.45, 0.15)
      float inputs:roughness = 0.4
      token outputs:surface
    }
  }
}
"""


class Sample(NamedTuple):
    """A kind, and the project that shows it."""

    kind: str
    project: Project


def samples(folder: Path) -> Iterator[Sample]:
    """Write all of them."""
    for kind, make in {**SURFACES, **SHAPES}.items():
        yield _of_gltf(folder, kind, make)
    yield from _of_obj(folder)
    (folder / "pyramid.usda").write_text(_USD)
    yield _sample("USD, cm, Z up", folder / "pyramid.usda")


def _of_gltf(folder: Path, kind: str, make: Callable[[Document], None]) -> Sample:
    document = Document()
    document.floor()
    make(document)
    name = "".join(letter if letter.isalnum() else "_" for letter in kind)
    return _sample(kind, document.write(folder / f"{name}.glb"), **_MORE.get(kind, {}))


def _of_obj(folder: Path) -> Iterator[Sample]:
    """The house as other programs write it: Z up, in centimetres, with paths of Windows."""
    (folder / "house.mtl").write_text(_MTL)
    rows, columns = np.indices((64, 64))
    joint = (rows % 16 < 2) | ((columns + 16 * (rows // 16 % 2)) % 32 < 2)
    brick = np.where(joint[..., None], (190, 185, 175), (150, 60, 45)).astype(np.uint8)
    Image.fromarray(brick).save(folder / "bricks.png")
    paths = {}
    for name, scale in (("metres", 1.0), ("centimetres", 100.0)):
        lines = [
            " ".join(["v", *(f"{scale * float(word):g}" for word in line.split()[1:])])
            if line.startswith("v ")
            else line
            for line in _HOUSE.splitlines()
        ]
        paths[name] = folder / f"house_{name}.obj"
        paths[name].write_text("mtllib .\\house.mtl\n" + "\n".join(lines) + "\n")
    far = CameraView(eye_m=(9.0, 4.0, 8.0), target_m=(1.5, 1.2, -1.5))
    yield _sample("OBJ, Z up, MTL of Windows", paths["metres"], camera=far)
    yield _sample("OBJ, cm", paths["centimetres"], camera=far)
    beside = PlacedFile(
        scene=str(paths["metres"]),
        placement=Placement(position_m=(-6.0, 0.0, -3.0), heading_deg=90.0),
    )
    yield _sample("several files", paths["metres"], camera=far, beside=(beside,))


def _sample(kind: str, path: Path, **more: Any) -> Sample:
    camera = CameraView(eye_m=_EYE_M, target_m=_TARGET_M)
    fields = {"scene": str(path), "at": _DAY, "camera": camera, "air": False, **more}
    return Sample(kind, Project(**fields))
