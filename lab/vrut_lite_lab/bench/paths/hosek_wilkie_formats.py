"""The formats of Hosek-Wilkie cube maps that are compared, and the exact formula."""

from collections.abc import Callable
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np
from dynamic_skylight import HosekWilkieSky
from dynamic_skylight.hosek_wilkie.formula import HORIZON_OFFSET
from dynamic_skylight.hosek_wilkie.sky import half_scale
from numpy.typing import NDArray

from vrut_lite.geometry.cube_map import (
    FACE_NORMALS,
    FACE_S_AXES,
    FACE_T_AXES,
    texel_centres,
    texel_directions,
)
from vrut_lite.geometry.frames import direction_from_angles, world_from_enu
from vrut_lite.numeric_types import FloatArray

Run = Callable[[], Any]
# The hour whose cube maps are timed.
SKY = HosekWilkieSky(turbidity=3.0, albedo=0.1, sun_elevation_rad=np.radians(45.0))
AZIMUTH_RAD = 0.3
EXPOSURE = 0.05
# Of larger maps about this many texels an edge are compared.
_JUDGED = 64


def sun_of(sky: HosekWilkieSky) -> FloatArray:
    """Direction (3,) to the sun, world axes."""
    return world_from_enu(direction_from_angles(AZIMUTH_RAD, sky.sun_elevation_rad))


SUN = sun_of(SKY)


def sky_directions(size: int) -> FloatArray:
    """Unit directions (n, 3) of the texels above the horizon."""
    directions = texel_directions(size)
    return directions[directions[..., 1] > 0.0]


def formula(
    sky: HosekWilkieSky, cos_theta: NDArray[Any], cos_gamma: NDArray[Any], gamma: NDArray[Any]
) -> NDArray[Any]:
    """The formula (n, 3) as one writes it in numpy, in the precision of its arguments."""
    out = np.empty((*cos_theta.shape, 3), cos_theta.dtype)
    root = np.sqrt(cos_theta)
    for channel in range(3):
        numbers = sky.rgb_distribution[channel].astype(cos_theta.dtype)
        A, B, C, D, E, F, G, H, I = numbers  # noqa: E741 (the paper's letters)
        chi = (1 + cos_gamma**2) / (1 + I * I - 2 * I * cos_gamma) ** 1.5
        glow = C + D * np.exp(E * gamma) + F * cos_gamma**2 + G * chi + H * root
        zenith = 1 + A * np.exp(B / (cos_theta + cos_theta.dtype.type(HORIZON_OFFSET)))
        out[..., channel] = np.maximum(zenith * glow * sky.rgb_mean_radiance[channel], 0)
    return out


def exact_radiance(sky: HosekWilkieSky, directions: FloatArray) -> FloatArray:
    """The formula (n, 3) in extended precision, towards unit directions above the horizon."""
    d = directions.astype(np.longdouble)
    d /= np.sqrt((d * d).sum(axis=-1, keepdims=True))
    chord = np.sqrt(((d - sun_of(sky).astype(np.longdouble)) ** 2).sum(axis=-1))
    gamma = 2 * np.arcsin(np.minimum(chord / 2, 1))
    return formula(sky, d[..., 1], 1 - chord * chord / 2, gamma).astype(float)


class Judged(NamedTuple):
    """Texels of a map that are compared: every `step`th, those `above` (6, n, n) the horizon."""

    step: int
    above: NDArray[np.bool_]
    directions: FloatArray

    def of(self, cube: NDArray[Any]) -> FloatArray:
        """Their values (n, 3)."""
        return cube[:, :: self.step, :: self.step][self.above].astype(float)


