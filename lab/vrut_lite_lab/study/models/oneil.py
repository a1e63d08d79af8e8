"""O'Neil 2005, "Accurate Atmospheric Scattering" (GPU Gems 2), as Bruneton 2016 compares it.

Single scattering by four samples along the view ray (the original has two), and optical
paths from a closed formula: Schueler's approximation of Chapman's function (GPU Pro 3, 2012)
in the place of the original's polynomial, which fits one atmosphere alone.
"""

from dataclasses import dataclass

import numpy as np
from bruneton_sky.phase import rayleigh_phase

from vrut_lite.atmosphere.aerosol import cornette_shanks_phase
from vrut_lite.numeric_types import FloatArray
from vrut_lite_lab.study.framework.atmosphere import STUDY, StudyAtmosphere
from vrut_lite_lab.study.models.model import cosines

_SAMPLES = 4


@dataclass(frozen=True)
class ONeil:
    """The sky of an atmosphere, without ground."""

    air: StudyAtmosphere = STUDY
    name: str = "oneil"
    title: str = "O'Neil 2005"

    def sky_radiance(
        self,
        sun_zenith_rad: float,
        view_zenith_rad: FloatArray,
        relative_azimuth_rad: FloatArray,
    ) -> FloatArray:
        """Radiance (n, 40) of light scattered once."""
        air = self.air
        mu, mu_s, nu = cosines(sun_zenith_rad, view_zenith_rad, relative_azimuth_rad)
        ground, rmu = air.ground_radius_m, air.ground_radius_m * mu
        length = -rmu + np.sqrt((air.top_radius_m - ground) * (air.top_radius_m + ground) + rmu**2)
        step = length / _SAMPLES
        scattered = np.zeros((2, mu.size, air.solar_irradiance.size))
        for sample in range(_SAMPLES):
            distance = (sample + 0.5) * step
            radius = np.sqrt(ground**2 + distance * (distance + 2.0 * rmu))
            mu_there, mu_s_there = (
                (rmu + distance) / radius,
                (ground * mu_s + distance * nu) / radius,
            )
            altitude = radius - ground
            depth = np.zeros(scattered.shape[1:])
            densities = []
            for height, extinction in self._kinds():
                density = np.exp(-altitude / height)
                # From the eye up to the sample, then from the sample to the sun.
                path = self._path(height, mu) - density * self._path(height, mu_there)
                path += density * self._path(height, mu_s_there)
                depth += path[:, None] * extinction
                densities.append(density * step)
            scattered += np.stack(densities)[:, :, None] * np.exp(-depth)
        return self._radiance(scattered, nu)

    def sun_irradiance(self, sun_zenith_rad: float) -> FloatArray:
        """Irradiance (40,), by the same approximate paths."""
        mu_s = np.cos(sun_zenith_rad)
        depth = sum(self._path(height, mu_s) * extinction for height, extinction in self._kinds())
        return np.asarray(self.air.solar_irradiance * np.exp(-depth))

    def _kinds(self) -> tuple[tuple[float, FloatArray], ...]:
        """Scale height and extinction (40,) of molecules and of aerosol."""
        air = self.air
        molecules = air.rayleigh_scale_height_m, air.rayleigh_scattering
        return molecules, (air.mie_scale_height_m, air.mie_extinction)

    def _path(self, height_m: float, mu: FloatArray) -> FloatArray:
        """Optical path in m from where the density is 1 to the top, toward cosines mu."""
        bend = np.sqrt(self.air.ground_radius_m / height_m)
        return np.asarray(height_m * bend / (bend * mu + 1.0))

    def _radiance(self, scattered: FloatArray, nu: FloatArray) -> FloatArray:
        air = self.air
        rayleigh, mie = rayleigh_phase(nu), cornette_shanks_phase(nu, air.mie_g)
        by_molecules = scattered[0] * air.rayleigh_scattering * rayleigh[:, None]
        by_aerosol = scattered[1] * air.mie_scattering * mie[:, None]
        return np.asarray((by_molecules + by_aerosol) * air.solar_irradiance)
