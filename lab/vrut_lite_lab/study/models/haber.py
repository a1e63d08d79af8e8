"""Haber, Magnor and Seidel 2005: "Physically-based simulation of twilight phenomena".

The air is cut into cells about the viewer (`haber_cells`). Each scatters sunlight, evenly for
molecules and forward for aerosol; then three times cells light each other, and scatter evenly.
The sky is a dome of 5 degrees. No light comes from the ground. As Bruneton 2016 compares it,
except that light scattered often is computed at the authors' eight wavelengths and not at 40.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from bruneton_sky.tables.interpolate import interpolate

from vrut_lite.atmosphere.aerosol import cornette_shanks_phase
from vrut_lite.numeric_types import FloatArray, IntArray
from vrut_lite_lab.study.framework.atmosphere import STUDY, StudyAtmosphere
from vrut_lite_lab.study.framework.spectra import WAVELENGTHS_NM
from vrut_lite_lab.study.models.haber_cells import (
    ACTIVE_EACH,
    STEP_RAD,
    RingCells,
    cell_azimuths,
    zenith_angles,
)
from vrut_lite_lab.study.models.haber_transfer import EVENLY, FEW, Transfer, transfer_through

_ORDERS = 4


@dataclass(frozen=True, eq=False)
class Haber:
    """The sky of an atmosphere.

    Args:
        quirks: scale the light that passes between cells as the published program does: for
            the shells left out by all cells' power over that of the cells taken, which is 50
            because of vast cells behind the horizon and ought to be 4; and by 1 / (4 pi) once
            too often. The two almost cancel.
    """

    quirks: bool = False
    air: StudyAtmosphere = STUDY

    @property
    def name(self) -> str:
        """`haber`, or `haber-published`."""
        return "haber-published" if self.quirks else "haber"

    @property
    def title(self) -> str:
        """As in `Haber 2005 (as published)`."""
        return "Haber 2005" + (" (as published)" if self.quirks else "")

    def sky_radiance(
        self,
        sun_zenith_rad: float,
        view_zenith_rad: FloatArray,
        relative_azimuth_rad: FloatArray,
    ) -> FloatArray:
        """Radiance (n, 40), linear between the dome's directions."""
        dome = _dome(self.air, float(sun_zenith_rad), self.quirks)
        from_sun = np.abs(np.mod(relative_azimuth_rad + np.pi, 2.0 * np.pi) - np.pi)
        place = view_zenith_rad / (len(dome) * STEP_RAD), from_sun / np.pi
        return interpolate(dome, place) * self.air.solar_irradiance

    def sun_irradiance(self, sun_zenith_rad: float) -> FloatArray:
        """Irradiance (40,), through the layers, 1 m above the ground."""
        viewer = np.array([[0.0, 0.0, self.air.ground_radius_m + 1.0]])
        arriving = transfer_through(self.air).sunlight(viewer, sun_zenith_rad)[0]
        return np.asarray(arriving * self.air.solar_irradiance)


@lru_cache(maxsize=32)
def _dome(air: StudyAtmosphere, sun_zenith_rad: float, quirks: bool) -> FloatArray:
    """Radiance (19, 36, 40) per unit of solar irradiance, by zenith angle and azimuth."""
    transfer = transfer_through(air)
    cells = transfer.cells
    centre = cells.centres
    sunlight = transfer.sunlight(centre.reshape(-1, 3), sun_zenith_rad)
    sunlight = sunlight.reshape(*centre.shape[:2], -1) * cells.volume_m3[:, None, None]
    molecules, aerosol = (
        sunlight * np.multiply.outer(density, coefficient)[:, None]
        for density, coefficient in zip(
            cells.density, (air.rayleigh_scattering, air.mie_scattering), strict=True
        )
    )
    often = _scattered_often(transfer, molecules, aerosol, sun_zenith_rad, quirks)
    zenith, azimuth = zenith_angles(air)[cells.zenith][:, None], cell_azimuths()
    nu = np.sin(zenith) * np.sin(sun_zenith_rad) * np.cos(azimuth)
    nu = nu + np.cos(zenith) * np.cos(sun_zenith_rad)
    forward = cornette_shanks_phase(nu, air.mie_g)[..., None]
    viewer = np.broadcast_to([0.0, 0.0, air.ground_radius_m], (len(centre), 3))
    clear = transfer.transmittance(np.ascontiguousarray(viewer), centre[:, 0])
    seen = (clear * (cells.depth_m / cells.volume_m3)[:, None])[:, None]
    once = _by_zenith(cells, seen * (EVENLY * molecules + forward * aerosol))
    return once + _at_all_wavelengths(_by_zenith(cells, seen[..., FEW] * EVENLY * often))


