"""The four quadrature rules in GLSL against their float64 twins, ray by ray, in float32.

What the twin is given are the float32 numbers that the shader gets: an error is the shader's.
"""

from dataclasses import replace

import numpy as np
import pytest
from bruneton_sky import Atmosphere, single_scattering
from bruneton_sky.atmosphere_numbers import SPECTRAL_FIELDS
from bruneton_sky.geometry import end_of_ray, horizon_mu, make_ray
from bruneton_sky.optical_path import optical_depth
from bruneton_sky.presets import preset
from hypothesis import given
from hypothesis import strategies as st
from long_parameters import mostly_long
from numpy.typing import NDArray
from shader_probe import ShaderProbe

# The product never imports the reference: it changes seldom.
pytestmark = [pytest.mark.gl, pytest.mark.long]

SAMPLES = {
    "gauss-legendre": 12,
    "midpoint": (16, 8),
    "trapezoid": (16, 8),
    "simpson": (16, 8),
}
SUN_ZENITH_DEG = (0, 30, 60, 80, 88, 89.5, 89.999, 90.001, 90.5, 91, 93, 96)


@pytest.fixture(scope="module")
def probe(gl_owner) -> ShaderProbe:
    """The shaders, compiled once for all tests here."""
    return ShaderProbe(gl_owner)


@pytest.fixture(scope="module")
def alien(other_planet: Atmosphere) -> Atmosphere:
    """The other planet at three of its wavelengths."""
    thirds = {name: getattr(other_planet, name)[:3] for name in ("wavelength_nm", *SPECTRAL_FIELDS)}
    return replace(other_planet, **thirds)


def ray_grid(air: Atmosphere) -> NDArray[np.float32]:
    """Rays (n, 4) of observers from ground to top, also just above and below the horizon."""
    rays = []
    top = air.top_altitude_m
    for height in (0.0, 1.7, 2000.0, 30_000.0, top * 59.9 / 60.0, top):
        horizon = float(horizon_mu(air.ground_radius_m, height))
        steps = np.array([1e-2, 1e-3, 1e-5, -1e-5, -1e-3, -1e-2])
        mu = np.concatenate([[1, 0.9, 0.2, 0.01, 1e-3, 0, -1e-3, -0.2, -1], horizon + steps])
        mu = np.clip(mu, -1.0, 1.0)
        for zenith in np.radians(SUN_ZENITH_DEG):
            for phi in (0.0, 0.3, 2.0, np.pi):
                nu = mu * np.cos(zenith) + np.sqrt(1 - mu**2) * np.sin(zenith) * np.cos(phi)
                ray = np.broadcast_arrays(height, mu, np.cos(zenith), np.clip(nu, -1, 1))
                rays.append(np.stack(ray, axis=1))
    return np.concatenate(rays).astype(np.float32)


def ray_lottery(air: Atmosphere, count: int) -> NDArray[np.float32]:
    """Rays (n, 4) at random, half of them within a hair of ground, top, horizon or sunset."""
    rng = np.random.default_rng(11)
    top = air.top_altitude_m
    hair = np.where(rng.random((2, count)) < 0.5, 1, -1) * 10 ** rng.uniform(-7, -1, (2, count))
    near = rng.random((4, count)) < 0.5
    special = rng.choice([0, 1e-3, 0.1, 1.7, 100, top - 1, top - 0.01, top], count)
    height = np.where(near[0], special, rng.random(count) ** 4 * top)
    level = np.where(near[3], horizon_mu(air.ground_radius_m, height), 0.0)
    mu = np.clip(np.where(near[1], level + hair[0], rng.uniform(-1, 1, count)), -1, 1)
    mu_s = np.clip(np.where(near[2], hair[1], rng.uniform(-0.26, 1, count)), -1, 1)
    phi = rng.uniform(0, np.pi, count)
    nu = mu * mu_s + np.sqrt((1 - mu**2) * (1 - mu_s**2)) * np.cos(phi)
    return np.stack([height, mu, mu_s, np.clip(nu, -1, 1)], axis=1).astype(np.float32)


def twin(air: Atmosphere, rays: NDArray[np.float32], rule: str) -> NDArray[np.float64]:
    """Radiance (n, 3) by the rule in float64."""
    exact = rays.astype(float).T
    return single_scattering(air, *exact, rule=rule, samples=SAMPLES[rule])  # type: ignore[arg-type]


def relative_error(ours: NDArray[np.float64], truth: NDArray[np.float64]) -> NDArray[np.float64]:
    """Errors of radiances above a millionth of the largest; the others must be right to that."""
    lit = truth > 1e-6 * truth.max()
    assert np.abs(ours - truth)[~lit].max(initial=0.0) < 1e-8 * truth.max()
    return np.abs(ours[lit] / truth[lit] - 1.0)


