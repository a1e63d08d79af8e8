"""Single scattering: exact references, an independent rule, limits and continuity."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from bruneton_sky import Atmosphere, single_scattering
from bruneton_sky.geometry import end_of_ray, make_ray
from bruneton_sky.optical_path import exponential_path
from bruneton_sky.phase import rayleigh_phase
from hypothesis import given
from hypothesis import strategies as st
from long_parameters import mostly_long
from numpy.typing import NDArray

from vrut_lite.atmosphere.aerosol import cornette_shanks_phase

DATA = Path(__file__).parents[1] / "data" / "sky_truth_ground.npz"
COSINE = st.floats(-1.0, 1.0) | st.sampled_from([-1.0, -1e-9, 0.0, 1e-9, 1.0])
ANGLE = st.floats(0.0, np.pi) | st.sampled_from([0.0, np.pi])
NO_OZONE = Atmosphere.earth(ozone=False)


def scattering_cosine(mu, mu_s, phi) -> NDArray[np.float64]:  # type: ignore[no-untyped-def]
    """Cosine between view and sun, at the azimuth phi between them."""
    sines = np.sqrt((1 - np.square(mu)) * (1 - np.square(mu_s)))
    return np.clip(np.multiply(mu, mu_s) + sines * np.cos(phi), -1.0, 1.0)


@pytest.mark.parametrize(("samples", "tolerance"), [(12, 1e-6), (16, 2e-8), (32, 3e-9)])
def test_first_order_truth(samples: int, tolerance: float) -> None:
    """The reference's exact first order (float64 composite Gauss-Legendre, sun 0, 60, 87 deg)."""
    truth = np.load(DATA)
    sun, view, azimuth = np.meshgrid(
        *(np.radians(truth[axis]) for axis in ("sza", "vza", "raz")), indexing="ij"
    )
    air = replace(
        NO_OZONE,
        solar_irradiance=(1.0,) * 3,
        rayleigh_scattering=(5.802e-6, 13.558e-6, 33.1e-6),
    )
    mu, mu_s = np.cos(view), np.cos(sun)
    nu = scattering_cosine(mu, mu_s, azimuth)
    ours = single_scattering(air, 0.0, mu, mu_s, nu, samples=samples)
    assert ours == pytest.approx(truth["order1"], rel=tolerance)


@pytest.mark.parametrize("height_m", mostly_long([0.0, 4000.0], (4000.0).__eq__))
def test_simpson_agrees_on_another_planet(other_planet: Atmosphere, height_m: float) -> None:
    """Simpson with many even intervals shares nothing with the other rule but the physics."""
    mu, phi = np.meshgrid([0.9, 0.3, -0.3], [0.2, 2.0])
    for mu_s in (0.8, 0.1):
        nu = scattering_cosine(mu, mu_s, phi)
        arguments = other_planet, height_m, mu, mu_s, nu
        simpson = single_scattering(*arguments, rule="simpson", samples=(1024, 256))
        gauss = single_scattering(*arguments, samples=48)
        # The absorber's kinks hold Simpson at second order.
        assert gauss == pytest.approx(simpson, rel=3e-5)


def test_classical_rules_converge_with_their_orders() -> None:
    """Halving the step divides midpoint's and trapezoid's errors by 4, Simpson's by 16.

    The midpoint's error is the smaller one, of the other sign than the trapezoid's.
    """
    mu, mu_s = np.array([0.8]), 0.7
    arguments = NO_OZONE, 0.0, mu, mu_s, scattering_cosine(mu, mu_s, 1.0)
    truth = single_scattering(*arguments, samples=32)
    errors = {}
    for rule in ("midpoint", "trapezoid", "simpson"):
        coarse = single_scattering(*arguments, rule=rule, samples=(256, 256)) - truth
        fine = single_scattering(*arguments, rule=rule, samples=(512, 512)) - truth
        assert coarse / fine == pytest.approx(16.0 if rule == "simpson" else 4.0, rel=0.05)
        errors[rule] = fine
    assert (errors["trapezoid"] / errors["midpoint"] < -1.5).all()


