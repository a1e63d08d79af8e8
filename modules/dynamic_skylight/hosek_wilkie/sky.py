"""HosekWilkieSky: the sky and the sun's disc of one turbidity, ground and solar elevation."""

from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from dynamic_skylight.hosek_wilkie import coefficients
from dynamic_skylight.hosek_wilkie.coefficients import WAVELENGTHS_NM, Quantity
from dynamic_skylight.hosek_wilkie.cube_rows import fill_cube
from dynamic_skylight.hosek_wilkie.formula import extended_perez
from dynamic_skylight.hosek_wilkie.towards import radiance_towards
from vrut_lite.arguments import ROUNDING, as_number, as_numbers, broadcast
from vrut_lite.geometry.preview import fisheyes_png
from vrut_lite.numeric_types import Float32Array, FloatArray

# The disc that the solar function was fitted with; the real one is 0.2666 deg on average.
SOLAR_DISC_RADIUS_RAD = np.deg2rad(0.51 / 2)
ALL_FACES = tuple(range(6))
# Wavelength ranges of the authors' functions.
SKY_NM, _SUN_NM = (280.0, 760.0), (320.0, 720.0)
# Beyond this, rounding destroys the direction.
_MOST_TURNED_RAD = 1e6
_MOST_EXPOSURE = 1e6