@pytest.mark.parametrize("rule", SAMPLES)
@pytest.mark.parametrize("name", ["earth-clear", "earth-hazy", "mars-like", "alien"])
def test_shader_agrees_with_the_cpu(probe, alien: Atmosphere, name: str, rule: str) -> None:
    """Root mean square 2e-6 and nowhere more than 5e-5: what float32 leaves of the closed forms."""
    air = alien if name == "alien" else preset(name)
    rays = ray_grid(air)
    ours = probe.radiance(air, rays, rule, SAMPLES[rule])
    assert np.isfinite(ours).all()
    assert (ours >= 0).all()
    error = relative_error(ours, twin(air, rays, rule))
    assert np.sqrt(np.mean(error**2)) < 2e-6
    assert error.max() < 5e-5


@pytest.mark.parametrize("rule", mostly_long(SAMPLES, ("gauss-legendre", "trapezoid").__contains__))
@pytest.mark.parametrize("name", ["earth-clear", "earth-twilight", "alien"])
def test_shader_is_right_close_to_ground_top_horizon_and_sunset(
    probe, alien: Atmosphere, name: str, rule: str
) -> None:
    """Among 6000 rays, half beside an edge, 99.9 % err by less than 1e-4 and none by 1e-3.

    The rest graze the planet's shadow, where the last digit of the input changes as much.
    """
    air = alien if name == "alien" else preset(name)
    rays = ray_lottery(air, 6000)
    ours = probe.radiance(air, rays, rule, SAMPLES[rule])
    assert np.isfinite(ours).all()
    assert (ours >= 0).all()
    error = relative_error(ours, twin(air, rays, rule))
    assert np.quantile(error, 0.999) < 1e-4
    assert error.max() < 1e-3


def test_optical_depth_in_float32(probe, alien: Atmosphere) -> None:
    """The closed form keeps five digits of a depth, also at the horizon, where it is 20."""
    for air in (preset("earth-clear"), alien):
        rays = ray_grid(air)
        depth, hits = probe.optical_depth(air, rays)
        ray = make_ray(air.ground_radius_m, *rays[:, :2].astype(float).T)
        exact = optical_depth(air, ray, *end_of_ray(ray, air.top_altitude_m))
        assert depth == pytest.approx(exact, rel=1e-5, abs=2e-6)
        assert np.array_equal(hits, ray.hits_ground())


def test_nodes_converge_as_on_the_cpu(probe) -> None:
    """More nodes bring the shader to the truth, down to float32: 8, 12, 16 nodes by day."""
    air = preset("earth-2008")
    rays = ray_grid(air)
    rays = rays[(rays[:, 2] > 0.17) & (rays[:, 0] < 1e4)]
    truth = single_scattering(air, *rays.astype(float).T, samples=64)
    errors = [
        relative_error(probe.radiance(air, rays, samples=count), truth).max()
        for count in (4, 8, 12, 16)
    ]
    assert errors[0] > 10 * errors[1] > 100 * errors[2]
    assert errors[3] < 3e-5


def test_absent_substances_add_no_light(probe) -> None:
    """No air, no light; no aerosol, no ozone: the same as the twin, which skips them too."""
    none = (0.0,) * 3
    earth = preset("earth-clear")
    no_mie = replace(earth, mie_scattering=none, mie_extinction=none)
    molecules = replace(no_mie, absorption_extinction=none)
    rays = ray_grid(earth)
    assert not probe.radiance(replace(molecules, rayleigh_scattering=none), rays).any()
    for air in (no_mie, molecules):
        error = relative_error(probe.radiance(air, rays), twin(air, rays, "gauss-legendre"))
        assert error.max() < 5e-5


def test_phase_function_is_the_atmospheres(probe) -> None:
    """Both forms, from straight into the sun to straight away from it."""
    rays = ray_grid(preset("earth-hazy"))
    for form in ("cornette-shanks", "henyey-greenstein"):
        air = replace(preset("earth-hazy"), mie_phase=form, mie_g=0.95)  # type: ignore[arg-type]
        error = relative_error(probe.radiance(air, rays), twin(air, rays, "gauss-legendre"))
        assert error.max() < 5e-5


@given(
    height=st.floats(0.0, 6e4, width=32) | st.sampled_from([0.0, 1e-3, 59_999.996, 60_000.0]),
    mu=st.floats(-1.0, 1.0, width=32) | st.sampled_from([-1.0, -1e-7, 0.0, 1e-7, 1.0]),
    mu_s=st.floats(-1.0, 1.0, width=32) | st.sampled_from([-1.0, -1e-7, 0.0, 1e-7, 1.0]),
    phi=st.floats(0.0, np.pi) | st.sampled_from([0.0, np.pi]),
)
def test_radiance_is_finite_and_not_negative(
    probe, height: float, mu: float, mu_s: float, phi: float
) -> None:
    """Zenith, nadir, horizon, antisolar point, ground, top, night: finite, never negative."""
    nu = mu * mu_s + np.sqrt((1 - mu * mu) * (1 - mu_s * mu_s)) * np.cos(phi)
    ray = np.array([[height, mu, mu_s, np.clip(nu, -1, 1)]], dtype=np.float32)
    for rule, samples in SAMPLES.items():
        radiance = probe.radiance(preset("earth-clear"), ray, rule, samples)
        assert np.isfinite(radiance).all()
        assert (radiance >= 0).all()
