"""The sky as a table by the sun's height, and its values in any direction.

A sky that the sun alone lights depends on the sun's height and on directions relative to it. Each
height has a layer. Its columns are the azimuth from the sun's, pi u^2 for u in [0, 1]; its rows run
from the horizon to the zenith, with more of them beside the horizon and beside the sun:

* the first `LOWER` rows from the horizon to the sun: s (1 - cos(pi t)) / 2 for t in [0, 1];
* the others from the sun to the zenith: s + (pi / 2 - s) t^2,

where s is the sun's apparent height, at least 0. So the glow around the sun moves with it between
layers. Values are shares of the layer's level, which is interpolated by its logarithm: light falls
by a factor of a million in dusk. The twin is `page/src/sky.js`.
"""

from dataclasses import dataclass

import numpy as np

from share.shared_scene import SunSky, direction_of
from vrut_lite.errors import UserError
from vrut_lite.geometry.cube_map import reduce_cube, sample_cube, texel_directions
from vrut_lite.geometry.spherical_harmonics import horizontal_irradiance
from vrut_lite.numeric_types import Float32Array, FloatArray

COLUMNS, LOWER, UPPER = 48, 16, 32
# Share of the sun's irradiance in the level: rooms are lit by sunlit ground too.
SUN_SHARE = 0.15
# The check of another hour's sky: a cube's edge, the sine of the lowest height, and the mean
# difference as a share of the mean.
_CHECKED_EDGE, _CHECKED_ABOVE, _MOST_OFF = 16, 0.1, 0.05
# Smallest level (W m^-2): its logarithm must exist.
_LEAST = 1e-12


@dataclass(frozen=True, eq=False)
class SkyTable:
    """Skies by the sun's height; linear sRGB.

    Attributes:
        true_rad, apparent_rad: (H,) heights of the sun, rising, without and with refraction.
        level_rgb: (H, 3), irradiance in W m^-2 by which the others are divided.
        radiance: (H, LOWER + UPPER, COLUMNS, 3) float16, sr^-1.
        key: (H, 3), irradiance of the sun on a plane that faces it.
        ground: (H, 3), radiance of open ground, sr^-1.
        albedo_rgb: (H, 3), of open ground, as it is.
    """

    true_rad: FloatArray
    apparent_rad: FloatArray
    level_rgb: FloatArray
    radiance: np.ndarray
    key: FloatArray
    ground: FloatArray
    albedo_rgb: FloatArray

    def place(self, true_rad: float) -> tuple[int, float]:
        """Layer below a height of the sun, and the share of the next one."""
        at = np.interp(true_rad, self.true_rad, np.arange(len(self.true_rad)))
        layer = min(int(at), len(self.true_rad) - 2)
        return layer, float(at - layer)

    def level(self, true_rad: float) -> FloatArray:
        """Level (3,) at a height of the sun, W m^-2; below the lowest layer it falls on."""
        layer, share = self.place(true_rad)
        low, high = np.log(self.level_rgb[layer : layer + 2])
        return np.asarray(np.exp((1.0 - share) * low + share * high))

    def mixed(self, values: FloatArray, true_rad: float) -> FloatArray:
        """Shares (H, 3) of the level at a height of the sun, times the level."""
        layer, share = self.place(true_rad)
        mixed = (1.0 - share) * values[layer] + share * values[layer + 1]
        return np.asarray(mixed * self.level(true_rad))

    def sky(self, direction: FloatArray, true_rad: float, azimuth_rad: float) -> FloatArray:
        """Radiance (n, 3) of the sky in unit directions (n, 3) above the horizon."""
        layer, share = self.place(true_rad)
        sun = max(float(np.interp(true_rad, self.true_rad, self.apparent_rad)), 0.0)
        row, column = _coordinates(direction, sun, azimuth_rad)
        found = np.zeros((len(direction), 3))
        for part, weight in ((layer, 1.0 - share), (layer + 1, share)):
            found += weight * _between(self.radiance[part].astype(float), row, column)
        return found * self.level(true_rad)

    def cube(self, size: int, true_rad: float, azimuth_rad: float) -> Float32Array:
        """A cube map (6, size, size, 3) of sky and ground."""
        directions = texel_directions(size).reshape(-1, 3)
        above = directions[:, 1] > 0.0
        cube = np.empty((len(directions), 3), np.float32)
        cube[above] = self.sky(directions[above], true_rad, azimuth_rad)
        cube[~above] = self.mixed(self.ground, true_rad)
        return cube.reshape(6, size, size, 3)


