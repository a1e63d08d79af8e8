"""Melanopic light of a year at sensors.

The year's light is a sum of six spectra (`year_spectra.py`), so that each matrix of the year is a
sum over wavelengths, weighted by a spectrum and the eye's response. Transport is solved at every
other wavelength, is linear between, for reflectances are smooth, and is solved for groups of cells
and of suns. The direct sun is that of the year in colours unless glass has a colour.
"""

from typing import NamedTuple

import numpy as np
from light_transport.public import EDGE, GROUND_NODE, CancelCheck, always
from scipy.sparse import csr_matrix

from daylight_numbers.glazing.glass import Glass
from daylight_numbers.now import sun_shares
from daylight_numbers.sky_cells import cell_of, node_of_cell
from daylight_numbers.spectra.eye_responses import (
    MELANOPIC,
    alpha_opic_efficacy_of_d65,
    response_matrix,
)
from daylight_numbers.spectra.spectral_sky import WAVELENGTHS_NM
from daylight_numbers.spectra.spectral_surfaces import SpectralSurfaces, bands
from daylight_numbers.spectra.tinted_light import through_glass
from daylight_numbers.spectra.year_spectra import YearSpectra, melanopic
from daylight_numbers.work import DaylightWork
from daylight_numbers.year.year import (
    SolvedYear,
    Year,
    brought,
    radiosities,
    sky_matrix,
    suns_of_hours,
)
from daylight_numbers.year.year_light import DAYS, HOURS, YearLight
from vrut_lite.geometry.colour import LUMENS_PER_WATT, luminance
from vrut_lite.numeric_types import Float32Array, FloatArray, IntArray

# Numbers of the wavelengths at which transport is solved.
_SOLVED = np.arange(0, len(WAVELENGTHS_NM), 2)
# Edge of the squares of the sky's cells that are solved as one.
_EDGE = 4
_GREEN = 1
_SENSORS_AT_ONCE = 64
_FROM_H, _TO_H, _NOON_H = 8, 18, 12
# Brown et al. 2022, "Recommendations for daytime, evening, and nighttime indoor light exposure":
# 250 lx by day; WELL v2, L03: 136 or 250 lx in four hours that begin by noon.
DAY_LX, WELL_LX, WELL_H = 250.0, 136.0, 4


class _Groups:
    """Lights (L) in groups (G), which are solved as one at each wavelength.

    In a group light is spread over its lights as the green light of the year in colours is.
    """

    def __init__(self, group: IntArray, green: Float32Array):
        """`group` (L,) of each light, and green radiosity (M, L) by each."""
        _, self._group = np.unique(group, return_inverse=True)
        count = int(self._group.max(initial=-1)) + 1
        shape = len(group), count
        self._members = csr_matrix(
            (np.ones(len(group), np.float32), (np.arange(len(group)), self._group)), shape
        )
        whole = green @ self._members
        each = whole[:, self._group]
        even = 1.0 / np.maximum(np.bincount(self._group, minlength=count), 1)
        self._share = np.where(
            each > 0.0, green / np.where(each > 0.0, each, 1.0), even[self._group]
        ).astype(np.float32)

    def sums(self, lights: FloatArray | Float32Array) -> list[FloatArray]:
        """First light (M,) of each group, by that of each light (M, L)."""
        return list(np.asarray((lights @ self._members).T, float))

    def spread(self, by_groups: Float32Array) -> Float32Array:
        """Radiosity (3, M, L) by each light, by that of groups (3, M, G)."""
        return by_groups[:, :, self._group] * self._share


class SpectralYear(NamedTuple):
    """Melanopic EDI (P, H) in lx of the hours of a `YearLight`: by all rays, and by either half."""

    total: Float32Array
    halves: tuple[Float32Array, Float32Array]


def spectral_year(
    work: DaylightWork,
    light: YearLight,
    spectra: YearSpectra,
    surfaces: SpectralSurfaces,
    solved: SolvedYear,
    year: Year,
    tolerance: float,
    go_on: CancelCheck = always,
) -> SpectralYear:
    """A year's melanopic light at sensors.

    Args:
        work: of the scene, without measured panes.
        light: the year in colours, and `spectra` of it.
        surfaces: spectra of surfaces and glass.
        solved: suns and cells of the year in colours.
        year: illuminance of the same hours.
        tolerance: as of the work; it rules the rays through coloured glass.
        go_on: called between steps.

    Raises:
        GivenUp: by `go_on`.
    """
    transport = work.transport
    assert transport.patches is not None
    weight = _hats() * _melanopic_weights()
    of_sky, of_sun = (part @ weight.T for part in (spectra.sky, spectra.sun))
    nodes, suns = len(solved.sent_by_cells.T), len(solved.sunlit)
    count = len(work.sensors)
    sky = np.zeros((2, 3, count, nodes), np.float32)
    sun = np.zeros((2, 3, count, suns), np.float32)
    direct = np.zeros((count, len(light.hour)), np.float32)
    if not surfaces.glass_is_own:
        direct += year.sun * _melanopic_of_sun(light, spectra)
    reflectance = surfaces.reflectance.copy()
    reflectance[transport.patches.on_ground] = spectra.albedo
    cells = _Groups(_groups_of_nodes(), solved.by_sky[_GREEN])
    groups = _Groups(_groups_towards(solved.sun_direction), solved.by_suns[_GREEN])
    for at in through_glass(work, surfaces, tolerance, bands(_SOLVED)):
        go_on()
        k = at.bands.columns
        colours = reflectance[:, k].astype(np.float32)
        by_sky = cells.spread(radiosities(at, cells.sums(solved.sent_by_cells), colours, go_on))
        by_suns = groups.spread(radiosities(at, groups.sums(solved.sunlit.T), colours, go_on))
        for n, half in enumerate(at.operator.halves):
            seen, lit = sky_matrix(half, by_sky), brought(half, by_suns)
            for c, column in enumerate(at.bands.own):
                node = np.searchsorted(_SOLVED, column)
                sky[n] += of_sky[:, node].astype(np.float32)[:, None, None] * seen[c]
                sun[n] += of_sun[:, node].astype(np.float32)[:, None, None] * lit[c]
        if surfaces.glass_is_own:
            weights = of_sun[:, np.searchsorted(_SOLVED, at.bands.own)]
            direct += _direct(work, at.glass, light, weights)
    halves = [direct.copy(), direct.copy()]
    for n, total in enumerate(halves):
        for r in range(3):
            total += sky[n, r] @ np.ascontiguousarray(light.sky[:, :, r].T)
            irradiance = light.sun_irradiance_rgb[:, r]
            spread = suns_of_hours(solved.near, solved.share, irradiance, suns)
            total += (spread.T @ sun[n, r].T).T
        np.maximum(total, 0.0, out=total)
    return SpectralYear(np.float32(0.5) * (halves[0] + halves[1]), (halves[0], halves[1]))


