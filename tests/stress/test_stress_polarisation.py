"""Polarised light of random airs: finite, and polarised by no more than all of it."""

from dataclasses import replace

import numpy as np
import pytest
from bruneton_sky.settings import BrunetonSkySettings, atmosphere_at
from bruneton_sky.solved_sky import SolvedSky
from bruneton_sky.solver import SolverSizes, solve
from long_parameters import mostly_long
from planets import PLANETS, SHORT
from stress_cases import assert_light

from vrut_lite.geometry.colour import SKYLIGHT_NM
from vrut_lite.messages.haze import AEROSOL_TYPES, SetHaze

COARSE = SolverSizes(
    altitude=10, mu_s=24, direction_mu=12, direction_azimuth=8, degree=6, source_mu=12,
    source_azimuth=8, steps=16, node_bins=8, single_bins=12, multiple_bins=8,
)  # fmt: skip
# Air of OPAC's types, whose particles polarise by tables; rays in one random air.
OPAC, RAYS = "opac", 8192
FARTHEST_M = 4e8


def random_sky(stress, name):
    """A planet with scattering, ground and depolarisation at random, solved coarsely."""
    random = stress.random
    if name == OPAC:
        haze = SetHaze(
            aerosol=str(random.choice(AEROSOL_TYPES)),
            optical_depth_550=float(random.uniform(0.0, 2.0)),
        )
        base = atmosphere_at(SKYLIGHT_NM, BrunetonSkySettings(), 0.0, haze)
    else:
        base = PLANETS[name]
    factor = 10.0 ** random.uniform(-2.0, 1.0)
    air = replace(
        base,
        rayleigh_scattering=tuple(factor * np.asarray(base.rayleigh_scattering)),
        rayleigh_depolarisation=float(random.choice([0.0, 0.0285, random.uniform()])),
        ground_albedo=tuple(random.uniform(0.0, 1.0, len(base.wavelength_nm))),
    )
    return SolvedSky(field=solve(air, 6, COARSE, all_orders=True))


@pytest.mark.parametrize("name", mostly_long([*PLANETS, OPAC], {*SHORT, OPAC}.__contains__))
def test_light_is_polarised_by_no_more_than_all(stress, name):
    """Q^2 + U^2 <= I^2 and every number is finite, from the ground to the moon, for a sun anywhere,
    zenith, horizon and poles among the views; degree and angle stay in their ranges."""
    for count in stress.batches("SolvedSky.stokes", 4000, RAYS):
        sky = random_sky(stress, name)
        top_m = sky.atmosphere.top_altitude_m
        inside_m = stress.within(count, 0.0, top_m, [1e-6, 2.0, top_m - 1e-6])
        is_inside = stress.random.random(count) < 0.8
        height_m = np.where(is_inside, inside_m, stress.within(count, 0.0, FARTHEST_M, [top_m]))
        mu, mu_s = (stress.within(count, -1.0, 1.0, [0.0, 1e-9, -1e-9]) for _ in range(2))
        turn = np.cos(stress.within(count, 0.0, np.pi))
        nu = mu * mu_s + np.sqrt((1.0 - mu**2) * (1.0 - mu_s**2)) * turn
        where = height_m, mu, mu_s, np.clip(nu, -1.0, 1.0)
        radiance, q, u = np.moveaxis(sky.stokes(*where), -1, 0)
        assert_light(radiance)
        assert np.all(q**2 + u**2 <= radiance**2)
        degree, angle = sky.polarisation(*(part[:50] for part in where))
        assert np.all((degree >= 0.0) & (degree <= 1.0) & (np.abs(angle) <= 0.5 * np.pi))
