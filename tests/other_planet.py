"""A small hazy planet on which Earth's constants would show, and its light by Monte Carlo."""

import numpy as np
from bruneton_sky import Atmosphere

OTHER_PLANET = Atmosphere(
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
# Rays on the other planet: altitude (m), mu, mu_s, nu; and their light by 131,072 paths each.
RAYS = np.array(
    [
        (0.0, 0.9, 0.5, 0.6),
        (0.0, 0.1, 0.5, -0.3),
        (4000.0, -0.4, 0.5, 0.1),
        (500_000.0, -0.8, 0.7, -0.5),
    ]
).T
LIGHT = np.array(
    [
        (4.82216e-03, 9.27696e-03, 1.79353e-02, 2.73791e-02),
        (1.97976e-02, 3.48932e-02, 5.31931e-02, 4.98599e-02),
        (3.80219e-03, 6.28984e-03, 1.08013e-02, 1.59567e-02),
        (5.74339e-03, 1.07674e-02, 2.04464e-02, 3.55348e-02),
    ]
)
