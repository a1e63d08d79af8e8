"""All that one observer sees of the air and the planet under one sun, by view direction.

The table serves an observer on the ground, inside the air or above it; `sky_view_rows` says
where its nodes lie. The sky is symmetric about the sun's vertical plane, so half of it is kept.
The light that aerosol scatters once is kept without its phase function, which is applied per
texel: the aureole stays sharp.

The table holds the fourth root of linear sRGB radiance: in twilight radiance falls by powers
of ten between neighbouring rows, and a straight line through the roots follows that. A radiance
below zero, a colour outside the gamut, becomes zero.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from bruneton_sky.ground_light import SKYLIGHT_EXPONENT, GroundLight, ground_radiance
from bruneton_sky.phase import MiePhase, mie_phase, mie_phase_parameters, rayleigh_phase
from bruneton_sky.sky_view_rows import Rows, table_rows
from bruneton_sky.solver import SourceField
from bruneton_sky.solver.air import LANES, groups_of_air, wavelengths_of_groups
from bruneton_sky.solver.view import source_of_group
from vrut_lite.geometry.colour import rgb_from_spectrum
from vrut_lite.geometry.cube_map import FACE_NORMALS, FACE_S_AXES, FACE_T_AXES, texel_centres

# Rows above and below the horizon for an observer who stands, inside the air, and above it, from
# where all of the air is a thin limb.
_STANDING_ROWS, _INSIDE_ROWS, _OUTSIDE_ROWS = (80, 0), (80, 32), (24, 64)
COLUMNS = 40
# Below this altitude the ground fills what is below the level, and the air before it is left
# to whoever draws the ground.
STANDING_M = 10.0
# Steps along a ray, and bins for light scattered once and more. In twilight and from space the
# planet's shadow cuts through the rays, and a bin that it cuts is coarse: twice as many are taken.
_DAY, _FINE = (48, 24, 12), (96, 48, 12)
_TWILIGHT_BELOW_MU_S = 0.1
_AXES = np.stack([FACE_NORMALS, FACE_S_AXES, FACE_T_AXES], axis=1).astype(np.float32)


class SkyView(NamedTuple):
    """A sky-view table.

    Attributes:
        nodes: (rows * columns, 8) float32: fourth roots of linear sRGB radiance in
            W m^-2 sr^-1, three of the light with its phase and three of aerosol without.
        shape: rows above the horizon, rows below it (0 for an observer who stands), columns.
        depth: (2,) 1 + mu of the ground's horizon and of the air's end.
        sun_direction: (3,) in world axes.
        phase: the phase function of the aerosol.
    """

    nodes: NDArray[np.float32]
    shape: tuple[int, int, int]
    depth: NDArray[np.float64]
    sun_direction: NDArray[np.float64]
    phase: MiePhase


def sky_view(field: SourceField, altitude_m: float, sun_direction: NDArray[np.float64]) -> SkyView:
    """The table for an observer at an altitude of at least 0.

    Args:
        field: the solved atmosphere.
        altitude_m: above the ground; above the air's top too.
        sun_direction: unit vector (3,) in world axes, at the observer.
    """
    mu_s = float(np.clip(sun_direction[1], -1.0, 1.0))
    inside = altitude_m <= field.atmosphere.top_altitude_m
    above, below = _INSIDE_ROWS if inside else _OUTSIDE_ROWS
    if altitude_m <= STANDING_M:
        above, below = _STANDING_ROWS
    rows = table_rows(field.atmosphere, altitude_m, mu_s, above, below, COLUMNS)
    rgb = _radiance_rgb(field, rows, _DAY if inside and mu_s > _TWILIGHT_BELOW_MU_S else _FINE)
    nodes = np.zeros((rgb.shape[0] * rgb.shape[1], 2, 4), dtype=np.float32)
    nodes[..., :3] = np.sqrt(np.sqrt(np.maximum(rgb, 0.0))).reshape(-1, 2, 3)
    return SkyView(
        nodes.reshape(-1, 8),
        (above, below, COLUMNS),
        rows.depth,
        np.asarray(sun_direction, dtype=float),
        mie_phase_parameters(field.atmosphere),
    )


def _radiance_rgb(
    field: SourceField, rows: Rows, counts: tuple[int, int, int]
) -> NDArray[np.float64]:
    """Linear sRGB (rows, columns, 2, 3): all light with its phase but for that which aerosol
    scatters once, and that without its phase."""
    once, more, transmittance, length_m = trace(field, rows, counts)
    phased = once[0] * rayleigh_phase(rows.nu)[..., None] + more
    wavelength_nm = field.atmosphere.wavelength_nm
    rgb = rgb_from_spectrum(np.stack([phased, once[1]], axis=-2), wavelength_nm, SKYLIGHT_EXPONENT)
    # A low sun's light off aerosol lies outside the gamut: what it lacks the rest makes up for.
    lacking = np.minimum(rgb[:, :, 1], 0.0)
    rgb[:, :, 0] += lacking * mie_phase(field.atmosphere, rows.nu)[..., None]
    if rows.hits.any():
        ground = _ground_at_end(field, rows, length_m)
        seen = (part * transmittance[rows.hits, None] for part in ground)
        rgb[rows.hits, :, 0] += GroundLight(*seen).rgb(wavelength_nm)
    return rgb


def fill_cube(
    view: SkyView, size: int, ground_radiance_rgb: NDArray[np.float64]
) -> NDArray[np.float32]:
    """Cube map (6, size, size, 3) of the surroundings, in world axes.

    Where the table has no rows below the horizon, `ground_radiance_rgb` (3,) is there.
    """
    from bruneton_sky.sky_view_fill import fill_faces

    cube = np.empty((6, size, size, 3), dtype=np.float32)
    sun = np.concatenate([view.sun_direction, level_direction(view.sun_direction)])
    ground = np.asarray(ground_radiance_rgb, dtype=np.float32)
    g, factor, form = view.phase
    phase = tuple(np.float32(v) for v in (factor, form, (1.0 - g) ** 2, 2.0 * g))
    centres = texel_centres(size).astype(np.float32)
    horizon = view.depth.astype(np.float32)
    fill_faces(
        view.nodes, view.shape, horizon, sun.astype(np.float32), phase, _AXES, centres, ground, cube
    )
    return cube


def level_direction(direction: NDArray[np.float64]) -> NDArray[np.float64]:
    """The unit vector (x, z) of a direction's azimuth; north under a zenith, which has none."""
    level = direction[[0, 2]]
    length = float(np.hypot(*level))
    return level / length if length > 1e-12 else np.array([0.0, -1.0])


