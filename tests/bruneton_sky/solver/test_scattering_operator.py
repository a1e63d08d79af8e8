"""Scattering as a convolution in spherical harmonics, and lines that fit a function."""

import numpy as np
import pytest
from bruneton_sky.phase import henyey_greenstein_phase, rayleigh_phase
from bruneton_sky.solver import SolverSizes
from bruneton_sky.solver.grid import azimuths
from bruneton_sky.solver.scattering_operator import (
    ScatteringOperator,
    fit_lines,
    phase_coefficients,
    scattering_operator,
)

from vrut_lite.atmosphere.aerosol import cornette_shanks_phase

SIZES = SolverSizes(direction_mu=64, degree=12, source_mu=9, source_azimuth=7)


def operator() -> ScatteringOperator:
    return scattering_operator(6.36e6, (0.0, 5000.0, 40_000.0), SIZES)


def field_of(light: np.ufunc | object) -> np.ndarray:
    """A field f(x, y, z) of directions, as radiance (3, mu, azimuths, 1) at the nodes."""
    mu = operator().directions.mu[:, :, None]
    turn = azimuths(SIZES.direction_azimuth)
    sine = np.sqrt((1.0 - mu) * (1.0 + mu))
    value = light(sine * np.cos(turn), sine * np.sin(turn), mu + 0.0 * turn)  # type: ignore[operator]
    return np.asarray(value, dtype=np.float32)[..., None]


def in_lines(light: object) -> np.ndarray:
    """A field f(x, y, z) of directions, as lines between the source's nodes fit it best."""

    def by_turn(turn: np.ndarray) -> np.ndarray:
        def by_mu(mu: np.ndarray) -> np.ndarray:
            sine = np.sqrt(1.0 - mu * mu)[:, None]
            x, y = sine * np.cos(turn), sine * np.sin(turn)
            return np.asarray(light(x, y, mu[:, None] + 0.0 * turn))  # type: ignore[operator]

        mu = np.linspace(-1.0, 1.0, SIZES.source_mu)
        return fit_lines(by_mu, mu, lambda mu: 0.5 * mu + 0.5, keep_ends=True).T

    turn = 2.0 * np.arcsin(np.linspace(0.0, 1.0, SIZES.source_azimuth))
    return fit_lines(by_turn, turn, lambda turn: np.sin(0.5 * turn)).T


def test_phase_coefficients_of_known_functions() -> None:
    """Henyey-Greenstein's are the powers of g, Rayleigh's 1, 0, 1/10 (both in closed form)."""
    ours = phase_coefficients(lambda nu: henyey_greenstein_phase(nu, 0.8), 16)
    assert ours == pytest.approx(0.8 ** np.arange(17), abs=1e-12)
    ours = phase_coefficients(rayleigh_phase, 4)
    assert ours == pytest.approx([1.0, 0.0, 0.1, 0.0, 0.0], abs=1e-14)


def in_one_lane(chi: np.ndarray) -> np.ndarray:
    """A phase function's coefficients for light of one wavelength."""
    return chi[None, :, None].astype(np.float32)


@pytest.mark.parametrize(
    ("degree", "light"),
    [
        (0, lambda x, y, z: 1.0 + 0.0 * x),
        (1, lambda x, y, z: z),
        (1, lambda x, y, z: x),
        (2, lambda x, y, z: x * x - y * y),
        (2, lambda x, y, z: x * z),
        (3, lambda x, y, z: x * (5 * z * z - 1)),
        (5, lambda x, y, z: z * (63 * z**4 - 70 * z * z + 15)),
    ],
)
def test_harmonic_fields_are_scattered_exactly(degree: int, light: object) -> None:
    """A harmonic of degree l leaves as itself times chi_l (Funk-Hecke), to float32's 1e-5."""
    chi = phase_coefficients(lambda nu: cornette_shanks_phase(nu, 0.7), SIZES.degree)
    coefficients = operator().project(field_of(light))
    ours = operator().scatter(coefficients, in_one_lane(chi))[..., 0]
    exact = chi[degree] * in_lines(light)
    scale = np.abs(exact).max()
    assert ours == pytest.approx(np.broadcast_to(exact, ours.shape), abs=2e-5 * scale)


