"""Transfer of light between the cells of Haber's air, from the sun, and to the viewer.

Between cells it is computed at the authors' eight wavelengths, once for all suns: rings are even
in azimuth about the sun, and what passes from one to another depends on the turn between two
cells alone. So azimuths are taken apart into harmonics, which do not mix.
"""

from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np
from numpy.typing import NDArray

from vrut_lite.atmosphere.aerosol import cornette_shanks_factor
from vrut_lite.numeric_types import FloatArray
from vrut_lite_lab.study.framework.atmosphere import StudyAtmosphere
from vrut_lite_lab.study.framework.spectra import WAVELENGTHS_NM
from vrut_lite_lab.study.models.haber_cells import (
    HALF,
    STEP_RAD,
    RingCells,
    cell_azimuths,
    make_cells,
)
from vrut_lite_lab.study.models.haber_kernels import from_aerosol, layered_paths, ring_paths

EVENLY = 1.0 / (4.0 * np.pi)
# Eight of the 40 wavelengths.
FEW = np.round(np.linspace(0, WAVELENGTHS_NM.size - 1, 8)).astype(int)
# Relative density below which aerosol is not worth its phase function, 8 km up: it adds
# up to 1e-4 of the sky.
_LEAST_AEROSOL = 1e-3


@dataclass(frozen=True, eq=False)
class Transfer:
    """Transfer of light between cells, from the sun, and to the viewer."""

    air: StudyAtmosphere

    @cached_property
    def cells(self) -> RingCells:
        """The cells between which light passes."""
        return make_cells(self.air)

    def sunlight(self, point_m: FloatArray, sun_zenith_rad: float) -> FloatArray:
        """Share (n, 40) of sunlight that arrives at points (n, 3)."""
        sun = np.array([np.sin(sun_zenith_rad), 0.0, np.cos(sun_zenith_rad)])
        # The rounding of the top's radius must not end a path above it.
        top = self.cells.layers.bounds_m[-1] - 1.0
        along = point_m @ sun
        beyond = top**2 - (point_m**2).sum(axis=-1) + along**2
        distance = np.sqrt(np.maximum(beyond, 0.0)) - along
        return self.transmittance(point_m, point_m + distance[:, None] * sun)

    def transmittance(self, start_m: FloatArray, end_m: FloatArray) -> FloatArray:
        """Share (n, 40) of light that passes between points (n, 3), through the layers."""
        layers = self.cells.layers
        paths = layered_paths(start_m, end_m, layers.bounds_m, layers.density)
        return np.exp(
            -(paths.T @ np.stack([self.air.rayleigh_scattering, self.air.mie_extinction]))
        )

    @cached_property
    def paths(self) -> NDArray[np.float32]:
        """Optical paths (2, m, m, 37) between active rings, by turns from cell to cell."""
        cells, active, layers = self.cells, self.cells.active, self.cells.layers
        turn = np.arange(HALF + 1) * STEP_RAD
        there = cells.across_m[active], cells.up_m[active], turn
        return np.asarray(ring_paths(*there, layers.bounds_m, layers.density))

    @cached_property
    def evenly(self) -> NDArray[np.float32]:
        """Transfer between active rings, (8, 36, m, m) in 1/m^2, by harmonic of azimuth.

        A ring is even in azimuth about the sun, and what passes depends on the turn alone:
        harmonics do not mix.
        """
        cells, active = self.cells, self.cells.active
        across, up = cells.across_m[active], cells.up_m[active]
        turn = np.arange(HALF + 1)
        angle = turn * STEP_RAD
        level = across[:, None, None] ** 2 + across[:, None] ** 2
        level = level - 2.0 * np.multiply.outer(np.multiply.outer(across, across), np.cos(angle))
        squared = level + (up[:, None, None] - up[:, None]) ** 2
        itself = np.arange(active.size)
        # A cell sends nothing to itself.
        squared[itself, itself, 0] = np.inf
        # All turns but none and half a circle come both ways.
        sides = np.where(turn % HALF == 0, 1.0, 2.0)
        harmonics = sides[:, None] * np.cos(np.multiply.outer(angle, np.arange(HALF)))
        kernel = np.empty((FEW.size, HALF, active.size, active.size), np.float32)
        for c, wavelength in enumerate(FEW):
            depth = self.paths[0] * np.float32(self.air.rayleigh_scattering[wavelength])
            depth += self.paths[1] * np.float32(self.air.mie_extinction[wavelength])
            passed = (np.exp(-depth) / squared).astype(np.float32)
            kernel[c] = np.moveaxis(passed @ harmonics.astype(np.float32), -1, 0)
        return kernel

    def from_everywhere(self, power: FloatArray) -> FloatArray:
        """Irradiance (8, m, 36) of active cells by all that scatter powers (8, m, 36) evenly."""
        basis = _harmonics()
        waves = np.moveaxis(power @ basis.T, -1, 1)[..., None].astype(np.float32)
        arriving = np.moveaxis((self.evenly @ waves)[..., 0], 1, -1)
        return EVENLY * (arriving @ basis)

    def from_aerosol(self, power: FloatArray, sun_zenith_rad: float) -> FloatArray:
        """The same of sunlight that aerosol scatters, after its phase function."""
        cells, active = self.cells, self.cells.active
        sources = np.flatnonzero(cells.density[1, active] > _LEAST_AEROSOL)
        extinction = np.stack([self.air.rayleigh_scattering, self.air.mie_extinction])[:, FEW]
        around = np.concatenate([power, power[..., ::-1], power], axis=-1)[:, sources]
        g, azimuth = self.air.mie_g, cell_azimuths()
        arriving = from_aerosol(
            cells.across_m[active],
            cells.up_m[active],
            sources,
            np.ascontiguousarray(around.swapaxes(0, 1), dtype=np.float32),
            self.paths,
            extinction.astype(np.float32),
            (float(np.sin(sun_zenith_rad)), float(np.cos(sun_zenith_rad))),
            tuple(map(np.float32, (cornette_shanks_factor(g), (1.0 - g) ** 2, 2.0 * g))),
            np.cos(azimuth).astype(np.float32),
            np.sin(azimuth).astype(np.float32),
        )
        return np.asarray(arriving.swapaxes(0, 1), dtype=float)


@lru_cache(maxsize=1)
def transfer_through(air: StudyAtmosphere) -> Transfer:
    """The transfer of an atmosphere; 350 MB, so that there is but one."""
    return Transfer(air)


@lru_cache(maxsize=1)
def _harmonics() -> FloatArray:
    """Orthonormal cosines (36, 36) of the azimuths of half a ring, row by row."""
    wave = np.cos(np.multiply.outer(np.arange(HALF), cell_azimuths()))
    scale = np.where(np.arange(HALF) == 0, 1.0, 2.0) / HALF
    return np.asarray(wave * np.sqrt(scale)[:, None])
