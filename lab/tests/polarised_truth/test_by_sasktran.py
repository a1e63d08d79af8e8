"""Another program as oracle: published Stokes vectors, and Mie's theory beside the product's."""

from pathlib import Path

import numpy as np
import pytest
from bruneton_sky import solve

from vrut_lite_lab.polarised_truth.airs import independent_air, product_air, rayleigh_layer
from vrut_lite_lab.polarised_truth.by_sasktran import on_large_planet, sasktran_stokes
from vrut_lite_lab.polarised_truth.views import Rays, rays_of, solved_radiance

pytest.importorskip("sasktran2", reason="sasktran2 of the laboratory's extra truth is missing")
DATA = Path(__file__).parents[1] / "data"


def test_stokes_vectors_are_iprts():
    """Cases A1 and A2 of the intercomparison, from the ground and from above: 1e-3 of I."""
    for row in np.loadtxt(DATA / "iprt_phase_a.txt"):
        depth, albedo, depolarisation, above = row[:4]
        mu_s, mu = np.cos(np.radians(row[[4, 6]]))
        around = np.radians(row[7] - row[5])
        nu = mu * mu_s + np.sqrt((1.0 - mu**2) * (1.0 - mu_s**2)) * np.cos(around)
        rays = Rays(6e4 * above, np.array([mu]), np.array([around]), np.array([nu]), mu_s)
        layer = rayleigh_layer(depth, albedo, depolarisation)
        found = sasktran_stokes(layer, rays, 0, flat=True)[0]
        np.testing.assert_allclose(found, row[8:] * (1.0, 1.0, -1.0), atol=1e-3 * row[8])


@pytest.mark.parametrize("name", ["default", "desert"])
def test_the_products_aerosol_is_sasktrans(name):
    """Two Mie codes and two transcripts of OPAC: 0.1 % of depth and albedo, 1 % of P11 and P12."""
    ours, theirs = product_air(name), independent_air(name)
    for layer in ("mie", "aloft"):
        for quantity in ("extinction", "scattering"):
            values = [getattr(air, f"{layer}_{quantity}") for air in (ours, theirs)]
            np.testing.assert_allclose(*values, rtol=1e-3)
        nu = np.cos(np.radians(np.arange(1.0, 180.0)))
        tables = [getattr(air, f"{layer}_table") for air in (ours, theirs)]
        np.testing.assert_allclose(*(table(nu) for table in tables), rtol=0.01)
        p12, p33 = zip(*(table.polarisation(nu) for table in tables), strict=True)
        np.testing.assert_allclose(*p12, atol=0.01)
        np.testing.assert_allclose(*p33, atol=0.01)


@pytest.mark.parametrize(
    ("name", "sun_zenith_deg", "most"),
    [("default", 30.0, 3e-3), ("default", 80.0, 3e-3), ("desert", 80.0, 5e-3)],
)
def test_the_sky_is_sasktrans(name, sun_zenith_deg, most):
    """All orders of polarised light in molecules, ozone and particles near 550 nm, solved by a
    program that shares nothing but the optics (found: 0.1 % rms, desert 0.4 %)."""
    air = on_large_planet(product_air(name))
    rays = rays_of("ground", sun_zenith_deg, 24)
    c = int(np.argmin(np.abs(np.array(air.wavelength_nm) - 550.0)))
    ours, theirs = solved_radiance(solve(air), rays)[:, c], sasktran_stokes(air, rays, c, flat=True)
    assert np.sqrt(np.mean((ours / theirs[:, 0] - 1.0) ** 2)) < most
