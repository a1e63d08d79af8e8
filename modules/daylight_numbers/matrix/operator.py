"""Daylight coefficients of sensors for cells of the sky and for patches: a matrix for all hours.

Daylight coefficients (Tregenza and Waters 1983). Two halves of the rays are kept apart: their
difference is the noise of both together.
"""

from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from light_transport.public import CancelCheck, SceneTransport, always
from scipy.sparse import csr_matrix, vstack

from daylight_numbers.glazing.glass import Glass
from daylight_numbers.matrix.measured_panes import Entries, MeasuredPanes, ends_in_columns, joined
from daylight_numbers.matrix.pane_bounces import PaneBounces
from daylight_numbers.matrix.sensor_rays import BODY, Ends, glazed, sampled_ends
from daylight_numbers.matrix.sensors import Sensors
from daylight_numbers.sky_cells import CELLS
from vrut_lite.errors import UserError
from vrut_lite.numeric_types import BoolArray, FloatArray

# Sensors of a block have one stream of random numbers, whoever computes it.
_BLOCK = 16
# Cells along an edge of the square at a tolerance of 1 %.
_CELLS = 60
_FEWEST_CELLS, _MOST_CELLS = 20, 240
# Share of the tolerance for edges of openings.
_EDGES_SHARE = 0.1
# Minimum share of rays that count; sensors with fewer lie inside bodies.
_LEAST_FREE = 0.4
# Offset of sensors in radii, so that rays do not meet the plane that a sensor lies on.
_OFF = 1e-5


@dataclass(frozen=True, eq=False)
class Half:
    """Shares by colour, of one half of the rays: three matrices, or one where all are alike.

    `seen`: (P, CELLS + 1), cosine-weighted solid angle in sr of cells of the sky and, last, of open
    ground; `sent`: (P, M), share of the hemisphere that each patch fills; `through`: (P, O),
    cosine-weighted solid angle in sr of the exiting patches of measured panes.
    """

    seen: tuple[csr_matrix, ...]
    sent: tuple[csr_matrix, ...]
    through: tuple[csr_matrix, ...]

    def irradiance(
        self, radiances: FloatArray, radiosity: FloatArray, of_panes: FloatArray | None = None
    ) -> FloatArray:
        """Irradiance (P, 3), W m^-2, by radiances (CELLS + 1, 3) and radiosities (M, 3), and by
        radiances of panes (O, 3)."""
        count = len(self.seen)
        found = np.stack(
            [
                self.seen[k % count] @ radiances[:, k] + self.sent[k % count] @ radiosity[:, k]
                for k in range(3)
            ],
            axis=1,
        )
        if of_panes is not None:
            found += self.by_panes(of_panes)
        return found

    def by_panes(self, of_panes: FloatArray) -> FloatArray:
        """Irradiance (P, 3) by radiances of panes (O, 3)."""
        count = len(self.through)
        return np.stack([self.through[k % count] @ of_panes[:, k] for k in range(3)], axis=1)


@dataclass(frozen=True, eq=False)
class Operator:
    """Both halves, the rays of each sensor on average, and the light of measured panes."""

    halves: tuple[Half, Half]
    rays: float
    bounces: PaneBounces | None = None

    @property
    def panes(self) -> MeasuredPanes | None:
        """The scene's measured panes."""
        return None if self.bounces is None else self.bounces.panes

    def irradiance(
        self, radiances: FloatArray, radiosity: FloatArray, of_suns: FloatArray | None = None
    ) -> tuple[FloatArray, FloatArray]:
        """Irradiance (P, 3) in W m^-2, and its standard error by the halves (P, 3).

        Args:
            radiances: (CELLS + 1, 3), of the sky's cells and of open ground.
            radiosity: (M, 3), of patches.
            of_suns: (O, 3), radiance of measured panes by the sun.
        """
        one, other = (
            half.irradiance(radiances, radiosity, self._of_panes(n, radiances, radiosity, of_suns))
            for n, half in enumerate(self.halves)
        )
        return 0.5 * (one + other), 0.5 * np.abs(one - other)

    def _of_panes(
        self, half: int, radiances: FloatArray, radiosity: FloatArray, of_suns: FloatArray | None
    ) -> FloatArray | None:
        """Radiance of panes (O, 3) by one half of their rays."""
        if self.panes is None:
            return None
        found = self.panes.radiances(half, radiances, radiosity)
        return found if of_suns is None else found + of_suns

    def some(self, chosen: BoolArray) -> "Operator":
        """That of some of its sensors."""
        one, other = (
            Half(*(tuple(m[chosen] for m in part) for part in (half.seen, half.sent, half.through)))
            for half in self.halves
        )
        return Operator((one, other), self.rays, self.bounces)


