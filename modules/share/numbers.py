"""Numbers of `vrut-lite daylight` at places of the scene, which a page shows in false colours."""

import csv
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from vrut_lite.errors import UserError
from vrut_lite.messages.scene import SceneOpened
from vrut_lite.numeric_types import Float32Array, FloatArray

_TABLE = "sensors.csv"
_PLACE = ("x_m", "y_m", "z_m")
_DIRECTION = ("direction_x", "direction_y", "direction_z")
# Endings of columns, and units as people write them.
_UNITS = {"percent": "%", "lx": "lx", "klxh": "klx h", "h": "h", "k": "K", "kwh_m2": "kWh/m²"}
# Words that people write in capitals.
_CAPITALS = {word.lower(): word for word in ("DA", "sDA", "ASE", "UDI", "DGP", "CCT", "EDI")}
# Share of the numbers that may lie outside the scene, and by how much of its size.
_MOST_OUTSIDE, _MARGIN = 0.5, 0.05


@dataclass(frozen=True, eq=False)
class Numbers:
    """Values of some quantities at places of the scene.

    Attributes:
        names: of the quantities (C), as people read them.
        units: theirs, "" without one.
        values: (C, N) float32; NaN without a value.
        place_m: (N, 3) float32, world axes.
        direction: (N, 3) float32, the unit normals of the planes that the numbers are of.
        spacing_m: median distance from a place to the nearest other one.
    """

    names: tuple[str, ...]
    units: tuple[str, ...]
    values: Float32Array
    place_m: Float32Array
    direction: Float32Array
    spacing_m: float


def numbers_of(folder: Path, scene: SceneOpened) -> Numbers:
    """The numbers in a folder of `vrut-lite daylight`.

    Raises:
        UserError: it has no table of sensors, or that of another scene.
    """
    path = folder / _TABLE
    try:
        with path.open(encoding="utf-8", newline="") as file:
            rows = list(csv.DictReader(file))
    except (OSError, UnicodeDecodeError, csv.Error) as fault:
        raise UserError(
            f"{folder} has no readable {_TABLE}: name a folder that `vrut-lite daylight` wrote"
        ) from fault
    missing = [name for name in (*_PLACE, *_DIRECTION) if not rows or name not in rows[0]]
    if missing:
        raise UserError(f"{path} has no sensors with a column {missing[0]}")
    columns = {name: _values(rows, name) for name in rows[0] if name is not None}
    place = np.stack([columns[name] for name in _PLACE], axis=-1)
    direction = np.stack([columns[name] for name in _DIRECTION], axis=-1)
    if not (np.isfinite(place).all() and np.isfinite(direction).all()):
        raise UserError(f"{path} has a sensor whose place is no number")
    _check_inside(path, place, scene)
    shown = [
        name
        for name, values in columns.items()
        if name not in (*_PLACE, *_DIRECTION) and "error" not in name and np.isfinite(values).any()
    ]
    if not shown:
        raise UserError(f"{path} has places, but no number to show")
    names, units = zip(*map(_read, shown), strict=True)
    return Numbers(
        names,
        units,
        np.stack([columns[name] for name in shown]).astype(np.float32),
        place.astype(np.float32),
        (direction / np.maximum(np.linalg.norm(direction, axis=1, keepdims=True), 1e-9)).astype(
            np.float32
        ),
        _spacing_m(place, scene),
    )


def _values(rows: list[dict[str, str]], name: str) -> FloatArray:
    """Numbers (N,) of a column; NaN where a cell holds no number."""

    def number(text: str | None) -> float:
        try:
            return float(text or "nan")
        except ValueError:
            return float("nan")

    return np.array([number(row.get(name)) for row in rows])


def _check_inside(path: Path, place: FloatArray, scene: SceneOpened) -> None:
    lower, upper = np.array(scene.lower_m), np.array(scene.upper_m)
    margin = _MARGIN * float(np.linalg.norm(upper - lower))
    outside = ((place < lower - margin) | (place > upper + margin)).any(axis=1)
    if outside.mean() > _MOST_OUTSIDE:
        raise UserError(
            f"{path} is of another scene: {np.count_nonzero(outside)} of its {len(place)} sensors "
            "lie outside this one"
        )


def _spacing_m(place: FloatArray, scene: SceneOpened) -> float:
    if len(place) < 2:
        return 0.05 * float(np.linalg.norm(np.subtract(scene.upper_m, scene.lower_m)))
    # A few hundred places tell the grid's step.
    some = place[:: max(len(place) // 300, 1)]
    apart = np.linalg.norm(some[:, None] - place[None], axis=-1)
    apart[apart < 1e-6] = np.inf
    return float(np.median(apart.min(axis=1)))


def _read(column: str) -> tuple[str, str]:
    """A column's name and unit, as people read them."""
    words, unit = column, ""
    for ending, written in _UNITS.items():
        if column.endswith(f"_{ending}"):
            words, unit = column.removesuffix(f"_{ending}"), written
    named = " ".join(_CAPITALS.get(word, word) for word in words.split("_"))
    return (f"illuminance {named}" if named.startswith("of ") else named), unit
