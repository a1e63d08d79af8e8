"""What the terrain is at any place: its height in detail, and the albedo of what grows there."""

import numpy as np
from numpy.typing import ArrayLike

from vrut_lite.numeric_types import FloatArray
from vrut_lite_lab.scenes.landscape import landscape, rim_share, sample, smooth_step
from vrut_lite_lab.scenes.noise import fractal_noise, gradient_noise, ridged_noise

PLANET_M = 6.36e6
# Linear sRGB albedo. The bare ground is the sky's own, so that the rim meets it unseen.
BARE = (0.1, 0.1, 0.1)
MEADOW, PASTURE, HEATH = (0.078, 0.112, 0.038), (0.09, 0.105, 0.045), (0.12, 0.108, 0.06)
FOREST = (0.022, 0.036, 0.016)
ROCK, DARK_ROCK, SCREE, SNOW = (
    (0.165, 0.16, 0.152),
    (0.095, 0.093, 0.092),
    (0.2, 0.192, 0.178),
    (0.63, 0.64, 0.65),
)


def relief_m(x_m: ArrayLike, z_m: ArrayLike) -> FloatArray:
    """Height (...,) above the planet's round surface."""
    x, z = np.asarray(x_m, dtype=float), np.asarray(z_m, dtype=float)
    bend = [46.0 * fractal_noise(x / 520.0, z / 520.0, seed, 2) for seed in (91, 93)]
    height = sample(landscape().height_m, x + bend[0], z + bend[1])
    height = height + rim_share(x, z) * _detail_m(x, z, height)
    return height * rim_share(x, z, 900.0)


def curvature_m(x_m: ArrayLike, z_m: ArrayLike) -> FloatArray:
    """How far (...,) the planet's surface has fallen below y = 0: R - sqrt(R^2 - d^2), factored."""
    squared = np.asarray(x_m, dtype=float) ** 2 + np.asarray(z_m, dtype=float) ** 2
    return np.asarray(squared / (PLANET_M + np.sqrt(PLANET_M**2 - squared)))


def height_m(x_m: ArrayLike, z_m: ArrayLike) -> FloatArray:
    """World y (...,): the land lies on the planet, a ball that touches y = 0 at the origin."""
    return relief_m(x_m, z_m) - curvature_m(x_m, z_m)


def slope(x_m: ArrayLike, z_m: ArrayLike, apart_m: ArrayLike) -> FloatArray:
    """Rise over run (..., 2) to the east and south, between places so far apart."""
    x, z, step = (np.asarray(part, dtype=float) for part in (x_m, z_m, apart_m))
    east = height_m(x + 0.5 * step, z) - height_m(x - 0.5 * step, z)
    south = height_m(x, z + 0.5 * step) - height_m(x, z - 0.5 * step)
    return np.stack([east / step, south / step], axis=-1)


def _detail_m(x: FloatArray, z: FloatArray, high: FloatArray) -> FloatArray:
    """Ribs and gullies in the steep, hummocks on the meadows: what is finer than the grid."""
    steep = _steepness(x, z)
    ribs = ridged_noise(x / 230.0, z / 230.0, 21, 5, 0.48) - 0.75
    hummocks = fractal_noise(x / 60.0, z / 60.0, 31, 5, 0.42)
    crags = 22.0 + 38.0 * smooth_step((high - 800.0) / 900.0)
    return np.asarray(crags * steep * steep * ribs + (0.9 + 1.2 * steep) * hummocks)


_SLOPES: list[FloatArray] = []


def _steepness(x: FloatArray, z: FloatArray) -> FloatArray:
    """0 (...,) on a plain, 1 on a mountain's side."""
    if not _SLOPES:
        rows, columns = np.gradient(landscape().height_m, 40.0)
        _SLOPES.append(np.clip((np.sqrt(rows * rows + columns * columns) - 0.1) / 0.6, 0.0, 1.2))
    return sample(_SLOPES[0], x, z)


