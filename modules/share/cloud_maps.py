"""Clouds that stand still while the sun moves, as maps of the upper hemisphere.

The sky in direction d under a sun at p is kept(d) clear(d, p) + C(d, p):

* `kept`, the share of the clear sky's light that is left: that of the air before the clouds, and
  what passes them;
* C, the light that clouds send. Near the sun it is sunlight bent by a few degrees, E B(d) P(a) for
  a sun of irradiance E at an angle a: droplets' light that leaves along the sun's own way, where
  B = -T^0.7 ln T has its peak in thin edges. The rest changes slowly: principal components by the
  sun's places.

The components are coarse. What they lack at the clouds' edges is `finer`, the ratio of the opacity
in a direction to that of the coarse map. Sun, moon and stars are dimmed by T, the transmittance.

Maps are squares of an unfolded half octahedron: with p = (x, z) / (|x| + y + |z|), columns run
along p.x + p.z and rows along p.x - p.z, both from -1 to 1; the horizon is their border. The twin
is `page/src/clouds.js`.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import median_filter, uniform_filter

from share.components import principal
from share.sun_places import SunPlaces
from vrut_lite.numeric_types import Float32Array, FloatArray

# Nodes of an edge of the maps: 0.75 degrees apart in the mean, and 1.5 for the components.
FINE, COARSE = 192, 96
COMPONENTS = 16
# Exponent of the transmittance in B. The glow's own way through a cloud dims it less than the
# sun's: with 1 thin edges lacked a quarter of it, with 0.5 opaque ones had too much.
GLOW_POWER = 0.7
# Largest angle (rad) of P, whose nodes are even in the root of the angle.
GLOW_RAD, GLOW_NODES = float(np.radians(36.0)), 20
# Largest ratio of `finer`, and the opacity that is added to both its sides: 1 without clouds.
MOST_FINER, _LEAST_OPACITY = 4.0, 0.05
PASSED_CODES = 65535.0
# Transmittance below which a sun behind clouds lights nothing.
_LEAST_PASSED = 1e-4
# Half the angle (rad) between the page's rays that sum the open sky's light.
_WIDE_RAD = float(np.radians(2.9))
# Angle (rad) around the sun beyond which light is its slow part. Within it light has the range of
# that share of the others' nodes, and the median of so many nodes along and across: what the glow
# leaves of a sunlit edge would else stay at that place as a pale square.
_BESIDE_RAD, _IN_RANGE, _EVEN = float(np.radians(15.0)), 0.995, 5
# Step of the components' values, as a share of the rms of the strongest.
_STEP = 1.0 / 256.0
_RINGS = 12
# Nodes of the fine map in the width of a coarse one's.
_AROUND = 3


@dataclass(frozen=True, eq=False)
class CloudMaps:
    """Frozen clouds; radiance is a share of the sky table's level, sr^-1.

    Attributes:
        places: places (N) of the sun at which C is known.
        passed: (FINE, FINE) uint16, 65535 times the root of the transmittance T.
        kept, finer: (FINE, FINE) uint8, 255 times the share, and 255 times ratio / `MOST_FINER`.
        terms: (COMPONENTS, COARSE, COARSE) int16, whole steps of the components.
        by_sun: (N, COMPONENTS, 3) float32, radiance of a step.
        by_night: (COMPONENTS, 3) float32, W m^-2 sr^-1 of a step in a moonless night.
        glow: (2, GLOW_NODES, 3) float32, P in sr^-1, and its mean over wide rays.
    """

    places: SunPlaces
    passed: NDArray[np.uint16]
    kept: NDArray[np.uint8]
    finer: NDArray[np.uint8]
    terms: NDArray[np.int16]
    by_sun: Float32Array
    by_night: Float32Array
    glow: Float32Array

    @property
    def any_sun(self) -> bool:
        """Whether sunlight passes anywhere: under a closed layer nothing of it is computed."""
        return bool(self.transmittances.max() > _LEAST_PASSED)

    @property
    def transmittances(self) -> FloatArray:
        """T (FINE, FINE)."""
        return np.asarray((self.passed / PASSED_CODES) ** 2)

    def transmittance(self, direction: FloatArray) -> FloatArray:
        """T (n,) in unit directions (n, 3) not below the horizon."""
        return sampled(self.transmittances[..., None], direction)[:, 0]

    def coefficients(self, true_rad: float, north_rad: float) -> FloatArray:
        """Coefficients (COMPONENTS, 3) of a sun by its elevation and azimuth from north."""
        pairs = self.places.weights(true_rad, north_rad)
        return np.asarray(sum(weight * self.by_sun[place] for place, weight in pairs), float)

    def sky(
        self,
        direction: FloatArray,
        clear: FloatArray,
        coefficients: FloatArray | Float32Array,
        suns: list[tuple[FloatArray, FloatArray]],
    ) -> FloatArray:
        """Radiance (n, 3) in directions (n, 3) above the horizon.

        `clear` (n, 3) is that without clouds; `suns` are directions (3,) and irradiances (3,) of
        bodies in a clear sky.
        """
        coarse = np.einsum("khw,kc->hwc", self.terms.astype(float), coefficients)
        finer = sampled(self.finer[..., None] * (MOST_FINER / 255.0), direction)
        kept = sampled(self.kept[..., None] / 255.0, direction)
        found = clear * kept + finer * sampled(coarse, direction)
        bends = bending(self.transmittance(direction))[:, None]
        for towards, irradiance in suns:
            angle = np.arccos(np.clip(direction @ towards, -1.0, 1.0))
            found = found + bends * glow_at(self.glow[0], angle) * irradiance
        return np.maximum(found, 0.0)


def map_directions(edge: int) -> FloatArray:
    """Unit directions (edge, edge, 3) of a map's nodes, those of the horizon a little above it."""
    along = np.linspace(-1.0, 1.0, edge)
    u, v = np.meshgrid(along, along)
    x, z = 0.5 * (u + v), 0.5 * (u - v)
    found = np.stack([x, np.maximum(1.0 - np.abs(x) - np.abs(z), 0.5 / edge), z], axis=-1)
    return np.asarray(found / np.linalg.norm(found, axis=-1, keepdims=True))


