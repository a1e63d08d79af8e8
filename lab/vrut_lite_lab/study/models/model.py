"""The interface of a sky model in the study, and the geometry that all of them share."""

from typing import NamedTuple, Protocol

import numpy as np

from vrut_lite.numeric_types import FloatArray


class SkyModel(Protocol):
    """A sky seen from sea level, at the 40 wavelengths of `framework.spectra`.

    Making one is cheap: what must be computed beforehand is computed when first used.
    """

    @property
    def name(self) -> str:
        """The identifier, as in `hosek-wilkie`."""

    @property
    def title(self) -> str:
        """The name in figures and tables."""

    def sky_radiance(
        self,
        sun_zenith_rad: float,
        view_zenith_rad: FloatArray,
        relative_azimuth_rad: FloatArray,
    ) -> FloatArray:
        """Radiance (n, 40), W m^-2 sr^-1 nm^-1, toward view zenith angles and azimuths (n,).

        The relative azimuth is the view's less the sun's. All zenith angles are between 0 and
        pi/2; not every model has a sky for a sun below the horizon.
        """

    def sun_irradiance(self, sun_zenith_rad: float) -> FloatArray:
        """Irradiance (40,) by the sun's disc of a plane facing it, W m^-2 nm^-1."""


def sky_irradiance(model: SkyModel, sun_zenith_rad: float) -> FloatArray:
    """Irradiance (40,) of a level plane by the sky without the sun's disc, W m^-2 nm^-1.

    Midpoints of 50 zenith angles and 200 azimuths, as published.
    """
    step = np.pi / 100.0
    zenith, azimuth = np.meshgrid(
        (np.arange(50) + 0.5) * step, np.arange(200) * step, indexing="ij"
    )
    radiance = model.sky_radiance(sun_zenith_rad, zenith.ravel(), azimuth.ravel())
    weight = np.cos(zenith) * np.sin(zenith) * step**2
    return np.asarray(weight.ravel() @ radiance)


class Cosines(NamedTuple):
    """Of the view's and the sun's zenith angle, and of the angle between the two."""

    mu: FloatArray
    mu_s: float
    nu: FloatArray


def cosines(
    sun_zenith_rad: float, view_zenith_rad: FloatArray, relative_azimuth_rad: FloatArray
) -> Cosines:
    """Cosines of directions (n,) against one sun."""
    mu, mu_s = np.cos(view_zenith_rad), float(np.cos(sun_zenith_rad))
    # A view at the horizon must not look into the ground by the rounding of pi / 2.
    mu = np.where(np.abs(mu) < 1e-15, 0.0, mu)
    across = np.sin(view_zenith_rad) * np.sin(sun_zenith_rad)
    nu = np.clip(across * np.cos(relative_azimuth_rad) + mu * mu_s, -1.0, 1.0)
    return Cosines(mu, mu_s, nu)