def _scattered_often(
    transfer: Transfer,
    molecules: FloatArray,
    aerosol: FloatArray,
    sun_zenith_rad: float,
    quirks: bool,
) -> FloatArray:
    """Power (n, 36, 8) of light that cells scatter the second to fourth time.

    Every active cell stands for those of its neighbouring shells too, whose power is
    interpolated.
    """
    air, cells, active = transfer.air, transfer.cells, transfer.cells.active
    evenly, forward = (np.moveaxis(power[..., FEW], -1, 0) for power in (molecules, aerosol))
    coefficients = np.stack([air.rayleigh_scattering, air.mie_scattering])[:, FEW]
    scattering = (coefficients.T @ cells.density)[:, active] * cells.volume_m3[active]
    last = evenly + forward
    total = np.zeros_like(last)
    for order in range(2, _ORDERS + 1):
        if order == 2:
            arriving = transfer.from_everywhere(evenly[:, active])
            arriving += transfer.from_aerosol(forward[:, active], sun_zenith_rad)
        else:
            arriving = transfer.from_everywhere(last[:, active])
        shells_each = _published_scale(air, last, active) if quirks else ACTIVE_EACH
        last = _to_all_shells(cells, shells_each * scattering[..., None] * arriving)
        total += last
    return np.moveaxis(total, 0, -1)


def _published_scale(air: StudyAtmosphere, power: FloatArray, active: IntArray) -> float:
    """By all of the powers (8, n, 36) over the active ones' share, and 4 pi too small."""
    sunlit = power * air.solar_irradiance[FEW, None, None]
    return float(EVENLY * sunlit.sum() / sunlit[:, active].sum())


def _to_all_shells(cells: RingCells, power: FloatArray) -> FloatArray:
    """Powers (8, n, 36) of those of active rings, (8, m, 36), linear between their shells.

    Where there is no such shell on one side, as the one on the other.
    """
    place = np.full((cells.zenith.max() + 1, cells.shell.max() + 1 + ACTIVE_EACH), -1)
    place[cells.zenith[cells.active], cells.shell[cells.active]] = np.arange(cells.active.size)
    part = (cells.shell % ACTIVE_EACH) / ACTIVE_EACH
    low = cells.shell - cells.shell % ACTIVE_EACH
    before, after = place[cells.zenith, low], place[cells.zenith, low + ACTIVE_EACH]
    near = np.where(before < 0, after, before)
    far = np.where(after < 0, before, after)
    weight = part[:, None]
    spread = (1.0 - weight) * power[:, near] + weight * power[:, far]
    return np.where((near >= 0)[:, None], spread, 0.0)


def _by_zenith(cells: RingCells, seen: FloatArray) -> FloatArray:
    """Sums (19, 36, C) over the shells of (n, 36, C)."""
    first = np.flatnonzero(np.diff(cells.zenith, prepend=-1))
    return np.asarray(np.add.reduceat(seen, first, axis=0))


def _at_all_wavelengths(few: FloatArray) -> FloatArray:
    """Spectra (..., 40) of (..., 8), of powers of the wavelength between them."""
    nodes, wanted = np.log(WAVELENGTHS_NM[FEW]), np.log(WAVELENGTHS_NM)
    place = np.interp(wanted, nodes, np.arange(nodes.size))
    low = np.minimum(place.astype(int), nodes.size - 2)
    log_few = np.log(np.maximum(few, np.finfo(float).tiny))
    return np.exp(log_few[..., low] + (place - low) * (log_few[..., low + 1] - log_few[..., low]))
