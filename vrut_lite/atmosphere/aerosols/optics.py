"""Optical properties of the whole aerosol above a place by wavelength, as skies use them."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from vrut_lite.arguments import as_number, as_numbers
from vrut_lite.atmosphere.aerosol import ANGSTROM_EXPONENT, SCALE_HEIGHT_M, cornette_shanks_phase
from vrut_lite.atmosphere.aerosols.components import Particles
from vrut_lite.atmosphere.aerosols.phase_table import PhaseTable
from vrut_lite.numeric_types import FloatArray

_550_NM = 550.0
# Scale height of aerosol in the free troposphere: the mean altitude of OPAC's layer, which has a
# scale height of 8 km and ends at 12 km. An exponential of 8 km would go on to where twilight is
# lit: with it the ground gets 1.5 to 2.3 times the light under suns 6 to 12 degrees down.
ALOFT_HEIGHT_M = 6000.0
# Least optical depth in Angstrom's law between two neighbours, which divides by it.
_LEAST_DEPTH = 1e-12


@dataclass(frozen=True, eq=False)
class AerosolLayer:
    """Aerosol above a place by wavelength (C,), rising: one layer.

    Attributes:
        wavelength_nm: wavelengths of the values; outside, the nearest value holds.
        optical_depth: (C,), vertical; 0 throughout without aerosol.
        albedo: (C,) single scattering albedo.
        phase: phase functions, a row for each wavelength.
        height_m: the scale height of an exponential layer, or the half width of a tent.
        peak_m: altitude of the tent's peak; None if the layer is exponential.
    """

    wavelength_nm: FloatArray
    optical_depth: FloatArray
    albedo: FloatArray
    phase: PhaseTable
    height_m: float
    peak_m: float | None = None

    def depth_at(self, wavelength_nm: ArrayLike) -> FloatArray:
        """Optical depth (n,): Angstrom's law between neighbours."""
        if not self.optical_depth.any():
            return np.zeros(np.shape(wavelength_nm))
        log_depth = np.log(np.maximum(self.optical_depth, _LEAST_DEPTH))
        place = np.log(np.asarray(wavelength_nm, dtype=float))
        return np.asarray(np.exp(np.interp(place, np.log(self.wavelength_nm), log_depth)))

    def albedo_at(self, wavelength_nm: ArrayLike) -> FloatArray:
        """Single scattering albedo (n,), linear between neighbours."""
        return np.interp(np.asarray(wavelength_nm, dtype=float), self.wavelength_nm, self.albedo)

    def phase_at(self, wavelength_nm: ArrayLike) -> PhaseTable:
        """The phase table of wavelengths (n,), linear between neighbours."""
        index = np.arange(self.wavelength_nm.size)
        place = np.interp(np.asarray(wavelength_nm, dtype=float), self.wavelength_nm, index)
        return self.phase.at_rows(np.maximum(1.0 - np.abs(place[:, None] - index), 0.0))


@dataclass(frozen=True, eq=False, kw_only=True)
class AerosolOptics(AerosolLayer):
    """All the aerosol of the troposphere: sums and means of its two layers.

    Attributes:
        layers: the lower one, whose scale height gives the same depth and the same extinction at
            the ground, and that of the free troposphere.
    """

    layers: tuple[AerosolLayer, AerosolLayer]

    @property
    def optical_depth_550(self) -> float:
        """The depth at 550 nm."""
        return float(self.depth_at([_550_NM])[0])

    @property
    def angstrom_exponent(self) -> float:
        """Angstrom's exponent between 445 and 635 nm."""
        blue, red = self.depth_at([445.0, 635.0])
        return float(np.log(blue / red) / np.log(635.0 / 445.0))


def optics_of_particles(lower: Particles, upper: Particles, lower_height_m: float) -> AerosolOptics:
    """The optics of two layers, given as columns: extinction and scattering are depths."""
    low, aloft = layer_of(lower, lower_height_m), layer_of(upper, ALOFT_HEIGHT_M)
    both = layer_of(lower.with_others(upper), lower_height_m)
    return AerosolOptics(**vars(both), layers=(low, aloft))


def layer_of(column: Particles, height_m: float, peak_m: float | None = None) -> AerosolLayer:
    """A layer of particles, given as a column: extinction and scattering are depths."""
    none = np.zeros_like(column.extinction)
    return AerosolLayer(
        column.wavelength_nm,
        column.extinction,
        np.divide(column.scattering, column.extinction, out=none, where=column.extinction > 0.0),
        PhaseTable.of_angles(
            column.angle_rad, column.phase, [column.p12 / column.phase, column.p33 / column.phase]
        ),
        height_m,
        peak_m,
    )


def optics_of_aerosol(
    optical_depth_550: float,
    albedo: float,
    phase: PhaseTable | float,
    angstrom_exponent: float = ANGSTROM_EXPONENT,
    scale_height_m: float = SCALE_HEIGHT_M,
) -> AerosolOptics:
    """Optical properties of an aerosol given by a few numbers.

    Args:
        optical_depth_550: vertical, at 550 nm, above 0.
        albedo: single scattering albedo, 0 to 1.
        phase: a table of one row, or g of Cornette and Shanks' phase function.
        angstrom_exponent: the depth falls as wavelength to minus that.
        scale_height_m: over which its extinction falls by a factor e.

    Raises:
        ValueError: a number is out of range, or the table has several rows.
    """
    depth = as_number("optical_depth_550", optical_depth_550, _LEAST_DEPTH, 1000.0)
    part = as_number("albedo", albedo, 0.0, 1.0)
    exponent = as_number("angstrom_exponent", angstrom_exponent, -10.0, 10.0)
    height_m = as_number("scale_height_m", scale_height_m, 1.0, 1e6, "m")
    table = phase if isinstance(phase, PhaseTable) else _one_lobe(phase)
    if len(table.values) != 1:
        raise ValueError("the phase table of an aerosol of one's own must have one row")
    # Angstrom's law needs its two ends only.
    wavelength = np.array([100.0, 10_000.0])
    all_of_it = AerosolLayer(
        wavelength,
        depth * (wavelength / _550_NM) ** -exponent,
        np.full(2, part),
        table.at_rows(np.ones((2, 1))),
        height_m,
    )
    none = replace(all_of_it, optical_depth=np.zeros(2), height_m=ALOFT_HEIGHT_M)
    return AerosolOptics(**vars(all_of_it), layers=(all_of_it, none))


def _one_lobe(g: float) -> PhaseTable:
    asymmetry = float(as_numbers("phase of the aerosol, g,", g, -0.99, 0.99))
    return PhaseTable.of_function(lambda nu: cornette_shanks_phase(nu, asymmetry))