def sampled(values: NDArray[np.floating], direction: FloatArray) -> FloatArray:
    """Values (n, C) of a map (edge, edge, C) in unit directions (n, 3), bilinear."""
    edge = len(values)
    x, y, z = direction.T
    length = np.abs(x) + np.maximum(y, 0.0) + np.abs(z)
    column = (0.5 + 0.5 * np.clip((x + z) / length, -1.0, 1.0)) * (edge - 1)
    row = (0.5 + 0.5 * np.clip((x - z) / length, -1.0, 1.0)) * (edge - 1)
    i, k = (np.minimum(part.astype(int), edge - 2) for part in (row, column))
    v, u = (row - i)[:, None], (column - k)[:, None]
    low = (1.0 - u) * values[i, k] + u * values[i, k + 1]
    high = (1.0 - u) * values[i + 1, k] + u * values[i + 1, k + 1]
    return np.asarray((1.0 - v) * low + v * high, float)


def bending(passed: FloatArray) -> FloatArray:
    """B by the transmittance, at most 0.53."""
    held = np.clip(passed, 1e-9, 1.0)
    return np.asarray(-(held**GLOW_POWER) * np.log(held))


def glow_at(nodes: NDArray[np.floating], angle: FloatArray) -> FloatArray:
    """P (..., 3) of nodes (GLOW_NODES, 3) at angles (...,) from the sun."""
    at = np.sqrt(np.clip(angle / GLOW_RAD, 0.0, 1.0)) * (GLOW_NODES - 1)
    node = np.minimum(at.astype(int), GLOW_NODES - 2)
    share = (at - node)[..., None]
    return np.asarray((1.0 - share) * nodes[node] + share * nodes[node + 1])


@dataclass(frozen=True, eq=False)
class CloudSamples:
    """Light that clouds send under suns (S) in directions (n, 3), as shares of levels.

    `light` (S, n, 3), `suns` (S, 3) towards them, and `key` (S, 3) their irradiance behind the
    clear air; `by_night` (n, 3) in W m^-2 sr^-1.
    """

    direction: FloatArray
    suns: FloatArray
    key: FloatArray
    light: FloatArray
    by_night: FloatArray