def sky_table(skies: list[SunSky]) -> SkyTable:
    """The table of skies that the sun alone lights, by rising height."""
    levels = [
        np.maximum(horizontal_irradiance(sky.cube) + SUN_SHARE * sky.key_rgb, _LEAST)
        for sky in skies
    ]
    radiance = np.stack(
        [
            _sampled(sky, table_directions(max(sky.apparent_rad, 0.0), sky.azimuth_rad)) / level
            for sky, level in zip(skies, levels, strict=True)
        ]
    )
    level = np.stack(levels)
    return SkyTable(
        true_rad=np.array([sky.true_rad for sky in skies]),
        apparent_rad=np.array([sky.apparent_rad for sky in skies]),
        level_rgb=level,
        radiance=radiance.astype(np.float16),
        key=np.stack([sky.key_rgb for sky in skies]) / level,
        ground=np.stack([sky.ground_rgb for sky in skies]) / level,
        albedo_rgb=np.stack([sky.albedo_rgb for sky in skies]),
    )


def check_sky(table: SkyTable, sky: SunSky) -> None:
    """Check that a sky of another hour is that of the table.

    Raises:
        UserError: it depends on more than the sun's height, as weather and photographs do.
    """
    made = table.cube(_CHECKED_EDGE, sky.true_rad, sky.azimuth_rad)
    true = reduce_cube(sky.cube, _CHECKED_EDGE)
    above = texel_directions(_CHECKED_EDGE)[..., 1] > _CHECKED_ABOVE
    off = np.abs(made[above] - true[above]).mean() / max(float(true[above].mean()), 1e-30)
    if off > _MOST_OFF:
        raise UserError(
            "a page needs a sky that depends on the sun's height alone, and this one changes with "
            "the hour: choose another by --sky, or leave weather and photographs out"
        )


def table_directions(sun_rad: float, sun_azimuth_rad: float) -> FloatArray:
    """Unit directions (rows, columns, 3) of nodes for a sun's height, at least 0, and azimuth."""
    turned = sun_azimuth_rad + np.pi * np.linspace(0.0, 1.0, COLUMNS) ** 2
    lower = 0.5 - 0.5 * np.cos(np.pi * np.linspace(0.0, 1.0, LOWER))
    upper = np.linspace(0.0, 1.0, UPPER) ** 2
    height = np.concatenate([sun_rad * lower, sun_rad + (0.5 * np.pi - sun_rad) * upper])
    level = np.cos(height)[:, None]
    return np.stack(
        np.broadcast_arrays(
            level * np.sin(turned), np.sin(height)[:, None], -level * np.cos(turned)
        ),
        axis=-1,
    )


def _sampled(sky: SunSky, directions: FloatArray) -> FloatArray:
    """Radiance at directions, kept a texel above the ground in the cube's lower half."""
    size = sky.cube.shape[1]
    lifted = directions.copy()
    lifted[..., 1] = np.maximum(lifted[..., 1], 1.0 / size)
    lifted /= np.linalg.norm(lifted, axis=-1, keepdims=True)
    return np.asarray(sample_cube(sky.cube, lifted.reshape(-1, 3)).reshape(directions.shape))


def _coordinates(
    direction: FloatArray, sun_rad: float, azimuth_rad: float
) -> tuple[FloatArray, FloatArray]:
    """Row and column (n,) of directions (n, 3) for a sun's height, at least 0, and azimuth."""
    height = np.arcsin(np.clip(direction[:, 1], 0.0, 1.0))
    x, _, z = direction_of(azimuth_rad, 0.0)
    level = np.maximum(np.hypot(direction[:, 0], direction[:, 2]), 1e-12)
    cosine = (direction[:, 0] * x + direction[:, 2] * z) / level
    column = np.sqrt(np.arccos(np.clip(cosine, -1.0, 1.0)) / np.pi) * (COLUMNS - 1)
    share = np.clip(height / max(sun_rad, 1e-9), 0.0, 1.0)
    low = np.arccos(1.0 - 2.0 * share) / np.pi * (LOWER - 1)
    rest = np.clip((height - sun_rad) / max(0.5 * np.pi - sun_rad, 1e-9), 0.0, 1.0)
    high = LOWER + np.sqrt(rest) * (UPPER - 1)
    return np.where(height < sun_rad, low, high), column


def _between(values: FloatArray, row: FloatArray, column: FloatArray) -> FloatArray:
    """Values (n, 3) of a layer (rows, columns, 3), bilinear."""
    r = np.minimum(row.astype(int), values.shape[0] - 2)
    c = np.minimum(column.astype(int), values.shape[1] - 2)
    v, u = (row - r)[:, None], (column - c)[:, None]
    near = (1.0 - u) * values[r, c] + u * values[r, c + 1]
    far = (1.0 - u) * values[r + 1, c] + u * values[r + 1, c + 1]
    return np.asarray((1.0 - v) * near + v * far)
