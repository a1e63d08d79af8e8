"""Reads OFF of text: polygons, with normals and colours of vertices and colours of faces.

The format is Geomview's (manual, section "OFF Files"). Colours are whole numbers to 255, or
fractions of 1.
"""

import re
import warnings

import numpy as np
from numpy.typing import NDArray

from vrut_lite.numeric_types import FloatArray
from vrut_lite.scene.ear_clipping import polygon_corners
from vrut_lite.scene.mesh_file import MeshFile, MeshPart
from vrut_lite.scene.process_limits import Damaged

_HEAD = re.compile(rb"\s*(ST)?(C)?(N)?OFF\b")
_MORE_DIMENSIONS = re.compile(rb"\s*[A-Z]*[4n]+OFF\b")
# Colour of a face without one, as Geomview draws it.
_NO_COLOUR = 170


def read_off(data: bytes) -> MeshFile:
    """The file's mesh.

    Raises:
        Damaged: it is binary, has more than three dimensions, ends early, or names no vertex.
    """
    if _MORE_DIMENSIONS.match(data):
        raise Damaged("its points have more than three dimensions")
    text = re.sub(rb"#[^\n]*", b"", data)
    head = _HEAD.match(text)
    body = b"" if head is None else text[head.end() :]
    lines = [line for line in body.splitlines() if line.strip()]
    counts = lines[0].split() if lines else []
    if head is not None and counts[:1] == [b"BINARY"]:
        raise Damaged("it is a binary OFF; write it as text")
    if head is None or len(counts) < 2 or not (counts[0] + counts[1]).isdigit():
        raise Damaged("it does not begin with OFF and its counts")
    vertices, faces = int(counts[0]), int(counts[1])
    if len(lines) - 1 < vertices + faces:
        raise Damaged(
            f"its head counts {vertices:,} vertices, {faces:,} faces; lines after it: "
            f"{len(lines) - 1:,}"
        )
    points = _points(lines[1 : 1 + vertices])
    first = 6 if head[3] else 3
    normals = points[:, 3:6] if head[3] and points.shape[1] >= 6 else np.empty((0, 3))
    rgb = None
    if head[2] and points.shape[1] >= first + 3:
        rgb = _bytes_of(points[:, first : first + 3])
    return _mesh_file(points[:, :3], normals, rgb, lines[1 + vertices : 1 + vertices + faces])


def _regular(lines: list[bytes]) -> FloatArray | None:
    """Lines of equally many numbers as rows (n, columns); None for others."""
    columns = len(lines[0].split()) if lines else 3
    with warnings.catch_warnings():
        # It stops at the first word that is no number: then numbers are missing.
        warnings.simplefilter("ignore", DeprecationWarning)
        numbers = np.fromstring(b"\n".join(lines), np.float64, sep=" ")
    return numbers.reshape(-1, columns) if numbers.size == len(lines) * columns else None


def _points(lines: list[bytes]) -> FloatArray:
    """Vertices as rows (n, columns): as many numbers of each as the shortest has."""
    table = _regular(lines)
    if table is None:
        words = [line.split() for line in lines]
        columns = min(map(len, words))
        table = np.array([one[:columns] for one in words], np.float64)
    if table.shape[1] < 3:
        raise Damaged("a vertex has fewer than three numbers")
    return table


def _polygons(lines: list[bytes]) -> tuple[NDArray[np.int64], NDArray[np.int64], FloatArray | None]:
    """Sizes, all corners one after another, and colours (n, 3) of faces, NaN where one has none."""
    table = _regular(lines)
    if table is not None and len(table):
        size = int(table[0, 0])
        if (table[:, 0] == size).all() and 0 <= size < table.shape[1]:
            rgb = table[:, size + 1 : size + 4]
            corners = table[:, 1 : size + 1].astype(np.int64).ravel()
            return np.full(len(lines), size), corners, rgb if rgb.shape[1] == 3 else None
    words = [line.split() for line in lines]
    sizes = [int(one[0]) for one in words]
    if any(not 0 <= size < len(one) for size, one in zip(sizes, words, strict=True)):
        raise Damaged("a face has fewer corners than it counts")
    corners = np.array(
        [word for size, one in zip(sizes, words, strict=True) for word in one[1 : size + 1]],
        np.int64,
    )
    # A single word is a place in a table of colours that the file does not have.
    stated = [one[size + 1 : size + 4] for size, one in zip(sizes, words, strict=True)]
    rgb = np.array([one if len(one) == 3 else [np.nan] * 3 for one in stated], np.float64)
    return np.array(sizes, np.int64), corners, None if np.isnan(rgb).all() else rgb.reshape(-1, 3)


def _mesh_file(
    points: FloatArray, normals: FloatArray, rgb: NDArray[np.uint8] | None, lines: list[bytes]
) -> MeshFile:
    sizes, indices, face_rgb = _polygons(lines)
    corners, polygon = polygon_corners(points, sizes, indices)
    triangles = indices[corners]
    colours = np.empty((0, 3), np.uint8) if rgb is None else rgb
    if rgb is None and face_rgb is not None:
        each = triangles.reshape(-1)
        points, triangles = points[each], np.arange(len(each))
        normals = normals[each] if len(normals) else normals
        colours = np.repeat(_bytes_of(face_rgb)[polygon], 3, axis=0)
    part = MeshPart(
        "mesh",
        points.tobytes(),
        triangles.tobytes(),
        normals.tobytes(),
        b"",
        colours.tobytes(),
        np.eye(4)[None].tobytes(),
        None,
    )
    return MeshFile(parts=[part])


def _bytes_of(rgb: FloatArray) -> NDArray[np.uint8]:
    """Colours (n, 3) as bytes; numbers of which none is above 1 are fractions."""
    stated = ~np.isnan(rgb)
    scale = 255.0 if rgb.max(initial=0.0, where=stated) <= 1.0 else 1.0
    return np.where(stated, np.clip(np.rint(scale * rgb), 0, 255), _NO_COLOUR).astype(np.uint8)