def operator_of(
    transport: SceneTransport,
    glass: Glass,
    sensors: Sensors,
    tolerance: float,
    threads: int = 1,
    go_on: CancelCheck = always,
    bounces: PaneBounces | None = None,
) -> Operator:
    """The matrix of sensors in a scene whose rays are traced.

    Args:
        transport: the scene and its patches.
        glass: `glass_of` the scene.
        sensors: where light is measured.
        tolerance: share of a sensor's light by which rays may err.
        threads: number of threads; the result does not depend on it.
        go_on: called between blocks.
        bounces: light of measured panes.

    Raises:
        UserError: a sensor lies inside a wall or another body.
        GivenUp: by `go_on`.
    """
    assert transport.patches is not None
    panes = None if bounces is None else bounces.panes
    traced = glazed(transport, glass) if panes is None else panes.opened
    places = transport.in_radii(sensors.places_m) + _OFF * sensors.normals
    cells = int(np.clip(_CELLS * np.sqrt(0.01 / tolerance), _FEWEST_CELLS, _MOST_CELLS))
    patches = len(transport.patches.area)
    exiting = 0 if panes is None else panes.exiting

    def matrices(ends: Ends, places: FloatArray) -> _Block:
        parts: list[Entries] = []
        if panes is not None:
            # Rays were cast as if panes were openings, to find their edges.
            ends, parts = panes.seen_along(ends, places)
        for which in range(2):
            column, weight = ends_in_columns(transport, ends.target[:, which], ends.direction)
            value = (ends.area * weight)[:, None] * ends.share[:, which]
            parts.append(Entries(ends.sensor, column, value))
        rows, columns, values = joined(parts)
        count = len(places)
        free = np.bincount(ends.sensor, ends.area * (ends.target[:, 0] != BODY), count)
        values = np.asarray(values / np.maximum(free, 1e-9)[rows, None], np.float64)
        shape = (count, CELLS + 1 + patches + exiting)
        colours = tuple(csr_matrix((values[:, k], (rows, columns)), shape) for k in range(3))
        return _Block(colours, np.asarray(free, float), len(ends.sensor))

    def block(first: int) -> tuple[_Block, _Block]:
        go_on()
        here = slice(first, min(first + _BLOCK, len(sensors)))
        one, other = sampled_ends(
            traced,
            places[here],
            sensors.normals[here],
            cells,
            _EDGES_SHARE * tolerance,
            np.random.Generator(np.random.Philox(key=first)),
        )
        return matrices(one, places[here]), matrices(other, places[here])

    with ThreadPoolExecutor(threads) as pool:
        blocks = list(pool.map(block, range(0, len(sensors), _BLOCK)))
    _refuse_buried(sensors, np.concatenate([one.free for one, _ in blocks]))
    rays = sum(half.rays for pair in blocks for half in pair) / max(len(sensors), 1)
    one, other = (_half([pair[which] for pair in blocks], patches) for which in range(2))
    return Operator((one, other), rays, bounces)


class _Block(NamedTuple):
    """Matrices of some sensors by colour, the share of their rays that counts, and the number."""

    colours: tuple[csr_matrix, ...]
    free: FloatArray
    rays: int


def _refuse_buried(sensors: Sensors, free: FloatArray) -> None:
    buried = np.flatnonzero(free < _LEAST_FREE)
    if len(buried):
        x, y, z = sensors.places_m[buried[0]]
        raise UserError(
            f"{len(buried)} of {len(sensors)} sensors lie inside walls or other bodies, the first "
            f"at {x:.3f}, {y:.3f}, {z:.3f} m: move them into the open"
        )


def _half(blocks: list[_Block], patches: int) -> Half:
    colours = [vstack([block.colours[k] for block in blocks], format="csr") for k in range(3)]
    if all(np.array_equal(colours[0].data, colour.data) for colour in colours[1:]):
        colours = colours[:1]
    first = CELLS + 1 + patches
    return Half(
        tuple(colour[:, : CELLS + 1].tocsr() for colour in colours),
        tuple(colour[:, CELLS + 1 : first].tocsr() for colour in colours),
        tuple(colour[:, first:].tocsr() for colour in colours),
    )
