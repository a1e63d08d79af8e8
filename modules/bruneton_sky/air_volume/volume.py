"""The air between an observer and the scene: from a solved field to an `AirVolume`.

Where the nodes lie is said in `vrut_lite.sky.air_volume`. The light up to a node is divided
by 1 - T: a mean along the ray, which has a limit in the observer's eye and changes slowly, so
that few nodes do.
"""

from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from bruneton_sky.air_volume.kernels import light_rows, settle_colours, slice_rows
from bruneton_sky.atmosphere import Atmosphere
from bruneton_sky.ground_light import SKYLIGHT_EXPONENT
from bruneton_sky.phase import rayleigh_phase
from bruneton_sky.sky_view.table import channel_phases
from bruneton_sky.solver import SourceField
from bruneton_sky.solver.source_field import source_of_group
from bruneton_sky.solver.wavelength_groups import LANES, groups_of_air, wavelengths_of_groups
from vrut_lite.array import Array
from vrut_lite.atmosphere.air_colour import lost_and_depth, shares_of_white
from vrut_lite.geometry.colour import rgb_from_spectrum
from vrut_lite.geometry.encoding import encode_float16
from vrut_lite.messages.air import AirVolume
from vrut_lite.messages.gpu_texture import GpuTexture
from vrut_lite.numeric_types import FloatArray
from vrut_lite.sky.air_reach import UNSEEN_SHARE
from vrut_lite.sky.air_rows import AirGrid
from vrut_lite.sky.air_volume import NodeRays, node_rays, slice_shares


class AirSizes(NamedTuple):
    """How many slices, rows above and below the horizon, columns; and steps in a slice.

    Below the horizon the ground is near, or the eye so high that neighbouring rays differ little:
    fewer rows suffice there. In clear air the Earth's shadow, 100 km away under a sun at -4
    degrees, errs by 5.1 % between 44 rows and by 1.9 % between 60; 24 columns err as little as 32.
    """

    slices: int = 32
    rows_above: int = 60
    rows_below: int = 24
    columns: int = 24
    steps: int = 2


# The first node is in the eye, where 1 - T is 0: it gets the mean of this share of a slice.
_FIRST_SHARE = 0.01


class Matter(NamedTuple):
    """The matter along the rays of a volume.

    Attributes:
        distance_m: (rows, slices + 1), from 0 to each slice's end.
        centre, weight: (groups, rows, slices, ...) of each slice, see `Bins`.
        extinction: (slices, rows, 3) of the volume.
        colours: (groups, rows, slices, 4, 3), from light up to a node to its colour over 1 - T.
    """

    grid: AirGrid
    rays: NodeRays
    distance_m: FloatArray
    centre: FloatArray
    weight: FloatArray
    extinction: NDArray[np.float32]
    colours: NDArray[np.float32]


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
        reach_m: length of a ray in the air, at most.
    """
    matter = matter_before(field, altitude_m, sun_direction, reach_m, sizes or AirSizes())
    values, scale = encode_float16(_light(field, matter))
    return volume_of(field, matter, sun_direction, Array(values), scale)


def volume_of(
    field: SourceField,
    matter: Matter,
    sun_direction: ArrayLike,
    light: Array | GpuTexture,
    radiance_scale: float,
) -> AirVolume:
    """The volume of this matter and the light that it scatters."""
    x, y, z = (float(v) for v in np.asarray(sun_direction, dtype=float))
    return AirVolume(
        light=light,
        extinction=Array(matter.extinction),
        columns=matter.rays.nu.shape[1],
        radiance_scale=radiance_scale,
        aerosol_phase=Array(channel_phases(field, matter.grid.observer_altitude_m).channels.view()),
        sun_direction=(x, y, z),
        **matter.grid._asdict(),
    )


def air_is_seen(atmosphere: Atmosphere, altitude_m: float, reach_m: float) -> bool:
    """Whether `reach_m` of air may be visible, as dense as the lowest air within reach."""
    if reach_m <= 0.0:
        return False
    lowest_m = max(min(altitude_m, atmosphere.top_altitude_m) - reach_m, 0.0)
    # Between kinks no sum of falling densities and lines is denser than at both.
    height = np.array([lowest_m, *(m for m in atmosphere.kinks_m if m > lowest_m)])
    each = np.multiply.outer(atmosphere.absorber(height), atmosphere.absorption_extinction)
    for kind in atmosphere.scatterers():
        each += np.multiply.outer(kind.density(height), kind.extinction)
    return bool(-np.expm1(-each.max() * reach_m) > UNSEEN_SHARE)


def matter_before(
    field: SourceField,
    altitude_m: float,
    sun_direction: ArrayLike,
    reach_m: float,
    sizes: AirSizes,
) -> Matter:
    """The matter along the rays of a volume; arguments as for `air_volume`."""
    air, height = field.thinned, float(np.asarray(sun_direction, dtype=float)[1])
    grid = AirGrid(
        float(altitude_m), air.ground_radius_m, air.top_altitude_m, float(reach_m),
        sizes.rows_above, sizes.rows_below,
    )  # fmt: skip
    rays = node_rays(grid, sizes.columns, min(max(height, -1.0), 1.0))
    shares = slice_shares(sizes.slices, grid.observer_altitude_m)
    shares[0] = _FIRST_SHARE * shares[1]
    distance = rays.span_m[:, None] * np.concatenate([[0.0], shares])
    groups, nodes = groups_of_air(air), (rays.mu.size, sizes.slices)
    centre = np.empty((len(groups), *nodes, 4))
    weight = np.empty((len(groups), *nodes, 2, LANES))
    passed = np.empty((len(groups), *nodes, LANES))
    for k, group in enumerate(groups):
        slice_rows(
            group, rays.altitude_m, rays.mu, distance, sizes.steps, centre[k], weight[k], passed[k]
        )
    extinction, colours = _colours(field, passed, distance[:, 1:])
    return Matter(grid, rays, distance, centre, weight, extinction, colours)


def _light(field: SourceField, matter: Matter) -> NDArray[np.float32]:
    """Mean radiance (3, slices, rows, columns, 3)."""
    rays = matter.rays
    light = np.zeros((3, matter.distance_m.shape[1] - 1, *rays.nu.shape, 3), dtype=np.float32)
    mu_s, nu = rays.mu_s.astype(np.float32), rays.nu.astype(np.float32)
    phases = channel_phases(field, matter.grid.observer_altitude_m)
    for k, air in enumerate(groups_of_air(field.thinned)):
        light_rows(
            air, rays.altitude_m, rays.mu, mu_s, nu, matter.distance_m, matter.centre[k],
            matter.weight[k], field.transmittance[k], source_of_group(field, k),
            matter.colours[k], phases.channels, phases.lanes[k], light,
        )  # fmt: skip
    molecules = rayleigh_phase(rays.nu).astype(np.float32)
    settle_colours(light, molecules, np.sqrt(0.5 - 0.5 * nu), phases.channels)
    return light


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
