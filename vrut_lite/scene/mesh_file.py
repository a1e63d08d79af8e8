"""Content of a mesh file as plain values, which one process writes and another reads."""

from typing import Literal

import msgspec

GlassKind = Literal["", "pane", "body"]


class FileMaterial(msgspec.Struct, frozen=True):
    """A material's factors, linear; `picture` is the file name of its colour, or empty.

    Of glass the colour is what it leaves of light: a `pane` is one sheet, a `body` has two sides.
    """

    name: str
    colour_rgba: tuple[float, float, float, float]
    roughness: float
    emission_rgb: tuple[float, float, float]
    picture: str = ""
    glass: GlassKind = ""


class MeshPart(msgspec.Struct):
    """A mesh as bytes of arrays.

    vertices (V, 3) float64, triangles (F, 3) int64, normals (V, 3) and uv (V, 2) float64, or empty,
    colours (V, 3) uint8, sRGB, or empty; world_from_part (n, 4, 4) float64. `names` are those of
    the n places where they differ from the mesh's.
    """

    name: str
    vertices: bytes
    triangles: bytes
    normals: bytes
    uv: bytes
    colours: bytes
    world_from_part: bytes
    material: FileMaterial | None
    names: list[str] = []


class MeshFile(msgspec.Struct):
    """Content of a file, and what it states of its axes and units; or its fault, and nothing else.

    `left_out` names things that are not read; `told` are further lines, each a thing and what is
    shown instead, with how often.
    """

    parts: list[MeshPart] = []
    up: str = ""
    metres_per_unit: float | None = None
    left_out: list[str] = []
    told: list[tuple[str, str, int]] = []
    fault: str = ""
    lacks_library: bool = False
    lacks_memory: bool = False
