"""Polarised light by Monte Carlo, in the plane-parallel limit, against published Stokes vectors."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from vrut_lite_lab.monte_carlo import monte_carlo_radiance, monte_carlo_stokes
from vrut_lite_lab.polarised_truth.airs import rayleigh_layer

DATA = Path(__file__).parents[1] / "data"
pytestmark = pytest.mark.long


def agree(case, geometry, stokes):
    """Rows of one slab: depth, albedo, depolarisation; altitude, cosines, azimuth; I, Q, U.

    Deviations over errors from 16 batches have an rms of 1.07, here within 0.7 for six rows;
    the errors are at most 3 % of I.
    """
    altitude, mu_s, mu, azimuth = geometry.T
    sines = np.sqrt((1.0 - mu**2) * (1.0 - mu_s**2))
    nu = np.clip(mu * mu_s + sines * np.cos(azimuth), -1.0, 1.0)
    air = rayleigh_layer(*case)
    light = monte_carlo_stokes(
        air, altitude * air.top_altitude_m, mu, mu_s, nu, paths=16384, ground_seen=True
    )
    seen = np.stack([each.total()[:, 0] for each in light], axis=1)
    error = np.stack([each.total_error()[:, 0] for each in light], axis=1)
    assert (error < 3e-2 * seen[:, :1]).all()
    deviation = (seen - stokes) / error
    assert (np.sqrt(np.mean(deviation**2, axis=0)) < 1.8).all()
    assert np.abs(deviation).max() < 5.0


@pytest.mark.parametrize(
    ("depth", "depolarisation"), [(0.5, 0), (0.5, 0.03), (0.5, 0.1), (0.1, 0.03)]
)
def test_stokes_vectors_of_rayleigh_layers_are_iprts(depth, depolarisation):
    """Cases A1 and A2 of the intercomparison: models agree there to 1e-5 of I."""
    rows = np.loadtxt(DATA / "iprt_phase_a.txt")
    rows = rows[(rows[:, 0] == depth) & (rows[:, 2] == depolarisation)]
    sun, view, around = np.radians([rows[:, 4], rows[:, 6], rows[:, 7] - rows[:, 5]])
    geometry = np.stack([rows[:, 3], np.cos(sun), np.cos(view), around], axis=1)
    # Ours is U of azimuths from 0 to 180 degrees, with the other sign.
    stokes = rows[:, 8:] * np.stack(np.broadcast_arrays(1.0, 1.0, -np.sign(np.sin(around))), axis=1)
    agree(rows[0, :3], geometry, stokes)


@pytest.mark.parametrize("depth", [0.5, 1.0, 2.0])
def test_stokes_vectors_of_rayleigh_layers_are_natrajs(depth):
    """Thick layers and white ground: tables of eight digits."""
    rows = np.loadtxt(DATA / "natraj_rayleigh.txt")
    rows = rows[rows[:, 0] == depth]
    down = np.where(rows[:, 3] > 0.0, -1.0, 1.0)
    geometry = np.stack([rows[:, 3], rows[:, 4], down * rows[:, 5], np.radians(rows[:, 6])], axis=1)
    agree(rows[0, :3], geometry, rows[:, 7:] / np.pi)


def test_light_that_is_not_polarised_is_the_other_estimates(other_planet):
    """Particles without a matrix keep polarisation and make none: I is that of scalar transfer."""
    rays = 0.0, [0.5, 0.1], 0.3, 0.2
    even = replace(other_planet, rayleigh_scattering=0.0)
    i, q, u = monte_carlo_stokes(even, *rays, paths=256)
    np.testing.assert_allclose(i.batches, monte_carlo_radiance(even, *rays, paths=256).batches)
    np.testing.assert_allclose([q.batches, u.batches], 0.0, atol=1e-18)
