"""Luminaires where they stand: those of a project's tables, of a CSV file, and the scene's own."""

import csv
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from vrut_lite.array import Array
from vrut_lite.errors import UserError
from vrut_lite.geometry.colour import LUMENS_PER_WATT, luminance
from vrut_lite.headless import Luminaire, LuminousOpening, read_luminaire_file
from vrut_lite.messages.lamps import ALL_AROUND, TABLE_SHAPE, SceneLamps
from vrut_lite.messages.lighting import LampPlacement
from vrut_lite.numeric_types import FloatArray, IntArray
from vrut_lite.plain_numbers import plain_float
from vrut_lite.text_files import read_text

_MOST_LAMPS = 4096
_MOST_BYTES = 16 << 20
_HEADING = ("file", "x", "y", "z", "dx", "dy", "dz", "rotation_deg", "group")
_FEWEST_CELLS = 4
# Cosine to the vertical above which an axis is taken for upright.
_UPRIGHT = 1.0 - 1e-9
# Angles at which a lamp of the scene is looked up: every degree, every five around its axis.
_ROWS, _COLUMNS = TABLE_SHAPE


@dataclass(frozen=True, eq=False)
class PlacedLuminaires:
    """Luminaires (L) of a scene in world axes, and the groups (G) by which they are controlled.

    Attributes:
        kinds: luminaires, each once.
        kind: (L,) which of these.
        places_m: (L, 3), middles of their luminous openings.
        axes: (L, 3, 3), rows of unit vectors along axis, +X and +Y of the luminaire.
        output: (L,), share of the file's candela.
        watts: (L,), input power.
        group: (L,), number of the group.
        groups: names.
    """

    kinds: tuple[Luminaire, ...]
    kind: NDArray[np.int64]
    places_m: FloatArray
    axes: FloatArray
    output: FloatArray
    watts: FloatArray
    group: NDArray[np.int64]
    groups: tuple[str, ...]

    def __len__(self) -> int:
        return len(self.kind)

    @property
    def group_watts(self) -> FloatArray:
        """Installed power (G,), W."""
        return np.bincount(self.group, self.watts, len(self.groups)).astype(float)

    @property
    def flux_lm(self) -> FloatArray:
        """Luminous flux (L,), lm."""
        return np.array([kind.flux_lm for kind in self.kinds])[self.kind] * self.output

    def points(self, lamps: IntArray, counts: IntArray) -> SceneLamps:
        """Some luminaires (N,) as points, with counts (N, 2) of them along each opening's edges."""
        photometries = [kind.photometry() for kind in self.kinds]
        places, axes, intensity, table = [], [], [], []
        for lamp, along in zip(lamps.tolist(), counts, strict=True):
            kind = int(self.kind[lamp])
            offsets, weights = opening_points(self.kinds[kind].opening, along)
            places.append(self.places_m[lamp] + offsets @ self.axes[lamp][1:])
            axes.append(np.repeat(self.axes[lamp][None], len(weights), axis=0))
            intensity.append(weights * self.output[lamp] * photometries[kind].candela)
            table.append(np.full(len(weights), kind, np.int32))
        white = np.repeat(np.concatenate(intensity)[:, None] / LUMENS_PER_WATT, 3, axis=1)
        return SceneLamps(
            names=Array(np.zeros(0, np.uint8)),
            position_m=Array(np.concatenate(places)),
            axes=Array(np.concatenate(axes)),
            intensity_rgb=Array(white),
            cone_cos=Array(np.tile(ALL_AROUND, (len(white), 1)).astype(float)),
            table=Array(np.concatenate(table)),
            tables=Array(np.array([photometry.table for photometry in photometries])),
        )


def opening_points(opening: LuminousOpening, counts: ArrayLike) -> tuple[FloatArray, FloatArray]:
    """Points (N, 2) of an opening along +X and +Y, in metres, and their shares (N,) of its area.

    Gauss's rule of `counts` (2,) points along length and width; in an ellipse of the larger count
    along its radius, by area, with four times as many around.
    """
    along, across = (np.polynomial.legendre.leggauss(int(n)) for n in np.asarray(counts))
    half = 0.5 * np.array([opening.length_m, opening.width_m])
    if not opening.is_round:
        x, y = np.meshgrid(along[0], across[0], indexing="ij")
        shares = 0.25 * np.outer(along[1], across[1]).ravel()
        return np.stack([x.ravel(), y.ravel()], axis=1) * half, shares
    nodes, weights = max(along, across, key=lambda rule: len(rule[0]))
    count = 4 * len(nodes)
    if len(nodes) == 1:
        return np.zeros((1, 2)), np.ones(1)
    around = (np.arange(count) + 0.5) * (2.0 * np.pi / count)
    radius = np.sqrt(0.5 * (nodes + 1.0))
    x, y = np.outer(radius, np.cos(around)), np.outer(radius, np.sin(around))
    shares = np.repeat(0.5 * weights / count, count)
    return np.stack([x.ravel(), y.ravel()], axis=1) * half, shares


def lamp_axes(aim: tuple[float, float, float], rotation_deg: float) -> FloatArray:
    """Axis, +X and +Y (3, 3) of a luminaire; see `LampPlacement`."""
    forward = np.asarray(aim, float) / np.linalg.norm(aim)
    across = np.array([1.0, 0.0, 0.0])
    if abs(forward[1]) < _UPRIGHT:
        across = np.cross(forward, [0.0, 1.0, 0.0])
        across /= np.linalg.norm(across)
    side = np.cross(across, forward)
    turn = np.radians(rotation_deg)
    turned = np.cos(turn) * across + np.sin(turn) * side
    return np.array([forward, turned, np.cross(turned, forward)])


