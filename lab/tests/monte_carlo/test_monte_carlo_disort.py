"""The path tracer in the plane-parallel limit, against discrete ordinates (PythonicDISORT)."""

import warnings
from dataclasses import replace

import numpy as np
import pytest
from bruneton_sky import Atmosphere, single_scattering
from bruneton_sky.phase import mie_phase, rayleigh_phase
from PythonicDISORT import pydisort

from vrut_lite_lab.monte_carlo import (
    enter_atmosphere,
    monte_carlo_irradiance,
    monte_carlo_radiance,
)

LAYERS, STREAMS, MOMENTS = 30, 16, 64
AZIMUTH = np.array([0.3, 1.5, 3.0])
MU_S = 0.4


@pytest.fixture(scope="module")
def flat():
    """Earth's air with ozone and haze on a planet ten thousand times as large."""
    earth = replace(
        Atmosphere.earth(),
        ground_radius_m=6.36e10,
        solar_irradiance=(1.0,) * 3,
        ground_albedo=(0.1, 0.3, 0.8),
        mie_phase="henyey-greenstein",
    )
    return earth.with_aerosol(0.1, mie_g=0.6)


def layers(air, c):
    """Optical depth of molecules, aerosol and ozone (3, LAYERS) in layers, from the top down.

    The layers are even in optical depth, to which some altitude is added for the high ones.
    """
    altitude = np.linspace(0.0, air.top_altitude_m, 20001)
    extinction = np.array(
        [
            air.rayleigh_scattering[c] * np.exp(-altitude / air.rayleigh_scale_height_m),
            air.mie_extinction[c] * np.exp(-altitude / air.mie_scale_height_m),
            air.absorption_extinction[c] * air.absorber(altitude),
        ]
    )
    steps = 0.5 * (extinction[:, 1:] + extinction[:, :-1]) * np.diff(altitude)
    below = np.concatenate([np.zeros((3, 1)), np.cumsum(steps, axis=1)], axis=1)
    scale = below.sum(axis=0) + 0.02 * below[:, -1].sum() * altitude / altitude[-1]
    edges = np.interp(np.linspace(scale[-1], 0.0, LAYERS + 1), scale, altitude)
    return -np.diff([np.interp(edges, altitude, part) for part in below], axis=1)


def discrete_ordinates(air, c):
    """Nodes mu (8,); radiance (8, azimuths) down at the ground, up at the top; irradiance."""
    depth = layers(air, c)
    albedo = air.mie_scattering[c] / air.mie_extinction[c]
    x, weight = np.polynomial.legendre.leggauss(1000)
    legendre = 2.0 * np.pi * weight[:, None] * np.polynomial.legendre.legvander(x, MOMENTS)
    scattered = depth[0, :, None] * (rayleigh_phase(x) @ legendre)
    scattered = scattered + albedo * depth[1, :, None] * (mie_phase(air, x) @ legendre)
    scattering, whole = scattered[:, 0].copy(), depth.sum(axis=0)
    # Rounding leaves tiny negative moments, which it refuses.
    moments = np.maximum(scattered / scattering[:, None], 0.0)
    with warnings.catch_warnings():
        # It repairs zeroth moments that differ from 1 by rounding, and says so.
        warnings.filterwarnings("ignore", message="The zeroth index phase function")
        mu, _, down, _, radiance = pydisort(
            np.cumsum(whole), scattering / whole, STREAMS, moments, MU_S, 1.0, 0.0,
            NLeg=STREAMS, NFourier=STREAMS, f_arr=moments[:, STREAMS], NT_cor=True,
            BDRF_Fourier_modes=[air.ground_albedo[c]],
        )  # fmt: skip
    half, bottom = STREAMS // 2, np.cumsum(whole)[-1]
    sky, planet = radiance(bottom, AZIMUTH)[half:], radiance(0.0, AZIMUTH)[:half]
    return mu[:half], sky, planet, down(bottom)[0]


@pytest.fixture(scope="module")
def ordinates(flat):
    """The same with the wavelengths last."""
    nodes, *light = zip(*(discrete_ordinates(flat, c) for c in range(3)), strict=True)
    return nodes[0], *(np.stack(part, axis=-1) for part in light)


def traced(air, altitude, mu, paths, ground_seen):
    """Radiance and error (8, azimuths, 3), the first order exact where no ground is seen."""
    view, azimuth = np.meshgrid(mu, AZIMUTH, indexing="ij")
    nu = view * MU_S + np.sqrt((1 - view**2) * (1 - MU_S**2)) * np.cos(azimuth)
    rays = np.full(view.size, altitude), view.ravel(), np.full(view.size, MU_S), nu.ravel()
    light = monte_carlo_radiance(air, *rays, paths=paths, ground_seen=ground_seen)
    shape = (*view.shape, 3)
    if ground_seen:
        return light.total().reshape(shape), light.total_error().reshape(shape)
    first = single_scattering(air, *enter_atmosphere(air, *rays), nu.ravel(), samples=48)
    return (first + light.total(2)).reshape(shape), light.total_error(2).reshape(shape)


def agree(ours, error, theirs):
    """24 directions x 3 dependent wavelengths: rms 1.07 +- 0.15 in standard errors.

    Allowed beside: 1e-3 of sixteen streams, and a mean within 2e-3 for each wavelength.
    """
    deviation = (ours - theirs) / np.hypot(error, 1e-3 * theirs)
    assert np.sqrt(np.mean(deviation**2)) < 1.4
    assert np.abs((ours / theirs - 1.0).mean(axis=(0, 1))).max() < 2e-3


@pytest.mark.long
def test_sky_at_the_ground(flat, ordinates):
    """Down to 1 degree above the horizon, sun 24 degrees up, the ground's light in."""
    mu, sky, _, _ = ordinates
    agree(*traced(flat, 0.0, mu, 4096, False), sky)


@pytest.mark.long
def test_planet_from_outside(flat, ordinates):
    """Looking down from above the air, the ground seen too."""
    mu, _, planet, _ = ordinates
    agree(*traced(flat, 90e3, -mu, 8192, True), planet)


@pytest.mark.long
def test_sky_irradiance(flat, ordinates):
    """On level ground, within four standard errors of at most 0.3 %."""
    light = monte_carlo_irradiance(flat, MU_S, paths=2**15)
    error = light.total_error()[0]
    assert (error < 3e-3 * ordinates[3]).all()
    assert (np.abs(light.total()[0] - ordinates[3]) < 4 * error).all()
