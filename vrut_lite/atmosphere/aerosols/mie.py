"""Spheres by Mie's theory: aerosol from its sizes and refractive index, as AERONET inverts them.

Needs miepython (`pip install vrut_lite[aerosols]`).
"""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from vrut_lite.arguments import as_number, as_numbers
from vrut_lite.atmosphere.aerosol import SCALE_HEIGHT_M
from vrut_lite.atmosphere.aerosols.components import Particles
from vrut_lite.atmosphere.aerosols.optics import AerosolOptics, optics_of_particles
from vrut_lite.errors import UserError
from vrut_lite.numeric_types import FloatArray

# Radii per e-fold between which the sizes are summed: the ripples of single spheres average out.
_PER_E_FOLD = 40
# Scattering angles: dense toward the sun, where large spheres diffract.
_ANGLES_RAD = np.radians(
    np.concatenate([np.arange(0, 5, 0.1), np.arange(5, 20, 0.5), np.arange(20, 181)])
)
_NM_PER_UM = 1000.0


def optics_of_sizes(
    radius_um: ArrayLike,
    volume_per_log_radius: ArrayLike,
    wavelength_nm: ArrayLike,
    refractive_index: ArrayLike,
    scale_height_m: float = SCALE_HEIGHT_M,
) -> AerosolOptics:
    """The optics of spheres above a place, by an inversion like AERONET's.

    Args:
        radius_um: (n,) rising.
        volume_per_log_radius: dV / dln r (n,), of the column, um^3 per um^2; linear in ln r
            between, none beyond.
        wavelength_nm: (C,) rising, two or more.
        refractive_index: (C,) complex; the imaginary part absorbs, whatever its sign.
        scale_height_m: scale height of the layer.

    Raises:
        ValueError: an argument is out of range, or lengths differ.
        UserError: miepython is not installed.
    """
    height_m = as_number("scale_height_m", scale_height_m, 1.0, 1e6, "m")
    radius = as_numbers("radius_um", radius_um, 1e-4, 1e3, "um")
    volume = as_numbers("volume_per_log_radius", volume_per_log_radius, 0.0, 1e6)
    wavelength = as_numbers("wavelength_nm", wavelength_nm, 100.0, 1e5, "nm")
    index = _refraction(refractive_index)
    if radius.ndim != 1 or radius.size < 2 or volume.shape != radius.shape:
        raise ValueError("radius_um and volume_per_log_radius must be two lists of one length")
    if wavelength.ndim != 1 or wavelength.size < 2 or index.shape != wavelength.shape:
        raise ValueError("wavelength_nm and refractive_index must be two lists of one length")
    if not ((np.diff(radius) > 0).all() and (np.diff(wavelength) > 0).all() and volume.any()):
        raise ValueError("radius_um and wavelength_nm must rise, and a volume must be above 0")
    count = max(int(np.ceil(np.log(radius[-1] / radius[0]) * _PER_E_FOLD)), 2)
    ln_r = np.linspace(np.log(radius[0]), np.log(radius[-1]), count + 1)
    r = np.exp(0.5 * (ln_r[:-1] + ln_r[1:]))
    # Spheres over a square um, by radius.
    spheres = np.interp(np.log(r), np.log(radius), volume) * np.diff(ln_r) / (4 / 3 * np.pi * r**3)
    column = spheres_together(r, spheres, wavelength, index)
    return optics_of_particles(column, column.times(0.0), height_m)


def _refraction(refractive_index: ArrayLike) -> NDArray[np.complex128]:
    """Complex refractive indices (C,), absorption as a negative imaginary part."""
    said = "refractive_index must be complex numbers with a real part from 0.1 to 10, not 1 itself"
    try:
        index = np.asarray(refractive_index, dtype=complex)
    except (TypeError, ValueError):
        raise ValueError(said) from None
    absorption = np.abs(index.imag)
    fits = (index.real >= 0.1) & (index.real <= 10.0) & (absorption <= 10.0) & (index != 1.0)
    if not fits.all():
        raise ValueError(said)
    # The sign convention of miepython.
    return np.asarray(index.real - 1j * absorption)


def lognormal_volume(
    radius_um: ArrayLike, mode_um: float, sigma: float, number: float = 1.0
) -> FloatArray:
    """dV / dln r (n,) of so many spheres whose numbers are lognormal about a mode radius.

    `sigma` is the geometric standard deviation, as OPAC gives it.
    """
    r, width = np.asarray(radius_um, dtype=float), np.log(sigma)
    share = np.exp(-0.5 * (np.log(r / mode_um) / width) ** 2) / (np.sqrt(2.0 * np.pi) * width)
    return np.asarray(number * share * 4.0 / 3.0 * np.pi * r**3)


def spheres_together(
    radius_um: FloatArray, spheres: FloatArray, wavelength_nm: FloatArray, index: ArrayLike
) -> Particles:
    """Optical properties of spheres (n,) over a square um; extinction and scattering are depths.

    The scattering matrix is that of Bohren and Huffman 1983, equation 4.77, with P12 < 0 where
    light vibrates across the scattering plane.
    """
    try:
        import miepython
    except ImportError as error:
        raise UserError(
            "aerosol from sizes needs the package miepython: pip install vrut_lite[aerosols]"
        ) from error

    refraction = _refraction(index)
    cosine = np.cos(_ANGLES_RAD)
    extinction, scattering = np.zeros((2, wavelength_nm.size))
    matrix = np.zeros((3, wavelength_nm.size, cosine.size))
    area = spheres * np.pi * radius_um**2
    for c, nm in enumerate(wavelength_nm):
        x = 2.0 * np.pi * radius_um * _NM_PER_UM / nm
        for k in np.flatnonzero(area):
            q_ext, q_sca, _, _ = miepython.efficiencies_mx(refraction[c], x[k])
            extinction[c] += area[k] * float(np.squeeze(q_ext))
            scattered = area[k] * float(np.squeeze(q_sca))
            scattering[c] += scattered
            one = miepython.phase_matrix(refraction[c], x[k], cosine, norm="one")
            matrix[:, c] += scattered * np.stack([one[0, 0], one[0, 1], one[2, 2]])
    matrix /= scattering[:, None]
    return Particles(wavelength_nm, _ANGLES_RAD, extinction, scattering, *matrix)
