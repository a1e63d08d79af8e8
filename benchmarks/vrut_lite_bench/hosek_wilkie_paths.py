"""The ways to compute a Hosek-Wilkie cube map that the benchmark compares."""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from dynamic_skylight import HosekWilkieSky
from dynamic_skylight.hosek_wilkie.formula import HORIZON_OFFSET
from dynamic_skylight.hosek_wilkie.sky import half_scale
from numpy.typing import NDArray

from vrut_lite.geometry.cube_map import texel_directions
from vrut_lite.geometry.frames import direction_from_angles, world_from_enu

SKY = HosekWilkieSky(turbidity=3.0, albedo=0.1, sun_elevation_rad=np.radians(45.0))
AZIMUTH_RAD = 0.3
SUN = world_from_enu(direction_from_angles(AZIMUTH_RAD, SKY.sun_elevation_rad))
EXPOSURE = 0.05


def error_of(cube: NDArray[Any], exact: NDArray[np.float64]) -> float:
    """The largest error relative to the larger of value and 1 % of the map's maximum."""
    scale = np.maximum(exact, 1e-2 * exact.max())
    return float(np.max(np.abs(np.asarray(cube, dtype=float) - exact) / scale))


def _error_of_half(cube: NDArray[np.float16], exact: NDArray[np.float64]) -> float:
    return error_of(cube.astype(float) * half_scale(SKY.brightest), exact)


def _error_of_bytes(cube: NDArray[np.uint8], exact: NDArray[np.float64]) -> float:
    """As a share of white: a tone has no radiance to be relative to."""
    return float(np.max(np.abs(cube / 255.0 + np.expm1(-EXPOSURE * exact))))


class Path(NamedTuple):
    """`make(size)` prepares and returns what is timed; `error(map, exact)` judges it."""

    name: str
    make: Callable[[int], Callable[[], Any]]
    error: Callable[[Any, NDArray[np.float64]], float] = error_of
    largest: int = 1024


def sky_directions(size: int) -> NDArray[np.float64]:
    """Unit directions (n, 3) of the texels above the horizon."""
    directions = texel_directions(size)
    return directions[directions[..., 1] > 0.0]


def formula(cos_theta: NDArray[Any], cos_gamma: NDArray[Any], gamma: NDArray[Any]) -> NDArray[Any]:
    """The formula (n, 3) as one writes it in numpy, in the precision of its arguments."""
    out = np.empty((*cos_theta.shape, 3), cos_theta.dtype)
    root = np.sqrt(cos_theta)
    for channel in range(3):
        numbers = SKY.rgb_distribution[channel].astype(cos_theta.dtype)
        A, B, C, D, E, F, G, H, I = numbers  # noqa: E741 (the paper's letters)
        chi = (1 + cos_gamma**2) / (1 + I * I - 2 * I * cos_gamma) ** 1.5
        glow = C + D * np.exp(E * gamma) + F * cos_gamma**2 + G * chi + H * root
        zenith = 1 + A * np.exp(B / (cos_theta + cos_theta.dtype.type(HORIZON_OFFSET)))
        out[..., channel] = np.maximum(zenith * glow * SKY.rgb_mean_radiance[channel], 0)
    return out


def numpy_all(size: int) -> Callable[[], NDArray[np.float64]]:
    """Plain float64 numpy over the whole cube, directions cached, the lower half masked."""
    directions = texel_directions(size)

    def run() -> NDArray[np.float64]:
        up = directions[..., 1]
        cos_gamma = np.clip(directions @ SUN, -1.0, 1.0)
        values = formula(np.maximum(up, 0.0), cos_gamma, np.arccos(cos_gamma))
        values[up <= 0.0] = 0.0
        return values

    return run


def numpy_sky(size: int) -> Callable[[], NDArray[np.float64]]:
    """The same for the sky's texels only."""
    directions, cube = sky_directions(size), np.zeros((6, size, size, 3))
    above = texel_directions(size)[..., 1] > 0.0

    def run() -> NDArray[np.float64]:
        cos_gamma = np.clip(directions @ SUN, -1.0, 1.0)
        cube[above] = formula(directions[:, 1], cos_gamma, np.arccos(cos_gamma))
        return cube

    return run


def twin(size: int) -> Callable[[], NDArray[np.float64]]:
    """`HosekWilkieSky.radiance` on the sky's texels, whose angles are cached."""
    directions, cube = sky_directions(size), np.zeros((6, size, size, 3))
    above = texel_directions(size)[..., 1] > 0.0
    theta = np.arctan2(np.hypot(directions[:, 0], directions[:, 2]), directions[:, 1])

    def run() -> NDArray[np.float64]:
        chord = np.linalg.norm(directions - SUN, axis=-1)
        cube[above] = SKY.radiance(theta, 2 * np.arcsin(np.minimum(chord / 2, 1.0)))
        return cube

    return run


def fast_float32(size: int) -> Callable[[], NDArray[np.float32]]:
    """`cube_map` into a kept buffer, the lower half cleared again."""
    out = np.empty((6, size, size, 3), np.float32)
    return lambda: SKY.cube_map(size, AZIMUTH_RAD, out=out)


def fast_sky_only(size: int) -> Callable[[], NDArray[np.float32]]:
    """`cube_map` for the rows that are sky: as many texels as mitsuba evaluates."""
    out = np.zeros((6, size, size, 3), np.float32)

    def run() -> NDArray[np.float32]:
        SKY.cube_map(size, AZIMUTH_RAD, out=out, faces=(0, 1, 4, 5), rows=(0, size // 2))
        return SKY.cube_map(size, AZIMUTH_RAD, out=out, faces=(2,))

    return run


def fast_float16(size: int) -> Callable[[], NDArray[np.float16]]:
    """`cube_map_float16` into a kept buffer."""
    out = np.empty((6, size, size, 3), np.float16)
    return lambda: SKY.cube_map_float16(size, AZIMUTH_RAD, half_scale(SKY.brightest), out=out)


def fast_u8(size: int) -> Callable[[], NDArray[np.uint8]]:
    """`cube_map_u8` into a kept buffer."""
    out = np.empty((6, size, size, 3), np.uint8)
    return lambda: SKY.cube_map_u8(size, AZIMUTH_RAD, EXPOSURE, out=out)


PATHS = (
    Path("numpy float64, all texels", numpy_all),
    Path("numpy float64, sky texels", numpy_sky),
    Path("float64 twin", twin),
    Path("fast, float32", fast_float32, largest=4096),
    Path("fast, float32, sky rows only", fast_sky_only, largest=4096),
    Path("fast, float16", fast_float16, _error_of_half, largest=4096),
    Path("fast, tone-mapped u8", fast_u8, _error_of_bytes, largest=4096),
)


def exact_cube(size: int) -> NDArray[np.float64]:
    """The formula in extended precision, 0 below the horizon: what errors are counted from."""
    directions = texel_directions(size)
    above = directions[..., 1] > 0.0
    d = directions[above].astype(np.longdouble)
    d /= np.sqrt((d * d).sum(axis=-1, keepdims=True))
    chord = np.sqrt(((d - SUN.astype(np.longdouble)) ** 2).sum(axis=-1))
    gamma = 2 * np.arcsin(np.minimum(chord / 2, 1))
    cube = np.zeros((6, size, size, 3))
    cube[above] = formula(d[:, 1], 1 - chord * chord / 2, gamma)
    return cube