class HosekWilkieSky:
    """The model of Hosek and Wilkie (2012, 2013) for one hour.

    Angles: theta from the zenith, gamma from the sun, both from 0 to pi rad and of any shapes
    that broadcast. Below the horizon (theta > 90 deg) there is no sky: radiance 0.

    Args:
        turbidity: 1 to 10.
        albedo: of the ground, 0 to 1: a number, or (3,) for the RGB methods, or (11,), one for
            each of `WAVELENGTHS_NM`, for the spectral ones.
        sun_elevation_rad: apparent solar elevation, 0 to pi/2.

    Raises:
        ValueError: for a value outside these ranges or one that is not a number, here and in every
            method; in one sentence.
    """

    def __init__(self, turbidity: float, albedo: ArrayLike, sun_elevation_rad: float):
        self.turbidity = as_number("turbidity", turbidity, 1.0, 10.0)
        # A copy, because the caller's array may change.
        self.albedo = as_numbers("albedo", albedo, 0.0, 1.0).copy()
        if self.albedo.shape not in ((), (3,), (WAVELENGTHS_NM.size,)):
            raise ValueError(
                "albedo must be a number, or one per colour (3,), or one per wavelength "
                f"({WAVELENGTHS_NM.size},), not of shape {self.albedo.shape}"
            )
        # The model has no sky for a sun below the horizon.
        self.sun_elevation_rad = as_number(
            "sun_elevation_rad", sun_elevation_rad, 0.0, np.pi / 2, "rad"
        )

    def _repr_png_(self) -> bytes:
        """A fisheye with the sun in the south, for notebooks."""
        return fisheyes_png([self.cube_map(128, np.pi)])

    @property
    def rgb_distribution(self) -> FloatArray:
        """The formula's parameters A to I (3, 9) for red, green and blue."""
        return self._rgb[0]

    @property
    def rgb_mean_radiance(self) -> FloatArray:
        """The formula's factors (3,), W m^-2 sr^-1."""
        return self._rgb[1]

    @property
    def spectral_distribution(self) -> FloatArray:
        """The formula's parameters A to I (11, 9) at `WAVELENGTHS_NM`."""
        return self._spectral[0]

    @property
    def spectral_mean_radiance(self) -> FloatArray:
        """The formula's factors (11,), W m^-2 sr^-1 nm^-1."""
        return self._spectral[1]

    def radiance(self, theta_rad: ArrayLike, gamma_rad: ArrayLike) -> FloatArray:
        """Sky radiance (..., 3), linear sRGB primaries, W m^-2 sr^-1, without the disc.

        Clamped at 0: the fit dips below it far from a low sun in clear air.
        """
        return np.maximum(self.raw_radiance(theta_rad, gamma_rad), 0.0)

    def raw_radiance(self, theta_rad: ArrayLike, gamma_rad: ArrayLike) -> FloatArray:
        """As `radiance`, but as the fit gives it: small negative values are kept."""
        return _sky(theta_rad, gamma_rad, self.rgb_distribution, self.rgb_mean_radiance)

    def spectral_radiance(
        self, theta_rad: ArrayLike, gamma_rad: ArrayLike, wavelength_nm: ArrayLike
    ) -> FloatArray:
        """Sky radiance (..., *W) at wavelengths (*W), W m^-2 sr^-1 nm^-1, clamped at 0.

        `wavelength_nm` may be a number: the result is then (...,). Linear between the eleven
        bands; the ends are the authors': the 320 nm band holds down to 280 nm and the 720 nm
        band fades out at 760 nm.

        Raises:
            ValueError: for wavelengths outside 280 to 760 nm, the model's range.
        """
        wavelength = as_numbers("wavelength_nm", wavelength_nm, *SKY_NM, "nm")
        bands = _sky(theta_rad, gamma_rad, self.spectral_distribution, self.spectral_mean_radiance)
        return np.maximum(_weigh(bands, _sky_band_weights(wavelength)), 0.0)

    def solar_radiance(
        self, theta_rad: ArrayLike, gamma_rad: ArrayLike, wavelength_nm: ArrayLike
    ) -> FloatArray:
        """Radiance (..., *W) of the sun's disc alone, W m^-2 sr^-1 nm^-1, limb darkened.

        0 outside the disc (0.255 deg) and below the horizon. The air's path is that of the
        view direction theta, as in the authors' code, so that a low disc reddens downwards.

        Raises:
            ValueError: for wavelengths outside 320 to 720 nm, the range of the solar function.
        """
        wavelength = as_numbers("wavelength_nm", wavelength_nm, *_SUN_NM, "nm")
        theta, gamma = _angles(theta_rad, gamma_rad)
        weights = _sky_band_weights(wavelength)
        elevation = np.clip(np.pi / 2 - theta, 0.0, np.pi / 2)
        centre = _weigh(coefficients.sun_radiance(self.turbidity, elevation), weights)
        # Radiance and limb darkening are interpolated separately, as in the authors' code.
        squared = 1.0 - (np.sin(gamma) / np.sin(SOLAR_DISC_RADIUS_RAD)) ** 2
        powers = np.sqrt(np.maximum(squared, 0.0))[..., None] ** np.arange(6)
        darkening = _weigh(powers @ coefficients.limb_darkening().T, weights)
        seen = (gamma <= SOLAR_DISC_RADIUS_RAD) & _above_horizon(theta)
        return np.where(_beside(seen, centre), np.maximum(centre * darkening, 0.0), 0.0)

    def cube_map(
        self,
        size: int = 256,
        sun_azimuth_rad: float = 0.0,
        out: NDArray[np.float32] | None = None,
        faces: tuple[int, ...] = ALL_FACES,
        rows: tuple[int, int] | None = None,
    ) -> NDArray[np.float32]:
        """Sky radiance as a cube map (6, size, size, 3) float32, the fast path of `radiance`.

        World axes and face order of `vrut_lite.geometry.cube_map`; the azimuth counts from
        -Z, clockwise seen from above. 0 below the horizon. Within 1e-5 of `radiance`, relative to
        the larger of the value and 1 % of the map's maximum. `out` (C-contiguous), if given, is
        written and returned. Texels outside `faces` and `rows` (the first row and the one after
        the last, of each face) are unchanged in `out` and 0 in a new map.

        Raises:
            ValueError: a size outside 1 to 8192, an `out` that does not fit, a face or row that
                does not exist; likewise for the other cube maps.
        """
        return self._cube(np.float32, 1.0, size, sun_azimuth_rad, out, faces, rows)

    def cube_map_float16(
        self,
        size: int = 256,
        sun_azimuth_rad: float = 0.0,
        scale: float = 1.0,
        out: NDArray[np.float16] | None = None,
        faces: tuple[int, ...] = ALL_FACES,
    ) -> NDArray[np.float16]:
        """`cube_map` divided by `scale`, in half precision.

        `half_scale` of `brightest` is a good scale; values are clipped at 65504.
        """
        factor = as_number("scale", scale, 2.0**-40, 2.0**40)
        return self._cube(np.float16, 1.0 / factor, size, sun_azimuth_rad, out, faces)

    def cube_map_u8(
        self,
        size: int = 256,
        sun_azimuth_rad: float = 0.0,
        exposure: float = 0.05,
        out: NDArray[np.uint8] | None = None,
        faces: tuple[int, ...] = ALL_FACES,
    ) -> NDArray[np.uint8]:
        """`cube_map` L as bytes 255 (1 - exp(-exposure L)).

        The daylight thesis's tone curve: linear for dark values (not the display's gamma),
        never clipped for bright ones. `exposure` is in m^2 sr W^-1.
        """
        factor = as_number("exposure", exposure, 0.0, _MOST_EXPOSURE) / np.log(2.0)
        return self._cube(np.uint8, factor, size, sun_azimuth_rad, out, faces)

    def radiance_towards(self, directions: ArrayLike, sun_azimuth_rad: float = 0.0) -> Float32Array:
        """Sky radiance (..., 3) in world directions (..., 3), as `cube_map` has it on its texels.

        A panorama is `radiance_towards(lat_long_directions(height))`, of `vrut_lite.geometry`. The
        directions need not be of unit length; below the horizon the sky is 0.

        Raises:
            ValueError: for directions without a length, or with numbers beyond 1e18.
        """
        numbers = self.rgb_distribution, self.rgb_mean_radiance
        sun = _azimuth(sun_azimuth_rad), self.sun_elevation_rad
        return radiance_towards(*numbers, *sun, directions)

    @cached_property
    def brightest(self) -> float:
        """An estimate of the largest radiance of any channel, W m^-2 sr^-1.

        It is the largest at the sun, the zenith and the horizon below and opposite the sun; the
        map's maximum is 1 to 2 times as large.
        """
        zenith_angle = np.pi / 2 - self.sun_elevation_rad
        theta = np.array([zenith_angle, 0.0, np.pi / 2, np.pi / 2])
        gamma = np.array([0.0, zenith_angle, self.sun_elevation_rad, np.pi / 2 + zenith_angle])
        return float(self.radiance(theta, gamma).max())

    def _cube(
        self,
        dtype: type[np.generic],
        factor: float,
        size: int,
        sun_azimuth_rad: float,
        out: NDArray[Any] | None,
        faces: tuple[int, ...],
        rows: tuple[int, int] | None = None,
    ) -> NDArray[Any]:
        numbers = self.rgb_distribution, self.rgb_mean_radiance * factor
        sun = _azimuth(sun_azimuth_rad), self.sun_elevation_rad
        return fill_cube(*numbers, *sun, size, out, faces, rows, dtype)

    @cached_property
    def _rgb(self) -> tuple[FloatArray, FloatArray]:
        return self._formula("rgb")

    @cached_property
    def _spectral(self) -> tuple[FloatArray, FloatArray]:
        return self._formula("spec")

    def _formula(self, quantity: Quantity) -> tuple[FloatArray, FloatArray]:
        count = coefficients.channel_count(quantity)
        if self.albedo.shape not in ((), (count,)):
            raise ValueError(
                f"this needs one albedo or {count} of them, but the sky was made with "
                f"{self.albedo.size}"
            )
        hour = self.turbidity, self.albedo, self.sun_elevation_rad
        return coefficients.sky_formula(quantity, *hour)


