"""The radiance that one observer sees under one sun, tabulated by view direction.

The table serves an observer on the ground, inside the air or above it; `rays` says
where its nodes lie. The sky is symmetric about the sun's vertical plane, so half of it is kept.
The light that aerosol scatters once is kept without its phase functions, by wavelength; they are
applied per texel: the aureole stays sharp.

The table holds the fourth root of linear sRGB radiance: in twilight radiance falls by powers
of ten between neighbouring rows, and linear interpolation of the roots follows that. A radiance
below zero, a colour outside the gamut, becomes zero.
"""

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from bruneton_sky.atmosphere import Atmosphere
from bruneton_sky.field_tables import table_of_field
from bruneton_sky.ground_light import SKYLIGHT_EXPONENT, SUNLIGHT_EXPONENT, ground_radiance
from bruneton_sky.sky_view.cube_kernels import fill_faces
from bruneton_sky.sky_view.rays import SkyViewRays, table_rows
from bruneton_sky.sky_view.table_kernels import add_rows, fill_row_bins, finish_rows
from bruneton_sky.solver import SourceField
from bruneton_sky.solver.bin_kernels import Bins
from bruneton_sky.solver.grid import SunGrid
from bruneton_sky.solver.particles import kind_phases, shares_above
from bruneton_sky.solver.source_field import source_of_group
from bruneton_sky.solver.wavelength_groups import (
    LANES,
    WavelengthGroup,
    groups_of_air,
    in_lanes,
    is_hazy,
    is_veiled,
)
from vrut_lite.atmosphere.aerosols.phase_table import PHASE_NODES
from vrut_lite.geometry.colour import rgb_from_spectrum
from vrut_lite.geometry.cube_map import FACE_NORMALS, FACE_S_AXES, FACE_T_AXES, texel_centres

if TYPE_CHECKING:
    from bruneton_sky.solver.later_order_kernels import Source

# Rows above and below the horizon for an observer on the ground, inside the air, and above it, who
# sees all of the air as a thin limb.
_STANDING_ROWS, _INSIDE_ROWS, _OUTSIDE_ROWS = (80, 0), (80, 32), (32, 64)
COLUMNS = 40
# Below this altitude all that is below the level is ground; the renderer adds the air before it.
STANDING_M = 10.0
# The same as a share of the fog's scale height, the lower of both: fog is a fifth thinner there.
_STANDING_IN_FOG = 0.2
# Steps along a ray, and bins for light scattered once and more. In twilight the planet's shadow
# cuts through the rays and sunlight changes within the stratosphere's layer: each step is a bin of
# its own, which leaves a fifth of the error of half as many bins for a tenth more time. From above
# the air some ray is always in twilight.
_DAY, _TWILIGHT, _TWILIGHT_ALOFT = (48, 24, 12), (96, 96, 12), (64, 64, 12)
_FROM_SPACE = (48, 48, 12)
# At least so many steps and bins before a thick layer of the stratosphere: at depth 0.05 half as
# many err by 5 % in blue in a hundredth of the limb.
_VEILED = 96
_TWILIGHT_BELOW_MU_S = 0.1
# In deep twilight light scattered more than once grows with the altitude, and wants as many bins.
_DEEP_BELOW_MU_S, _DEEP_BINS = -0.06, 32
# Bins for light scattered more than once in haze, for an observer inside the air: it changes
# within shorter distances.
_HAZE_BINS = 16
# `SkyView.shape` of a table for the light on the scene, and of one for the brightness aloft.
_LIGHT_SHAPE, _COARSE_SHAPE = (32, 0, 24), (12, 12, 12)
# Suns between which the ground's colour is interpolated, and numbers of a node.
_SUNS, NODE = 192, 8
_AXES = np.stack([FACE_NORMALS, FACE_S_AXES, FACE_T_AXES], axis=1).astype(np.float32)


class GroundColours(NamedTuple):
    """The ground's colours (suns * 4 * 4,) by wavelength, under suns with zenith cosines mu_s.

    A fourth number pads each colour to a register. `grid` places a cosine among `mu_s`: see
    `SunGrid.constants`.
    """

    mu_s: NDArray[np.float32]
    grid: NDArray[np.float32]
    light: NDArray[np.float32]


