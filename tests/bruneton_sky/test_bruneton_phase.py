"""The two phase functions of aerosols, and that the atmosphere's choice reaches the sky."""

from dataclasses import replace

import numpy as np
import pytest
from bruneton_sky import Atmosphere, single_scattering
from bruneton_sky.phase import (
    henyey_greenstein_phase,
    mie_phase,
    mie_phase_parameters,
    molecules_phase,
    rayleigh_phase,
)
from bruneton_sky.published.single_scattering import scattered_without_phase
from bruneton_sky.solver import single_scattering_fast, solve

from vrut_lite.atmosphere.aerosol import cornette_shanks_phase

NU, WEIGHT = np.polynomial.legendre.leggauss(400)
FORMS = {
    "cornette-shanks": cornette_shanks_phase,
    "henyey-greenstein": henyey_greenstein_phase,
}


@pytest.mark.parametrize("g", [-0.5, 0.0, 0.3, 0.8, 0.9])
def test_henyey_greenstein_is_normalised_with_mean_cosine_g(g: float) -> None:
    """It integrates to 1 over the sphere, and its mean cosine is g (Henyey, Greenstein 1941)."""
    phase = henyey_greenstein_phase(NU, g)
    assert 2 * np.pi * (WEIGHT * phase).sum() == pytest.approx(1.0, rel=1e-11)
    assert 2 * np.pi * (WEIGHT * phase * NU).sum() == pytest.approx(g, abs=1e-11)


@pytest.mark.parametrize("g", [-0.5, 0.0, 0.3, 0.8, 0.9])
def test_cornette_shanks_mean_cosine(g: float) -> None:
    """3 g (4 + g^2) / (5 (2 + g^2)), equation 9 of Cornette and Shanks 1992: more than g."""
    phase = cornette_shanks_phase(NU, g)
    expected = 3 * g * (4 + g * g) / (5 * (2 + g * g))
    assert 2 * np.pi * (WEIGHT * phase * NU).sum() == pytest.approx(expected, abs=1e-11)


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("g", [-0.99, 0.0, 0.8, 0.999])
def test_parameters_give_both_phase_functions(form: str, g: float) -> None:
    """P = factor (1 + form nu^2) / ((1 - g)^2 + 2 g (1 - nu))^1.5, also straight at the sun."""
    air = replace(Atmosphere.earth(), mie_g=g, mie_phase=form)  # type: ignore[arg-type]
    nu = np.array([-1.0, 0.0, 0.5, 1.0 - 1e-9, 1.0])
    assert mie_phase(air, nu) == pytest.approx(FORMS[form](nu, g), rel=1e-13)
    parameters = mie_phase_parameters(air)
    spread = (1.0 - g) ** 2 + 2.0 * g * (1.0 - nu)
    ours = parameters.factor * (1.0 + parameters.form * nu**2) / spread**1.5
    assert ours == pytest.approx(FORMS[form](nu, g), rel=1e-13)


def test_phase_function_changes_only_the_aerosols_light() -> None:
    """The radiance changes by the aerosol part times the difference of the phase functions."""
    shanks = Atmosphere.earth()
    greenstein = replace(shanks, mie_phase="henyey-greenstein")
    where = 0.0, np.array([0.9, 0.1]), 0.5, np.array([0.3, 0.95])
    _, mie = scattered_without_phase(shanks, *where)
    more = single_scattering(greenstein, *where) - single_scattering(shanks, *where)
    phases = henyey_greenstein_phase(where[3], 0.8) - cornette_shanks_phase(where[3], 0.8)
    assert more == pytest.approx(mie * phases[:, None], rel=1e-9)


@pytest.mark.parametrize("rho", [0.0, 0.0285, 0.3, 1.0])
def test_depolarising_molecules_scatter_more_evenly(rho: float) -> None:
    """The phase function stays normalised, and P(90 deg) / P(0) = (1 + rho) / 2 (Chandrasekhar
    1950, section 18: natural light of which rho / (1 + rho) vibrates in the scattering plane)."""
    air = replace(Atmosphere.earth(), rayleigh_depolarisation=rho)
    assert 2 * np.pi * (WEIGHT * molecules_phase(air, NU)).sum() == pytest.approx(1.0, rel=1e-12)
    across, along = molecules_phase(air, [0.0, 1.0])
    assert across / along == pytest.approx((1.0 + rho) / 2.0, rel=1e-12)


def test_depolarisation_reaches_the_solvers_first_order(other_planet: Atmosphere) -> None:
    """The kernels' light off molecules is over Rayleigh's phase function: times that it must be the
    exact one's with the molecules' own."""
    plain = replace(other_planet, mie_scattering=0.0, mie_extinction=0.0, ground_albedo=0.0)
    air = replace(plain, rayleigh_depolarisation=0.3)
    where = 0.0, np.array([0.9, 0.3, 0.1]), 0.5, np.array([0.3, 0.95, -0.5])
    shown = [single_scattering_fast(solve(one, 1), *where)[0] for one in (plain, air)]
    share = molecules_phase(air, where[3]) / rayleigh_phase(where[3])
    assert shown[1] == pytest.approx(shown[0] * share[:, None], rel=1e-6)