def _azimuth(sun_azimuth_rad: float) -> float:
    return as_number("sun_azimuth_rad", sun_azimuth_rad, -_MOST_TURNED_RAD, _MOST_TURNED_RAD, "rad")


def half_scale(brightest: float) -> float:
    """The power of two by which to divide, so that this value lies in [2^13, 2^14) as a half.

    That leaves a factor of four for values that are brighter still.
    """
    return float(2.0 ** (np.frexp(brightest)[1] - 14)) if brightest > 0.0 else 1.0


def _sky(
    theta_rad: ArrayLike, gamma_rad: ArrayLike, distribution: FloatArray, mean: FloatArray
) -> FloatArray:
    """Unclamped radiance (..., C), 0 below the horizon."""
    theta, gamma = _angles(theta_rad, gamma_rad)
    cos_theta = np.maximum(np.cos(theta), 0.0)
    values = extended_perez(cos_theta, gamma, distribution) * mean
    return np.where(_above_horizon(theta)[..., None], values, 0.0)


def _angles(theta_rad: ArrayLike, gamma_rad: ArrayLike) -> tuple[FloatArray, ...]:
    """Both, of one shape (...,)."""
    return broadcast(
        theta_rad=as_numbers("theta_rad", theta_rad, 0.0, np.pi, "rad", slack=ROUNDING),
        gamma_rad=as_numbers("gamma_rad", gamma_rad, 0.0, np.pi, "rad", slack=ROUNDING),
    )


def _above_horizon(theta: FloatArray) -> NDArray[np.bool_]:
    return theta <= np.pi / 2


def _beside(mask: NDArray[np.bool_], values: FloatArray) -> NDArray[np.bool_]:
    """The mask with axes added at its end until it broadcasts against the values."""
    return mask.reshape(mask.shape + (1,) * (values.ndim - mask.ndim))


def _weigh(bands: FloatArray, weights: FloatArray) -> FloatArray:
    """Bands (..., 11) at the wavelengths of the weights (*W, 11): (..., *W)."""
    return np.tensordot(bands, weights, axes=(-1, -1))


def _sky_band_weights(wavelength_nm: FloatArray) -> FloatArray:
    """Weights (*W, 11) of the bands at wavelengths (*W)."""
    w = wavelength_nm[..., None]
    held = np.maximum(w, WAVELENGTHS_NM[0])
    hats = np.maximum(1.0 - np.abs(held - WAVELENGTHS_NM) / 40.0, 0.0)
    return np.where(w > SKY_NM[0], hats, 0.0)