class SkyView(NamedTuple):
    """A sky-view table.

    Attributes:
        nodes: (rows * columns, 8) float32: fourth roots of linear sRGB radiance in
            W m^-2 sr^-1 of the light with its phase, one unused, and of aerosol's light in four
            bands without.
        shape: rows above the horizon, rows below it (0 for an observer on the ground), columns.
        depth: (2,) 1 + mu of the ground's horizon and of the air's end.
        sun_direction: (3,) in world axes.
        bands: the colours and phase functions of aerosol's light.
    """

    nodes: NDArray[np.float32]
    shape: tuple[int, int, int]
    depth: NDArray[np.float64]
    sun_direction: NDArray[np.float64]
    bands: "AerosolBands"


class AerosolBands(NamedTuple):
    """Four bands of the light that aerosol scatters once.

    `colour` (4, 4) float32: linear sRGB of each band and a pad. `phase` (n, 4) float32: their phase
    functions in sr^-1, uniform in sqrt((1 - nu) / 2). `matrix` (C, 4): what of each wavelength's
    light is in each band. `kinds` (kinds, n, C): phase functions of the particles' kinds over their
    mean, which the bands have.
    """

    colour: NDArray[np.float32]
    phase: NDArray[np.float32]
    matrix: NDArray[np.float64]
    kinds: NDArray[np.float64]


def sky_view(
    field: SourceField, altitude_m: float, sun_direction: NDArray[np.float64], finer: float = 1.0
) -> SkyView:
    """The table for an observer at an altitude of at least 0.

    Args:
        field: the solved atmosphere.
        altitude_m: above the ground; above the air's top too.
        sun_direction: unit vector (3,) in world axes, at the observer.
        finer: factor on the numbers of rows, columns, steps and bins.
    """
    sizes = table_sizes(field.atmosphere, altitude_m, float(sun_direction[1]), finer)
    return _table(field, altitude_m, sun_direction, *sizes)


def table_sizes(
    atmosphere: Atmosphere, altitude_m: float, mu_s: float, finer: float
) -> tuple[tuple[int, int, int], tuple[int, int, int]]:
    """A table's `SkyView.shape`, and its `table_counts`; arguments as for `sky_view`."""
    above, below = _INSIDE_ROWS if altitude_m <= atmosphere.top_altitude_m else _OUTSIDE_ROWS
    if altitude_m <= standing_m(atmosphere):
        above, below = _STANDING_ROWS
    shape = round(above * finer), round(below * finer), round(COLUMNS * finer)
    steps, once, more = table_counts(atmosphere, altitude_m, mu_s)
    return shape, (round(steps * finer), round(once * finer), round(more * finer))


def standing_m(atmosphere: Atmosphere) -> float:
    """Altitude in m up to which the observer's table is that of the ground."""
    if not atmosphere.foggy:
        return STANDING_M
    return min(STANDING_M, _STANDING_IN_FOG * atmosphere.fog_scale_height_m)


def light_view(field: SourceField, sun_direction: NDArray[np.float64]) -> SkyView:
    """A small table for an observer on the ground, for the light on the scene; it is not shown.

    Irradiance of a level surface is that of the large table within 0.1 %, from day to the end of
    twilight.
    """
    counts = table_counts(field.atmosphere, 0.0, float(sun_direction[1]))
    return _table(field, 0.0, sun_direction, _LIGHT_SHAPE, counts)


def coarse_view(
    field: SourceField, altitude_m: float, sun_direction: NDArray[np.float64]
) -> SkyView:
    """A table of a thirtieth of the nodes, for the largest radiance that an observer aloft sees."""
    return _table(field, altitude_m, sun_direction, _COARSE_SHAPE, _DAY)


def _table(
    field: SourceField,
    altitude_m: float,
    sun_direction: NDArray[np.float64],
    shape: tuple[int, int, int],
    counts: tuple[int, int, int],
) -> SkyView:
    mu_s = float(np.clip(sun_direction[1], -1.0, 1.0))
    rows = table_rows(field.atmosphere, altitude_m, mu_s, *shape)
    bands = aerosol_bands(field, altitude_m)
    return SkyView(
        _nodes(field, altitude_m, rows, shape, counts, bands),
        shape,
        rows.depth,
        np.asarray(sun_direction, dtype=float),
        bands,
    )