def trace(
    field: SourceField, rows: Rows, counts: tuple[int, int, int]
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Light along rays, in W m^-2 sr^-1 nm^-1.

    Scattered once (2, rows, columns, C), by molecules and by aerosol without their phase
    functions, and more often (rows, columns, C); the transmittance
    (rows, C) and the length (rows,) of the rays. `counts`: steps, bins for light scattered once,
    bins for more.
    """
    from bruneton_sky.sky_view_kernels import trace_rows

    groups = groups_of_air(field.atmosphere)
    shape = rows.nu.shape
    once = np.empty((len(groups), 2, *shape, LANES), dtype=np.float32)
    more = np.empty((len(groups), *shape, LANES), dtype=np.float32)
    end = np.empty((len(groups), shape[0], LANES + 1))
    mu_s, nu = rows.mu_s.astype(np.float32), rows.nu.astype(np.float32)
    for k, air in enumerate(groups):
        trace_rows(
            air, rows.altitude_m, rows.mu, rows.hits, mu_s, nu,
            field.transmittance[k], source_of_group(field, k), counts,
            once[k].reshape(2, shape[0], -1), more[k].reshape(shape[0], -1), end[k],
        )  # fmt: skip
    count = len(field.atmosphere.wavelength_nm)
    return (
        wavelengths_of_groups(once, count),
        np.maximum(wavelengths_of_groups(more, count), 0.0),
        wavelengths_of_groups(end[..., :LANES], count),
        end[0, :, LANES],
    )


def _ground_at_end(field: SourceField, rows: Rows, length_m: NDArray[np.float64]) -> GroundLight:
    """The ground's radiance (rows below, columns, C) where the rays end."""
    radius = field.atmosphere.ground_radius_m
    start_m, metres = rows.altitude_m[rows.hits, None], length_m[rows.hits, None]
    along = (radius + start_m) * rows.mu_s[rows.hits] + metres * rows.nu[rows.hits]
    return ground_radiance(field, np.clip(along / radius, -1.0, 1.0))
