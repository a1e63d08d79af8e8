"""Atmospheres that the tests share."""

import pytest
from bruneton_sky import Atmosphere


@pytest.fixture(scope="session")
def other_planet() -> Atmosphere:
    """A small hazy planet with four wavelengths, on which Earth's constants would show."""
    return Atmosphere(
        wavelength_nm=(700.0, 600.0, 500.0, 400.0),
        solar_irradiance=(0.7, 0.9, 1.1, 0.8),
        ground_radius_m=3_000_000.0,
        top_altitude_m=90_000.0,
        rayleigh_scattering=(4e-6, 7e-6, 1.5e-5, 3.7e-5),
        rayleigh_scale_height_m=11_000.0,
        mie_scattering=(1e-5, 1.1e-5, 1.3e-5, 1.5e-5),
        mie_extinction=(1.2e-5, 1.4e-5, 1.6e-5, 2e-5),
        mie_scale_height_m=2300.0,
        mie_g=0.6,
        absorption_extinction=(1e-6, 0.0, 2e-6, 5e-7),
        absorber_altitude_m=(5000.0, 20_000.0, 30_000.0, 50_000.0),
        absorber_density=(0.2, 1.0, 0.5, 0.0),
        ground_albedo=(0.3, 0.2, 0.1, 0.1),
        sun_angular_radius_rad=0.01,
        mu_s_min=-0.3,
    )