def table_counts(atmosphere: Atmosphere, altitude_m: float, mu_s: float) -> tuple[int, int, int]:
    """Steps of a table's rays, bins for light scattered once, bins for more."""
    inside = altitude_m <= atmosphere.top_altitude_m
    if not inside:
        counts = _FROM_SPACE
    elif mu_s > _TWILIGHT_BELOW_MU_S:
        counts = _DAY
    else:
        counts = _TWILIGHT if altitude_m <= standing_m(atmosphere) else _TWILIGHT_ALOFT
    steps, once, more = _in_this_air(atmosphere, counts, inside)
    if counts != _DAY and is_veiled(atmosphere):
        steps, once = max(steps, _VEILED), max(once, _VEILED)
    deep = inside and mu_s < _DEEP_BELOW_MU_S
    return steps, once, max(more, _DEEP_BINS) if deep else more


def _in_this_air(
    atmosphere: Atmosphere, counts: tuple[int, int, int], inside: bool
) -> tuple[int, int, int]:
    """More bins in fog: half of a ray's bins lie in it, half in the air beyond."""
    steps, once, more = counts
    if atmosphere.foggy:
        return steps, 2 * once, 2 * more
    return (steps, once, _HAZE_BINS) if inside and is_hazy(atmosphere) else counts


def _nodes(
    field: SourceField,
    altitude_m: float,
    rows: SkyViewRays,
    shape: tuple[int, int, int],
    counts: tuple[int, int, int],
    bands: AerosolBands,
) -> NDArray[np.float32]:
    """The nodes of a table for its rays; `counts`: steps, bins for light scattered once, and
    more."""
    mu_s, nu = rows.mu_s.astype(np.float32), rows.nu.astype(np.float32)
    nodes = np.zeros((len(nu), nu.shape[1] * NODE), dtype=np.float32)
    colours, ground = colours_of(field)
    matrix, kinds = bands_in_groups(field, mean_above_m(field.atmosphere, altitude_m))
    bins = _row_bins(field, altitude_m, shape, counts)
    for k, (air, source) in enumerate(_sources(field)):
        for part, fine, coarse in bins[k]:
            add_rows(
                air, rows.altitude_m[part], rows.mu[part], rows.hits[part], mu_s[part], nu[part],
                field.transmittance[k], source, fine, coarse,
                colours[k], matrix[k], kinds[k], ground[k], nodes[part],
            )  # fmt: skip
    finish_rows(nu, bands.phase, bands.colour, nodes)
    return nodes.reshape(-1, NODE)


# The matter along a table's rays does not depend on the sun.
@table_of_field
def _row_bins(
    field: SourceField,
    altitude_m: float,
    shape: tuple[int, int, int],
    counts: tuple[int, int, int],
) -> list[list[tuple[slice, Bins, Bins]]]:
    """Rows of each group of wavelengths, and their bins for light scattered once and more."""
    rows = table_rows(field.atmosphere, altitude_m, 1.0, *shape)
    parts = row_parts(rows, counts)
    return [
        [(part, *row_bins(air, rows, part, own)) for part, own in parts]
        for air, _ in _sources(field)
    ]


def row_bins(
    air: WavelengthGroup, rows: SkyViewRays, part: slice, counts: tuple[int, int, int]
) -> tuple[Bins, Bins]:
    """Bins of a `part` of a table's rows for light scattered once, and for more.

    `counts`: see `table_counts`. The rows are the first axis of the bins' arrays.
    """
    altitude_m, mu, hits = rows.altitude_m[part], rows.mu[part], rows.hits[part]
    fine, coarse = (Bins.empty(mu.shape, count) for count in counts[1:])
    fill_row_bins(air, altitude_m, mu, hits, counts[0], fine, coarse)
    return fine, coarse


