"""Sensors: points with a direction, in named planes; those of a CSV file."""

import csv
import re
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from vrut_lite.errors import UserError
from vrut_lite.numeric_types import BoolArray, FloatArray
from vrut_lite.plain_numbers import plain_float
from vrut_lite.text_files import read_text

_SHORTEST = 1e-9
MOST_SENSORS = 100_000
_MOST_BYTES = 64 << 20
_UP = [0.0, 1.0, 0.0]
_NUMERIC = re.compile(r"[-+.]*\d", re.ASCII)


@dataclass(frozen=True, eq=False)
class Sensors:
    """Where light is measured (P); world axes.

    Attributes:
        places_m: (P, 3).
        normals: (P, 3), unit vectors.
        plane: (P,) int, the work plane of each.
        cell: (P, 2) int, row and column in its plane's grid, rows along +z and columns along +x.
        inner: (P,) bool, not within half a metre of a wall (EN 17037).
        names: of the planes.
        step_m: edge of each plane's cells, 0 for points that are in no grid.
    """

    places_m: FloatArray
    normals: FloatArray
    plane: NDArray[np.int64]
    cell: NDArray[np.int64]
    inner: BoolArray
    names: tuple[str, ...]
    step_m: tuple[float, ...]

    def __len__(self) -> int:
        return len(self.places_m)

    def some(self, chosen: NDArray[np.integer] | BoolArray) -> "Sensors":
        """Those that are chosen, with all planes."""
        return replace(
            self,
            places_m=self.places_m[chosen],
            normals=self.normals[chosen],
            plane=self.plane[chosen],
            cell=self.cell[chosen],
            inner=self.inner[chosen],
        )


@dataclass(frozen=True, eq=False)
class SensorGrid:
    """How work planes are found: `height_m` above floors, in cells of `step_m`."""

    height_m: float
    step_m: float


def free_sensors(places_m: FloatArray, normals: FloatArray, name: str) -> Sensors:
    """Points (P, 3) with directions (P, 3) of any length, which lie in no grid.

    Raises:
        UserError: no sensor is given, or one is not finite or has no direction.
    """
    places_m, normals = np.asarray(places_m, float), np.asarray(normals, float)
    if not len(places_m):
        raise UserError(f"{name} has no sensors: give at least one point")
    bad = np.flatnonzero(~np.isfinite(np.hstack([places_m, normals])).all(axis=1))
    if len(bad):
        raise UserError(f"sensor {bad[0] + 1} of {name} is no finite point and direction")
    length = np.linalg.norm(normals, axis=1)
    bad = np.flatnonzero(length < _SHORTEST)
    if len(bad):
        raise UserError(f"sensor {bad[0] + 1} of {name} has a direction of no length")
    count = len(places_m)
    return Sensors(
        places_m,
        normals / length[:, None],
        np.zeros(count, np.int64),
        np.full((count, 2), -1),
        np.ones(count, bool),
        (name,),
        (0.0,),
    )


def read_sensors(path: str | Path) -> Sensors:
    """Points in the scene's axes (y up), a row each: x,y,z or x,y,z,dx,dy,dz.

    A heading, in which no cell begins as a number, may stand first, and remarks begin with #.

    Raises:
        UserError: the file cannot be read, or a row is no point.
    """
    file = Path(path)
    text = read_text(file, "the sensors", _MOST_BYTES)
    # A row's cells by its line; spreadsheets write empty ones behind.
    reader = csv.reader(text.split("\n"))
    cells = ((reader.line_num, [cell.strip() for cell in row]) for row in reader)
    rows = [(line, row) for line, row in cells if any(row) and not row[0].startswith("#")]
    if rows and not any(map(_NUMERIC.match, rows[0][1])):
        rows = rows[1:]
    if len(rows) > MOST_SENSORS:
        raise UserError(f"{file} has {len(rows):,} sensors: at most {MOST_SENSORS:,} are computed")
    numbers = np.empty((len(rows), 6))
    for number, (line, row) in enumerate(rows):
        while not row[-1]:
            row.pop()
        if len(row) not in (3, 6):
            raise UserError(
                f"line {line} of {file} has {len(row)} numbers: give x,y,z or x,y,z,dx,dy,dz, with "
                "commas between them"
            )
        try:
            values = [plain_float(value) for value in row]
        except ValueError:
            raise UserError(f"line {line} of {file} is no numbers: {','.join(row)[:80]}") from None
        numbers[number] = values if len(values) == 6 else values + _UP
    return free_sensors(numbers[:, :3], numbers[:, 3:], str(file))