def melanopic_columns(found: SpectralYear, light: YearLight) -> dict[str, FloatArray]:
    """Columns (P,) in percent of a year's melanopic light.

    Share of the 3,650 hours from 8:00 to 18:00 with 250 lx, and its error by rays; share of the 365
    days with 250 lx, or 136 lx, in four hours in a row that begin by noon.
    """
    one, other = (_share_of_hours(half, light) for half in found.halves)
    return {
        "melanopic_250_percent": 100.0 * _share_of_hours(found.total, light),
        "melanopic_250_error_percent": 50.0 * np.abs(one - other),
        "melanopic_250_days_percent": 100.0 * _share_of_days(found.total, light, DAY_LX),
        "melanopic_136_days_percent": 100.0 * _share_of_days(found.total, light, WELL_LX),
    }


def _share_of_hours(edi_lx: Float32Array, light: YearLight) -> FloatArray:
    clock = light.hour % HOURS
    occupied = (clock >= _FROM_H) & (clock < _TO_H)
    return np.asarray((edi_lx[:, occupied] >= DAY_LX).sum(axis=1) / (DAYS * (_TO_H - _FROM_H)))


def _share_of_days(edi_lx: Float32Array, light: YearLight, least_lx: float) -> FloatArray:
    has_light = np.zeros((len(edi_lx), DAYS * HOURS), bool)
    has_light[:, light.hour] = edi_lx >= least_lx
    days = has_light.reshape(len(edi_lx), DAYS, HOURS)
    begins = days[:, :, : _NOON_H + 1].copy()
    for later in range(1, WELL_H):
        begins &= days[:, :, later : later + _NOON_H + 1]
    return np.asarray(begins.any(axis=2).mean(axis=1))


def _direct(
    work: DaylightWork, glass: Glass, light: YearLight, weights: FloatArray
) -> Float32Array:
    """Melanopic EDI (P, H) of the sun straight through glass, at some wavelengths (3, K)."""
    found = np.zeros((len(work.sensors), len(light.hour)), np.float32)
    of_hours = (light.sun_irradiance_rgb @ weights).astype(np.float32)
    for first in range(0, len(work.sensors), _SENSORS_AT_ONCE):
        some = np.arange(first, min(first + _SENSORS_AT_ONCE, len(work.sensors)))
        shares = sun_shares(work.transport, glass, work.sensors.some(some), light.sun_direction)
        found[some] = np.einsum("phk,hk->ph", shares[..., : weights.shape[1]], of_hours)
    return found


def _groups_of_nodes() -> IntArray:
    """The group (GROUND_NODE + 1,) of each of the ray table's cells; open ground is its own."""
    row, column = np.divmod(np.arange(GROUND_NODE), EDGE)
    return np.append(row // _EDGE * EDGE + column // _EDGE, EDGE * EDGE)


def _groups_towards(directions: FloatArray) -> IntArray:
    """The group (S,) of the cell in each direction (S, 3)."""
    if not len(directions):
        return np.zeros(0, np.int64)
    return np.asarray(_groups_of_nodes()[node_of_cell()[cell_of(directions)]])


def _melanopic_weights() -> FloatArray:
    """Weights (W,) by which spectral irradiance becomes melanopic EDI in lx."""
    matrix = response_matrix(WAVELENGTHS_NM)
    return np.asarray(matrix[:, 3 + MELANOPIC] / alpha_opic_efficacy_of_d65()[MELANOPIC])


def _hats() -> FloatArray:
    """Shares (S, W) of solved wavelengths in all of them, linear between."""
    nm = np.array(WAVELENGTHS_NM)
    return np.stack([np.interp(nm, nm[_SOLVED], unit) for unit in np.eye(len(_SOLVED))])


def _melanopic_of_sun(light: YearLight, spectra: YearSpectra) -> FloatArray:
    """Melanopic EDI (H,) of a lux of sunlight."""
    lux = luminance(light.sun_irradiance_rgb) * LUMENS_PER_WATT
    edi = melanopic(light.sun_irradiance_rgb @ spectra.sun)
    return np.maximum(np.divide(edi, lux, out=np.zeros_like(edi), where=lux > 0.0), 0.0)