def limb_counts(counts: tuple[int, int, int]) -> tuple[int, int, int]:
    """`table_counts` for the limb seen from above the air: the planet's shadow cuts through rays
    that cross it from end to end, and a bin that it cuts is coarse."""
    steps, once, more = counts
    return 5 * steps // 2, 5 * once // 2, more


def row_parts(
    rows: SkyViewRays, counts: tuple[int, int, int]
) -> list[tuple[slice, tuple[int, int, int]]]:
    """Rows and the counts they are made with: the limb, and the planet's disc."""
    if rows.depth[1] > 1.0:
        return [(slice(None), counts)]
    limb = np.count_nonzero(~rows.hits)
    return [(slice(limb), limb_counts(counts)), (slice(limb, None), counts)]


def aerosol_bands(field: SourceField, altitude_m: float) -> AerosolBands:
    """Bands of a field's particles seen from an altitude: its wavelengths, if there are four at
    most.

    Of more wavelengths they are red, green and blue, whose phase functions are means by the
    sunlight that aerosol scatters: exact where all wavelengths share one.
    """
    return _bands(field, mean_above_m(field.atmosphere, altitude_m))


@table_of_field
def _bands(field: SourceField, above_m: float) -> AerosolBands:
    air = field.atmosphere
    each, shown = _phases(field, above_m)
    count = len(air.wavelength_nm)
    skylight = rgb_from_spectrum(np.eye(count), air.wavelength_nm, SKYLIGHT_EXPONENT)
    if count <= LANES:
        matrix, colour, phase = np.eye(count, LANES), skylight, shown
    else:
        matrix, colour = np.pad(skylight, ((0, 0), (0, 1))), np.eye(3)
        phase = shown @ channel_shares(air)
    return AerosolBands(
        np.pad(colour, ((0, LANES - len(colour)), (0, 1))).astype(np.float32),
        np.pad(phase, ((0, 0), (0, LANES - phase.shape[1]))).astype(np.float32),
        matrix,
        each / shown,
    )


@table_of_field
def bands_in_groups(
    field: SourceField, above_m: float
) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """`AerosolBands.matrix` (groups, 4 * 4) and `kinds` (groups, n, kinds * 4) as kernels take
    them."""
    bands = _bands(field, above_m)
    return _in_groups(bands.matrix), _in_lanes_by_kind(bands.kinds)


class ChannelPhases(NamedTuple):
    """Phase functions in sr^-1 of particles, uniform in sqrt((1 - nu) / 2), float32.

    `channels` (n, 3): in red, green and blue of their light, which change as those of each kind
    and wavelength do, `lanes` (groups, n, kinds * 4).
    """

    channels: NDArray[np.float32]
    lanes: NDArray[np.float32]


def channel_phases(field: SourceField, altitude_m: float) -> ChannelPhases:
    """The phase functions of a field's particles before things near an eye at an altitude."""
    # Air before objects is denser than the mean above the eye.
    return _channels(field, 0.5 * mean_above_m(field.atmosphere, altitude_m))


@table_of_field
def _channels(field: SourceField, above_m: float) -> ChannelPhases:
    each, shown = _phases(field, above_m)
    channels = shown @ channel_shares(field.atmosphere)
    return ChannelPhases(channels.astype(np.float32), _in_lanes_by_kind(each))


def mean_above_m(atmosphere: Atmosphere, altitude_m: float) -> float:
    """Altitude above which the mean phase function is taken: ratios to it change slowly with the
    angle, as nodes far apart want. From space all of the air is seen."""
    in_air = atmosphere.mixed and altitude_m <= atmosphere.top_altitude_m
    return altitude_m if in_air else 0.0


