"""OBJ and MTL by hand: one group of faces for each material, the same bytes each time."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vrut_lite_lab.scenes.shapes import PlainMesh


@dataclass(frozen=True)
class ObjMaterial:
    """Kd (linear), Ns, and an optional texture beside the file."""

    name: str
    albedo: tuple[float, float, float]
    shininess: float = 2.0
    texture: str | None = None


def write_obj(
    title: str, library: str, groups: list[tuple[ObjMaterial, PlainMesh]]
) -> tuple[bytes, bytes]:
    """The OBJ and its MTL, which is to be saved under the name `library`."""
    lines = [f"# {title}", f"mtllib {library}"]
    places, pictures, normals = _Numbered("v", 3), _Numbered("vt", 4), _Numbered("vn", 4)
    for material, shape in groups:
        columns = [places.add(shape.positions), normals.add(shape.normals)]
        if material.texture is not None:
            columns.insert(1, pictures.add(shape.uv * [1.0, -1.0]))
        lines += [*places.taken(), *pictures.taken(), *normals.taken()]
        lines += [f"g {material.name}", f"usemtl {material.name}"]
        between = "/" if material.texture is not None else "//"
        words = [between.join(map(str, row)) for row in zip(*columns, strict=True)]
        lines += ["f " + " ".join(words[i] for i in corners) for corners in _polygons(shape)]
    return ("\n".join(lines) + "\n").encode(), _mtl([material for material, _ in groups])


def _polygons(shape: PlainMesh) -> list[list[int]]:
    """The faces, fans of triangles joined again into the polygons they came from."""
    polygons: list[list[int]] = []
    for a, b, c in shape.faces.tolist():
        if polygons and [polygons[-1][0], polygons[-1][-1]] == [a, b]:
            polygons[-1].append(c)
        else:
            polygons.append([a, b, c])
    return polygons


class _Numbered:
    """Rows of numbers that are written once and referred to by number, from 1."""

    def __init__(self, word: str, decimals: int) -> None:
        self._word, self._decimals = word, decimals
        self._numbers: dict[str, int] = {}
        self._new: list[str] = []

    def add(self, rows: NDArray[np.float64]) -> list[int]:
        result = []
        for row in np.round(rows, self._decimals) + 0.0:
            line = " ".join([self._word, *(f"{value:.6g}" for value in row)])
            if line not in self._numbers:
                self._numbers[line] = len(self._numbers) + 1
                self._new.append(line)
            result.append(self._numbers[line])
        return result

    def taken(self) -> list[str]:
        lines, self._new = self._new, []
        return lines


def _mtl(materials: list[ObjMaterial]) -> bytes:
    lines = []
    for material in materials:
        lines += [
            f"newmtl {material.name}",
            "Kd " + " ".join(f"{value:g}" for value in material.albedo),
            f"Ns {material.shininess:g}",
            "d 1",
        ]
        if material.texture is not None:
            lines.append(f"map_Kd {material.texture}")
        lines.append("")
    return "\n".join(lines).encode()