def test_haze_does_not_outrun_the_nodes() -> None:
    """At AOD 0.9 (turbidity 10) twelve nodes hold 5e-5 to the horizon; a fixed map errs by 40 %."""
    hazy = NO_OZONE.with_aerosol(0.9)
    mu = np.array([0.0, 1e-3, 0.01, 0.1, 0.5, 1.0])
    nu = scattering_cosine(mu, 0.2, 1.0)
    ours = single_scattering(hazy, 0.0, mu, 0.2, nu)
    assert ours == pytest.approx(single_scattering(hazy, 0.0, mu, 0.2, nu, samples=200), rel=5e-5)


def test_thin_air_scatters_in_proportion() -> None:
    """Without extinction the radiance is irradiance x phase x coefficient x path, exactly."""
    thin = replace(
        NO_OZONE,
        rayleigh_scattering=(1e-14,) * 3,
        mie_scattering=(1e-14,) * 3,
        mie_extinction=(1e-14,) * 3,
    )
    mu, mu_s, nu = np.array([0.7, 0.01, -0.4]), 0.5, 0.3
    ray = make_ray(thin.ground_radius_m, 2000.0, mu)
    end = end_of_ray(ray, thin.top_altitude_m)
    paths = [exponential_path(ray, *end, scale)[:, None] for scale in (8000.0, 1200.0)]
    phases = rayleigh_phase(nu), cornette_shanks_phase(nu, 0.8)
    expected = 1e-14 * np.array(thin.solar_irradiance)
    expected = expected * (phases[0] * paths[0] + phases[1] * paths[1])
    assert single_scattering(thin, 2000.0, mu, mu_s, nu, samples=32) == pytest.approx(
        expected, rel=1e-7
    )


def test_air_without_scatterers_is_dark() -> None:
    """Without air there is no light; without one substance only the other's remains."""
    none = (0.0,) * 3
    no_mie = replace(NO_OZONE, mie_scattering=none, mie_extinction=none)
    vacuum = replace(no_mie, rayleigh_scattering=none)
    where = 100.0, np.array([1.0, 0.0, -0.5]), 0.3, 0.1
    assert not single_scattering(vacuum, *where).any()
    assert np.array_equal(
        single_scattering(no_mie, *where), single_scattering(replace(no_mie, mie_g=0.2), *where)
    )
    no_rayleigh = replace(NO_OZONE, rayleigh_scattering=none)
    ratio = single_scattering(no_rayleigh, *where) / np.array(no_rayleigh.solar_irradiance)
    # This Mie is grey: so is its sky.
    assert ratio[:, 0] == pytest.approx(ratio[:, 2], rel=1e-12)


def test_phase_functions_hold_all_the_light() -> None:
    """Either phase function integrates to 1 over the sphere."""
    nu, weight = np.polynomial.legendre.leggauss(200)
    for phase in (rayleigh_phase(nu), cornette_shanks_phase(nu, 0.8), cornette_shanks_phase(nu, 0)):
        assert 2.0 * np.pi * (weight * phase).sum() == pytest.approx(1.0, rel=1e-10)


@given(
    height=st.floats(0.0, 60_000.0) | st.sampled_from([0.0, 1e-3, 59_999.999, 60_000.0]),
    mu=COSINE,
    mu_s=COSINE,
    phi=ANGLE,
)
def test_always_finite_and_never_negative(
    height: float, mu: float, mu_s: float, phi: float
) -> None:
    """Zenith, horizon, antisolar point, ground, top, night: a radiance, never a NaN."""
    nu = scattering_cosine(mu, mu_s, phi)
    radiance = single_scattering(Atmosphere.earth(), height, mu, mu_s, nu)
    assert np.isfinite(radiance).all()
    assert (radiance >= 0).all()