def _phases(field: SourceField, above_m: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Phase functions (kinds, n, C) of the particles' kinds, and their mean (n, C) above an
    altitude."""
    each, share = _by_kind(field), shares_above(field.atmosphere, field.sizes.degree, above_m)
    return each, np.einsum("kc,knc->nc", share, each)


@table_of_field
def _by_kind(field: SourceField) -> NDArray[np.float64]:
    nu = 1.0 - 2.0 * np.linspace(0.0, 1.0, PHASE_NODES) ** 2
    return kind_phases(field.atmosphere, field.sizes.degree, nu)


def _in_lanes_by_kind(each: NDArray[np.float64]) -> NDArray[np.float32]:
    """(kinds, n, C) as float32 (groups, n, kinds * 4)."""
    lanes = np.moveaxis(in_lanes(each), 1, 2)
    return np.ascontiguousarray(lanes.reshape(*lanes.shape[:2], -1), dtype=np.float32)


def channel_shares(atmosphere: Atmosphere) -> NDArray[np.float64]:
    """Share (C, 3) of each wavelength in red, green and blue of sunlight off aerosol."""
    scattered = np.add(atmosphere.mie_scattering, atmosphere.aloft_scattering)
    light = np.asarray(atmosphere.solar_irradiance) * scattered
    if not light.any():
        light = np.asarray(atmosphere.solar_irradiance)
    one_each = np.eye(len(atmosphere.wavelength_nm))
    coloured = rgb_from_spectrum(one_each, atmosphere.wavelength_nm, SKYLIGHT_EXPONENT)
    coloured = np.maximum(coloured * light[:, None], 0.0)
    return np.asarray(coloured / coloured.sum(axis=0))


@table_of_field
def _sources(field: SourceField) -> list[tuple[WavelengthGroup, "Source"]]:
    """Air and source function of each group of wavelengths."""
    airs = groups_of_air(field.thinned)
    return [(air, source_of_group(field, k)) for k, air in enumerate(airs)]


@table_of_field
def colours_of(field: SourceField) -> tuple[NDArray[np.float32], list[GroundColours]]:
    """Colours (groups, 4 * 4) of the wavelengths in skylight, and of the ground under any sun."""
    air, wavelength_nm = field.atmosphere, field.atmosphere.wavelength_nm
    one_each = np.eye(len(wavelength_nm))
    skylight = rgb_from_spectrum(one_each, wavelength_nm, SKYLIGHT_EXPONENT)
    sunlight = rgb_from_spectrum(one_each, wavelength_nm, SUNLIGHT_EXPONENT)
    suns = SunGrid(air, _SUNS)
    light = ground_radiance(field, suns.mu_s)
    coloured = light.sun[..., None] * sunlight + light.sky[..., None] * skylight
    grid, mu_s = suns.constants(), suns.mu_s.astype(np.float32)
    ground = (GroundColours(mu_s, grid, part) for part in _in_groups(coloured))
    return _in_groups(skylight), list(ground)


def _in_groups(colours: NDArray[np.float64]) -> NDArray[np.float32]:
    """(..., C, n) as float32 (groups, ... * 4 * 4), filled up with black and with zeros."""
    padding, pad = -colours.shape[-2] % LANES, 4 - colours.shape[-1]
    padded = np.pad(colours, [*[(0, 0)] * (colours.ndim - 2), (0, padding), (0, pad)])
    groups = np.moveaxis(padded.reshape(*padded.shape[:-2], -1, LANES, 4), -3, 0)
    return np.ascontiguousarray(groups.reshape(len(groups), -1), dtype=np.float32)


def fill_cube(
    view: SkyView, size: int, ground_radiance_rgb: NDArray[np.float64]
) -> NDArray[np.float32]:
    """Cube map (6, size, size, 3) of the surroundings, in world axes.

    Where the table has no rows below the horizon, `ground_radiance_rgb` (3,) is there.
    """
    cube = np.empty((6, size, size, 3), dtype=np.float32)
    sun = np.concatenate([view.sun_direction, level_direction(view.sun_direction)])
    ground = np.asarray(ground_radiance_rgb, dtype=np.float32)
    centres = texel_centres(size).astype(np.float32)
    horizon = view.depth.astype(np.float32)
    fill_faces(
        view.nodes, view.shape, horizon, sun.astype(np.float32), view.bands.phase.reshape(-1),
        view.bands.colour.reshape(-1), _AXES, centres, ground, cube,
    )  # fmt: skip
    return cube


def level_direction(direction: NDArray[np.float64]) -> NDArray[np.float64]:
    """The unit vector (x, z) of a direction's azimuth; north under a zenith, which has none."""
    level = direction[[0, 2]]
    length = float(np.hypot(*level))
    return level / length if length > 1e-12 else np.array([0.0, -1.0])