@lru_cache
def judged(size: int) -> Judged:
    """The texels to compare in maps of a size."""
    step = max(1, size // _JUDGED)
    at = texel_centres(size)[::step]
    s, t = at[None, None, :, None], at[None, :, None, None]
    towards = (
        FACE_NORMALS[:, None, None]
        + s * FACE_S_AXES[:, None, None]
        + t * FACE_T_AXES[:, None, None]
    )
    towards /= np.linalg.norm(towards, axis=-1, keepdims=True)
    above = towards[..., 1] > 0.0
    return Judged(step, above, towards[above])


def numpy_all(sky: HosekWilkieSky, size: int) -> Run:
    """Plain float64 numpy over the whole cube, directions cached, the lower half masked."""
    directions, sun = texel_directions(size), sun_of(sky)

    def run() -> FloatArray:
        up = directions[..., 1]
        cos_gamma = np.clip(directions @ sun, -1.0, 1.0)
        values = formula(sky, np.maximum(up, 0.0), cos_gamma, np.arccos(cos_gamma))
        values[up <= 0.0] = 0.0
        return values

    return run


def numpy_sky(sky: HosekWilkieSky, size: int) -> Run:
    """The same for the sky's texels only."""
    directions, cube, sun = sky_directions(size), np.zeros((6, size, size, 3)), sun_of(sky)
    above = texel_directions(size)[..., 1] > 0.0

    def run() -> FloatArray:
        cos_gamma = np.clip(directions @ sun, -1.0, 1.0)
        cube[above] = formula(sky, directions[:, 1], cos_gamma, np.arccos(cos_gamma))
        return cube

    return run


def twin(sky: HosekWilkieSky, size: int) -> Run:
    """`HosekWilkieSky.radiance` on the sky's texels, whose angles are cached."""
    directions, cube, sun = sky_directions(size), np.zeros((6, size, size, 3)), sun_of(sky)
    above = texel_directions(size)[..., 1] > 0.0
    theta = np.arctan2(np.hypot(directions[:, 0], directions[:, 2]), directions[:, 1])

    def run() -> FloatArray:
        chord = np.linalg.norm(directions - sun, axis=-1)
        cube[above] = sky.radiance(theta, 2 * np.arcsin(np.minimum(chord / 2, 1.0)))
        return cube

    return run


def fast_float32(sky: HosekWilkieSky, size: int) -> Run:
    """`cube_map` into a kept buffer, the lower half cleared again."""
    out = np.empty((6, size, size, 3), np.float32)
    return lambda: sky.cube_map(size, AZIMUTH_RAD, out=out)


def fast_sky_only(sky: HosekWilkieSky, size: int) -> Run:
    """`cube_map` for the rows that are sky: as many texels as mitsuba evaluates."""
    out = np.zeros((6, size, size, 3), np.float32)

    def run() -> NDArray[np.float32]:
        sky.cube_map(size, AZIMUTH_RAD, out=out, faces=(0, 1, 4, 5), rows=(0, size // 2))
        return sky.cube_map(size, AZIMUTH_RAD, out=out, faces=(2,))

    return run


def fast_float16(sky: HosekWilkieSky, size: int) -> Run:
    """`cube_map_float16` into a kept buffer."""
    out = np.empty((6, size, size, 3), np.float16)
    scale = half_scale(sky.brightest)
    return lambda: sky.cube_map_float16(size, AZIMUTH_RAD, scale, out=out)


def fast_u8(sky: HosekWilkieSky, size: int) -> Run:
    """`cube_map_u8` into a kept buffer."""
    out = np.empty((6, size, size, 3), np.uint8)
    return lambda: sky.cube_map_u8(size, AZIMUTH_RAD, EXPOSURE, out=out)


def as_it_is(_sky: HosekWilkieSky, values: FloatArray) -> FloatArray:
    """Values that are radiance already."""
    return values


def of_half(sky: HosekWilkieSky, values: FloatArray) -> FloatArray:
    """Radiance of values divided by the sky's scale."""
    return values * half_scale(sky.brightest)


def of_bytes(_sky: HosekWilkieSky, values: FloatArray) -> FloatArray:
    """Radiance of tones 0 to 255; white as if it were half a tone darker."""
    return -np.log1p(-np.minimum(values, 254.5) / 255.0) / EXPOSURE


class Format(NamedTuple):
    """A format of a cube map: its maker, its decoder to radiance, its largest size."""

    name: str
    make: Callable[[HosekWilkieSky, int], Run]
    decode: Callable[[HosekWilkieSky, FloatArray], FloatArray] = as_it_is
    largest: int = 1024


FORMATS = (
    Format("numpy float64, all texels", numpy_all),
    Format("numpy float64, sky texels", numpy_sky),
    Format("float64 twin", twin),
    Format("cube_map, float32", fast_float32, largest=4096),
    Format("cube_map, float32, sky rows only", fast_sky_only, largest=2048),
    Format("cube_map_float16", fast_float16, of_half, 4096),
    Format("cube_map_u8, tone-mapped", fast_u8, of_bytes, 4096),
)