def cloud_maps(
    places: SunPlaces, seen: CloudSamples, fine_passed: FloatArray, fine_kept: FloatArray
) -> CloudMaps:
    """Maps of clouds seen at the nodes of the coarse map, with T and `kept` (FINE, FINE).

    Each node of the coarse map stands for as much as a texel of the cubes that it was seen in.
    """
    around = np.stack([fine_passed, bending(fine_passed)], axis=-1)
    around = uniform_filter(around, (_AROUND, _AROUND, 1), mode="nearest")
    passed, bends = sampled(around, seen.direction).T[:, :, None]
    glow = _glow(seen, bends)
    slow = np.empty(seen.light.shape)
    for number, (sun, key, light) in enumerate(zip(seen.suns, seen.key, seen.light, strict=True)):
        angle = np.arccos(np.clip(seen.direction @ sun, -1.0, 1.0))
        rest = light - bends * glow_at(glow, angle) * key
        beside = angle < _BESIDE_RAD
        low, high = np.quantile(rest[~beside], [1.0 - _IN_RANGE, _IN_RANGE], axis=0)
        rest = np.clip(rest, low, high)
        even = median_filter(rest.reshape(COARSE, COARSE, 3), (_EVEN, _EVEN, 1), mode="nearest")
        slow[number] = np.where(beside[:, None], even.reshape(-1, 3), rest)
    columns = slow.transpose(1, 0, 2).reshape(len(seen.direction), -1)
    own = principal((columns.T @ columns).astype(np.float32), COMPONENTS)
    own = np.pad(own, ((0, 0), (0, COMPONENTS - own.shape[1])))
    values = columns @ own
    step = max(_STEP * float(np.sqrt(np.square(values[:, 0]).mean())), 1e-30)
    step = max(step, float(np.abs(values).max()) / 32000.0)
    terms = np.rint(values / step).astype(np.int16)
    # Coefficients of the rounded terms, by least squares.
    light = np.concatenate([columns, seen.by_night], axis=1)
    solved = np.linalg.lstsq(terms.astype(float), light, rcond=1e-9)[0]
    by_sun = solved[:, :-3].reshape(COMPONENTS, -1, 3).transpose(1, 0, 2)
    opacity = 1.0 - fine_passed
    directions = map_directions(FINE).reshape(-1, 3)
    coarse = sampled(1.0 - passed.reshape(COARSE, COARSE, 1), directions)
    finer = (opacity + _LEAST_OPACITY) / (coarse.reshape(FINE, FINE) + _LEAST_OPACITY)
    return CloudMaps(
        places=places,
        passed=np.rint(PASSED_CODES * np.sqrt(np.clip(fine_passed, 0.0, 1.0))).astype(np.uint16),
        kept=np.rint(255.0 * np.clip(fine_kept, 0.0, 1.0)).astype(np.uint8),
        finer=np.rint(255.0 * np.clip(finer / MOST_FINER, 0.0, 1.0)).astype(np.uint8),
        terms=np.ascontiguousarray(terms.T).reshape(COMPONENTS, COARSE, COARSE),
        by_sun=by_sun.astype(np.float32),
        by_night=solved[:, -3:].astype(np.float32),
        glow=np.stack([glow, _widened(glow)]).astype(np.float32),
    )


def _glow(seen: CloudSamples, bends: FloatArray) -> FloatArray:
    """P (GLOW_NODES, 3) by B (n, 1), in least squares beside a part that is even in all directions.

    It ends at 0: light from farther away is in the components.
    """
    count = 2 * GLOW_NODES
    gram, right = np.zeros((3, count, count)), np.zeros((3, count))
    for sun, key, light in zip(seen.suns, seen.key, seen.light, strict=True):
        if not key[1] > 0.0:
            continue
        angle = np.arccos(np.clip(seen.direction @ sun, -1.0, 1.0))
        near = angle < GLOW_RAD
        at = np.sqrt(angle[near] / GLOW_RAD) * (GLOW_NODES - 1)
        node = np.minimum(at.astype(int), GLOW_NODES - 2)
        hats = np.zeros((len(node), GLOW_NODES))
        hats[np.arange(len(node)), node] = 1.0 - at + node
        hats[np.arange(len(node)), node + 1] = at - node
        both = np.concatenate([bends[near] * hats, hats], axis=1)
        squares, products = both.T @ both, both.T @ light[near]
        for c in range(3):
            gram[c] += key[c] ** 2 * squares
            right[c] += key[c] * products[:, c]
    found = np.zeros((GLOW_NODES, 3))
    for c in range(3):
        # Nodes beside the sun have few directions.
        ridge = np.diag(1e-4 * np.diag(gram[c]) + 1e-30)
        found[:, c] = np.linalg.solve(gram[c] + ridge, right[c])[:GLOW_NODES]
    return np.maximum(found - found[-1:], 0.0)


def _widened(glow: FloatArray) -> FloatArray:
    """The mean of P over discs of `_WIDE_RAD` around its nodes."""
    angle = GLOW_RAD * np.linspace(0.0, 1.0, GLOW_NODES) ** 2
    ring = np.sqrt((np.arange(_RINGS) + 0.5) / _RINGS) * _WIDE_RAD
    turn = (np.arange(_RINGS) + 0.5) / _RINGS * np.pi
    r, a = (part.ravel() for part in np.meshgrid(ring, turn))
    beside = np.hypot(angle[:, None] + r * np.cos(a), r * np.sin(a))
    return np.asarray(glow_at(glow, beside).mean(axis=1))