def placed_luminaires(
    placements: Mapping[str, LampPlacement], scene_lamps: SceneLamps | None
) -> PlacedLuminaires:
    """Luminaires of placements by name, whose files are read, each once.

    Raises:
        UserError: a file cannot be read, its flux is 0 where lumens are given, the scene has no
            lamp of a name, or there are too many.
    """
    kinds: dict[tuple[str, str], Luminaire] = {}
    rows: list[tuple[int, FloatArray, FloatArray, float, float, str]] = []
    for name, placed in placements.items():
        key = placed.file, "" if placed.file else name
        found = None if placed.file else _of_scene(name, scene_lamps)
        if key not in kinds:
            kinds[key] = read_luminaire_file(placed.file) if found is None else found[0]
        luminaire, kind = kinds[key], list(kinds).index(key)
        flux = luminaire.flux_lm
        if placed.lumens is not None and not flux > 0.0:
            raise UserError(f"lamp {name}: its luminaire is dark: lumens cannot scale it")
        output = placed.dimming * (1.0 if placed.lumens is None else placed.lumens / flux)
        watts = placed.dimming * (luminaire.watts if placed.watts is None else placed.watts)
        group = placed.group or name
        if found is None:
            axes = lamp_axes(placed.aim, placed.rotation_deg)
            rows += [(kind, np.array(place), axes, output, watts, group) for place in placed.places]
        else:
            rows += [(kind, place, axes, output, watts, group) for place, axes in found[1]]
    if len(rows) > _MOST_LAMPS:
        raise UserError(f"{len(rows):,} lamps are placed: at most {_MOST_LAMPS:,} are computed")
    groups = tuple(dict.fromkeys(row[5] for row in rows))
    return PlacedLuminaires(
        kinds=tuple(kinds.values()),
        kind=np.array([row[0] for row in rows], np.int64),
        places_m=np.array([row[1] for row in rows], float),
        axes=np.array([row[2] for row in rows], float),
        output=np.array([row[3] for row in rows], float),
        watts=np.array([row[4] for row in rows], float),
        group=np.array([groups.index(row[5]) for row in rows], np.int64),
        groups=groups,
    )


def _of_scene(
    name: str, lamps: SceneLamps | None
) -> tuple[Luminaire, list[tuple[FloatArray, FloatArray]]]:
    """The first lamp of the scene with a name as a luminaire, and places and axes of all of them.

    Its intensity is that of its luminance: cone and table at every degree.
    """
    names = [] if lamps is None else lamps.names.values.tobytes().decode().split("\n")
    here = [number for number, other in enumerate(names) if other == name]
    if lamps is None or not here:
        told = ", ".join(sorted(set(names))[:8]) or "none"
        raise UserError(
            f"lamp {name} has no file, and the scene has no lamp of this name; it has {told}"
        )
    gamma, c = np.linspace(0.0, 180.0, _ROWS), np.linspace(0.0, 360.0, _COLUMNS)
    theta, phi = np.meshgrid(np.radians(gamma), np.radians(c), indexing="ij")
    local = np.stack(
        [np.cos(theta), np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi)], axis=-1
    )
    directions = local @ lamps.axes.values[here[0]]
    candela = luminance(lamps.intensity_towards(here[0], directions)) * LUMENS_PER_WATT
    opening = LuminousOpening(0.0, 0.0, 0.0, False)
    luminaire = Luminaire(gamma, c, np.asarray(candela, float), None, 0.0, opening)
    return luminaire, [(lamps.position_m.values[n], lamps.axes.values[n]) for n in here]


def read_lamps(path: str | Path) -> dict[str, LampPlacement]:
    """Placements of a CSV file, by their line: file,x,y,z[,dx,dy,dz[,rotation_deg[,group]]].

    Files of luminaires are relative to it. A heading may stand first, remarks begin with #.

    Raises:
        UserError: the file cannot be read, or a row is no lamp.
    """
    file = Path(path)
    text = read_text(file, "the lamps", _MOST_BYTES)
    reader = csv.reader(text.split("\n"))
    found: dict[str, LampPlacement] = {}
    for row in reader:
        cells = [cell.strip() for cell in row]
        if not any(cells) or cells[0].startswith("#") or cells[0].lower() == _HEADING[0]:
            continue
        found[f"line {reader.line_num}"] = _placement(file, reader.line_num, cells)
    if not found:
        raise UserError(f"{file} has no lamps: give rows {','.join(_HEADING)}")
    return found


def _placement(file: Path, line: int, cells: list[str]) -> LampPlacement:
    where = f"line {line} of {file}"
    if not _FEWEST_CELLS <= len(cells) <= len(_HEADING) or not cells[0]:
        raise UserError(f"{where} is no lamp: give {','.join(_HEADING)}, the last five if needed")
    named = dict(zip(_HEADING, cells, strict=False))
    try:
        x, y, z = (plain_float(named[name]) for name in ("x", "y", "z"))
        aim = [named.get(name, "") for name in ("dx", "dy", "dz")]
        dx, dy, dz = map(plain_float, aim) if any(aim) else (0.0, -1.0, 0.0)
        turn = plain_float(named.get("rotation_deg") or "0")
        return LampPlacement(
            file=str(file.parent / named["file"]), at=[x, y, z], aim=(dx, dy, dz),
            rotation_deg=turn, group=named.get("group") or "lamps",
        )  # fmt: skip
    except ValueError as error:
        raise UserError(f"{where} is no lamp: {error}") from None
