"""Node values for linear interpolation: what lies between the nodes is kept."""

import numpy as np
from bruneton_sky.solver.scattering_operator import fit_lines

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