def albedo(x_m: ArrayLike, z_m: ArrayLike, slope_xz: ArrayLike) -> FloatArray:
    """Linear sRGB (..., 3) by height, steepness, the side on which the sun falls, and chance."""
    x, z, s = (np.asarray(part, dtype=float) for part in (x_m, z_m, slope_xz))
    high, steep = relief_m(x, z), np.sqrt(s[..., 0] ** 2 + s[..., 1] ** 2)
    patch = fractal_noise(x / 1100.0, z / 1100.0, 51, 4)
    grain = fractal_noise(x / 90.0, z / 90.0, 57, 4, 0.6)
    colour = _grassland(high, patch, grain)
    colour = _mixed(colour, _toned(FOREST, 0.35 * grain), forest_share(x, z, steep))
    scree = smooth_step((high - 1280.0 + 260.0 * patch + 110.0 * grain) / 300.0)
    colour = _mixed(colour, _toned(SCREE, 0.15 * grain), scree)
    # Cliffs are bare; low ones only where nothing can root.
    bare = 1.2 - 0.5 * smooth_step((high - 600.0) / 900.0)
    stone = _mixed(DARK_ROCK, ROCK, smooth_step(0.5 + 0.6 * grain + 0.5 * patch))
    colour = _mixed(colour, stone, smooth_step((steep - bare + 0.14 * grain) / 0.16))
    colour = _mixed(
        colour, _toned(SNOW, 0.02 * grain), _snow_share(high, steep, s[..., 1], patch, grain)
    )
    return np.clip(_mixed(BARE, colour, rim_share(x, z)), 0.01, 0.83)


def forest_share(x_m: FloatArray, z_m: FloatArray, steep: FloatArray) -> FloatArray:
    """0 to 1 (...,): woods on slopes below the tree line, with clearings."""
    patch = fractal_noise(x_m / 1100.0, z_m / 1100.0, 51, 4)
    edge = gradient_noise(x_m / 130.0, z_m / 130.0, 61) + 0.5 * gradient_noise(
        x_m / 50.0, z_m / 50.0, 63
    )
    high = relief_m(x_m, z_m)
    wooded = smooth_step((steep - 0.3 + 0.3 * patch + 0.14 * edge) / 0.09)
    return np.asarray(wooded * smooth_step((1190.0 + 280.0 * patch + 70.0 * edge - high) / 130.0))


def _grassland(high: FloatArray, patch: FloatArray, grain: FloatArray) -> FloatArray:
    """Mown meadows in the valleys, pastures above, brown and short in the heights."""
    colour = _mixed(MEADOW, PASTURE, smooth_step((high - 150.0 + 300.0 * patch) / 600.0))
    colour = _mixed(colour, HEATH, smooth_step((high - 900.0 + 300.0 * patch) / 700.0))
    return np.asarray(colour * (1.0 + 0.2 * grain + 0.15 * patch)[..., None])


def _snow_share(
    high: FloatArray, steep: FloatArray, to_south: FloatArray, patch: FloatArray, grain: FloatArray
) -> FloatArray:
    """0 to 1 (...,): above a line that lies lower on slopes to the north, not on cliffs."""
    north = np.clip(to_south, -1.0, 1.0)
    line_m = 1560.0 - 260.0 * north + 200.0 * patch + 130.0 * grain
    holds = smooth_step((1.0 - steep + 0.3 * grain) / 0.22)
    return np.asarray(smooth_step((high - line_m) / 170.0) * holds)


def _toned(colour: tuple[float, float, float], change: FloatArray) -> FloatArray:
    return np.asarray(colour) * (1.0 + change)[..., None]


def _mixed(first: ArrayLike, second: ArrayLike, share: FloatArray) -> FloatArray:
    one, other = np.asarray(first, dtype=float), np.asarray(second, dtype=float)
    return np.asarray(one + (other - one) * share[..., None])