@given(
    height=st.floats(0.0, 30_000.0),
    mu=st.floats(0.02, 1.0),
    mu_s=st.floats(-0.15, 1.0) | st.sampled_from([0.0, -1e-9]),
    phi=ANGLE,
)
def test_no_jump_as_the_sun_moves(height: float, mu: float, mu_s: float, phi: float) -> None:
    """A hundredth of an arc second of sun changes no sky by more than 0.1 %, at the horizon too."""
    suns = np.clip([mu_s, mu_s + 5e-8], -1.0, 1.0)
    nu = scattering_cosine(mu, suns, phi)
    before, after = single_scattering(NO_OZONE, height, mu, suns, nu, samples=16)
    assert after == pytest.approx(before, rel=1e-3, abs=1e-9)


@pytest.mark.parametrize("rule", ["midpoint", "trapezoid", "simpson", "gauss-legendre"])
def test_a_ray_to_the_zenith_ends_at_the_top(rule: str) -> None:
    """Rounding puts its last node a nanometre above the air for some altitudes: no NaN there."""
    air = Atmosphere.earth()
    height = np.concatenate([np.geomspace(1e-12, 6e4, 600), 6e4 - np.geomspace(1e-9, 1e4, 200)])
    samples = 12 if rule == "gauss-legendre" else (8, 4)
    for mu_s in (0.0, 1e-9, 1.0):
        radiance = single_scattering(air, height, 1.0, mu_s, mu_s, rule=rule, samples=samples)
        assert np.isfinite(radiance).all()
        assert (radiance >= 0.0).all()


def test_night_is_dark() -> None:
    """With the sun at the nadir the whole atmosphere lies in the planet's shadow."""
    mu = np.linspace(-1.0, 1.0, 21)
    assert not single_scattering(Atmosphere.earth(), 1000.0, mu, -1.0, -mu).any()


def test_down_from_the_ground_sees_no_air() -> None:
    """The ray of no length holds no light."""
    assert not single_scattering(Atmosphere.earth(), 0.0, -0.5, 0.5, 0.0).any()


def test_level_rays_in_fog_are_smooth() -> None:
    """A ray that sinks by 1e-13 m to its perigee: that way has all its digits.

    By the difference of the two altitudes it had two of them, and light changed by 5e-6 from one
    cosine to the next; it is to change by 1e-11, as the scattering angle does.
    """
    air = Atmosphere.earth().with_fog(5.0, 3.0)
    view = 0.5 * np.pi + 7.9e-11 + np.arange(-20, 20) * 2.3e-16
    sun, turn = 0.25, 0.29
    nu = scattering_cosine(np.cos(view), np.cos(sun), turn)
    light = single_scattering(air, 2.000000000006198, np.cos(view), np.cos(sun), nu)
    assert (np.ptp(light, axis=0) < 1e-10 * light.max(axis=0)).all()


@pytest.mark.parametrize("rule", ["midpoint", "trapezoid", "simpson"])
def test_a_coarse_rule_makes_no_depth_below_zero(rule: str) -> None:
    """Down into dense fog a parabola through densities dips below zero: the air would shine.

    By as much as e^160 from 10 km up; what is scattered is less than what the sun sends.
    """
    air = Atmosphere.earth().with_fog(5.0, 3.0)
    light = single_scattering(air, 10_000.0, [-1.0, -0.5], 0.5, 0.0, rule=rule, samples=(4, 2))
    assert (light >= 0.0).all()
    assert (light < np.asarray(air.solar_irradiance)).all()


@pytest.mark.parametrize(
    ("arguments", "name"),
    [
        ({"altitude_m": -1.0}, "altitude_m"),
        ({"altitude_m": 60_001.0}, "altitude_m"),
        ({"mu": 1.1}, "mu"),
        ({"nu": float("nan")}, "nu"),
        ({"samples": 0}, "samples"),
        ({"rule": "boole", "samples": (4, 4)}, "rule"),
        ({"rule": "simpson", "samples": (5, 4)}, "even"),
        ({"rule": "midpoint", "samples": 8}, "view, light"),
    ],
)
def test_bad_arguments_are_refused_by_name(arguments: dict[str, object], name: str) -> None:
    """One sentence names the argument."""
    good = {"altitude_m": 0.0, "mu": 0.5, "mu_s": 0.5, "nu": 0.5}
    with pytest.raises(ValueError, match=name):
        single_scattering(NO_OZONE, **(good | arguments))  # type: ignore[arg-type]
