"""The air between one observer and whatever stands around: from a solved field to an `AirVolume`.

Where the nodes lie is said in `vrut_lite.geometry.air_volume`. The light up to a node is divided
by 1 - T: a mean along the ray, which has a limit in the observer's eye and changes slowly, so
that few nodes do.
"""

from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from bruneton_sky.atmosphere import Atmosphere
from bruneton_sky.ground_light import SKYLIGHT_EXPONENT
from bruneton_sky.phase import mie_phase, mie_phase_parameters, rayleigh_phase
from bruneton_sky.solver import SourceField
from bruneton_sky.solver.air import LANES, groups_of_air, wavelengths_of_groups
from bruneton_sky.solver.view import source_of_group
from vrut_lite.geometry.air_colour import lost_and_depth, shares_of_white
from vrut_lite.geometry.air_reach import UNSEEN_SHARE
from vrut_lite.geometry.air_volume import Grid, NodeRays, node_rays, slice_shares
from vrut_lite.geometry.colour import rgb_from_spectrum
from vrut_lite.geometry.encoding import encode_float16
from vrut_lite.kernel.array import Array
from vrut_lite.kernel.messages import AirVolume

FloatArray = NDArray[np.float64]


class AirSizes(NamedTuple):
    """How many slices, rows above and below the horizon, columns; and steps in a slice.

    Below the horizon things are near, or the eye is so high that rays change slowly: fewer rows
    do there.
    """

    slices: int = 32
    rows_above: int = 32
    rows_below: int = 24
    columns: int = 32
    steps: int = 2


# The first node is in the eye, where the light is its own limit: that of so much of a slice.
_FIRST_SHARE = 0.01


def air_volume(
    field: SourceField,
    altitude_m: float,
    sun_direction: ArrayLike,
    reach_m: float,
    sizes: AirSizes | None = None,
) -> AirVolume:
    """The air around an observer at an altitude of at least 0, also above the air.

    Args:
        field: the solved atmosphere.
        altitude_m: above the ground.
        sun_direction: unit vector (3,) in world axes, at the observer.
        reach_m: how much air to give light to along a ray, at most.
    """
    count, air = sizes or AirSizes(), field.atmosphere
    x, y, z = (float(v) for v in np.asarray(sun_direction, dtype=float))
    grid = Grid(
        float(altitude_m), air.ground_radius_m, air.top_altitude_m, float(reach_m),
        count.rows_above, count.rows_below,
    )  # fmt: skip
    rays = node_rays(grid, count.columns, min(max(y, -1.0), 1.0))
    light, extinction = _trace(field, rays, count, grid.observer_altitude_m)
    values, scale = encode_float16(light)
    shaded, direct, aerosol = (Array(part) for part in values)
    return AirVolume(
        shaded=shaded,
        direct=direct,
        aerosol=aerosol,
        extinction=Array(extinction),
        radiance_scale=scale,
        aerosol_phase=mie_phase_parameters(air),
        sun_direction=(x, y, z),
        **grid._asdict(),
    )


def air_is_seen(atmosphere: Atmosphere, altitude_m: float, reach_m: float) -> bool:
    """Whether so many metres of air may show: none of it is denser than the lowest within reach."""
    if reach_m <= 0.0:
        return False
    lowest_m = max(min(altitude_m, atmosphere.top_altitude_m) - reach_m, 0.0)
    layers = np.asarray(atmosphere.absorber_altitude_m)
    absorber = atmosphere.absorber([lowest_m, *layers[layers > lowest_m]]).max()
    densest = absorber * np.asarray(atmosphere.absorption_extinction)
    for kind in atmosphere.scatterers():
        densest = densest + kind.extinction * np.exp(-lowest_m / kind.scale_height_m)
    return bool(-np.expm1(-densest.max() * reach_m) > UNSEEN_SHARE)


def _trace(
    field: SourceField, rays: NodeRays, sizes: AirSizes, altitude_m: float
) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Mean radiance (3, slices, rows, columns, 3) and extinction (slices, rows, 3)."""
    from bruneton_sky.air_volume_kernels import light_rows, settle_colours, slice_rows

    groups, rows = groups_of_air(field.atmosphere), rays.mu.size
    shares = slice_shares(sizes.slices, altitude_m)
    shares[0] = _FIRST_SHARE * shares[1]
    distance = rays.span_m[:, None] * np.concatenate([[0.0], shares])
    centre = np.empty((len(groups), rows, sizes.slices, 4))
    weight = np.empty((len(groups), rows, sizes.slices, 2, LANES))
    passed = np.empty((len(groups), rows, sizes.slices, LANES))
    for k, air in enumerate(groups):
        slice_rows(
            air, rays.altitude_m, rays.mu, distance, sizes.steps, centre[k], weight[k], passed[k]
        )
    extinction, colours = _colours(field, passed, distance[:, 1:])
    light = np.zeros((3, sizes.slices, *rays.nu.shape, 3), dtype=np.float32)
    phase = rayleigh_phase(rays.nu).astype(np.float32)
    mu_s, nu = rays.mu_s.astype(np.float32), rays.nu.astype(np.float32)
    for k, air in enumerate(groups):
        light_rows(
            air, rays.altitude_m, rays.mu, mu_s, nu, distance, centre[k], weight[k],
            field.transmittance[k], source_of_group(field, k), colours[k], phase, light,
        )  # fmt: skip
    settle_colours(light, mie_phase(field.atmosphere, rays.nu).astype(np.float32))
    return light, extinction


def _colours(
    field: SourceField, passed: FloatArray, distance_m: FloatArray
) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Extinction (slices, rows, 3), and the matrices (groups, rows, slices, 4, 3) from light up
    to a node to its colour over 1 - T."""
    air, groups = field.atmosphere, len(passed)
    spectral = wavelengths_of_groups(1.0 - passed, len(air.wavelength_nm))
    matrix, shares = _matrices(air.wavelength_nm, air.solar_irradiance)
    lost, depth = lost_and_depth(spectral, shares)
    per_lost = np.divide(1.0, lost, out=np.zeros_like(lost), where=lost > 0.0)
    extinction = np.moveaxis(depth / distance_m[..., None], 0, 1)
    colours = matrix.reshape(groups, 1, 1, LANES, 3) * per_lost[:, :, None, :]
    return np.ascontiguousarray(extinction, dtype=np.float32), colours.astype(np.float32)


@lru_cache(maxsize=4)
def _matrices(
    wavelength_nm: tuple[float, ...], solar_irradiance: tuple[float, ...]
) -> tuple[FloatArray, FloatArray]:
    """Colour (C, 3) of spectral radiance, padded to whole groups, and the shares of white."""
    matrix = rgb_from_spectrum(np.eye(len(wavelength_nm)), wavelength_nm, SKYLIGHT_EXPONENT)
    shares = shares_of_white(wavelength_nm, solar_irradiance, SKYLIGHT_EXPONENT)
    return np.pad(matrix, ((0, -len(wavelength_nm) % LANES), (0, 0))), shares