def test_molecules_scatter_by_four_coefficients() -> None:
    """The polynomial kept for molecules is the harmonic sum with chi = 1, 0, 1/10."""
    light = field_of(lambda x, y, z: np.exp(z + 0.8 * x))
    coefficients = operator().project(light)
    chi = np.zeros(SIZES.degree + 1)
    chi[[0, 2]] = 1.0, 0.1
    exact = operator().scatter(coefficients, in_one_lane(chi))[..., 0]
    for i, c in enumerate(operator().scatter_by_molecules(coefficients, 1.0)[:, :, 0]):
        ours = in_lines(
            lambda x, y, z, c=c: (
                c[0] + c[1] * (3.0 * z * z - 1.0) + c[2] * z * x + c[3] * (x * x - y * y)
            )
        )
        assert ours == pytest.approx(exact[i], rel=1e-5)


def test_any_light_keeps_its_energy() -> None:
    """Scattered light integrates to the light that came: chi_0 = 1."""
    rng = np.random.default_rng(3)
    shape = *operator().directions.mu.shape, SIZES.direction_azimuth, 1
    light = rng.random(shape).astype(np.float32)
    weight = operator().directions.weight * 2.0 * np.pi / SIZES.direction_azimuth
    arriving = (light[..., 0] * weight[..., None]).sum(axis=(1, 2))
    leaving = operator().scatter_by_molecules(operator().project(light), 1.0)[:, 0, 0] * 4.0 * np.pi
    assert leaving == pytest.approx(arriving, rel=1e-5)


SUNS = 2.0 * np.arcsin(np.linspace(0.0, 1.0, 12))


def place(turn: np.ndarray) -> np.ndarray:
    return np.asarray(np.sin(0.5 * turn))


def lobe(turn: np.ndarray) -> np.ndarray:
    """A lobe as haze makes it, and a straight line of the place."""
    return np.stack([np.exp(-((turn / 0.5) ** 2)), 2.0 - 3.0 * place(turn)], axis=-1)


def lines(values: np.ndarray, turn: np.ndarray) -> np.ndarray:
    """Linear interpolation of node values (12, k)."""
    return np.stack([np.interp(place(turn), np.linspace(0, 1, 12), v) for v in values.T], axis=-1)


def test_integral_is_kept() -> None:
    """The lines' integral is the function's, so that interpolation neither makes nor loses light:
    1e-6 is what the midpoints here miss."""
    turn = (np.arange(200_000) + 0.5) * np.pi / 200_000
    truth = lobe(turn).mean(axis=0)
    fitted = lines(fit_lines(lobe, SUNS, place), turn).mean(axis=0)
    np.testing.assert_allclose(fitted, truth, rtol=1e-6, atol=1e-8)


def test_fit_is_nearer_than_the_functions_own_values() -> None:
    """The mean square error is smaller, and a straight line is reproduced exactly."""
    turn = np.linspace(0.0, np.pi, 5001)
    values = fit_lines(lobe, SUNS, place)
    fitted, own = (
        np.square(lines(v, turn) - lobe(turn)).mean(axis=0) for v in (values, lobe(SUNS))
    )
    assert fitted[0] < 0.5 * own[0]
    np.testing.assert_allclose(values[:, 1], lobe(SUNS)[:, 1], atol=1e-12)


def test_ends_are_kept_where_asked() -> None:
    """The first and last value are the function's own, and the fit is still nearer than those."""
    turn = np.linspace(0.0, np.pi, 5001)
    values, own = fit_lines(lobe, SUNS, place, keep_ends=True), lobe(SUNS)
    np.testing.assert_array_equal(values[[0, -1]], own[[0, -1]])
    fitted, plain = (np.square(lines(v, turn) - lobe(turn)).mean(axis=0)[0] for v in (values, own))
    assert fitted < plain
