"""Thin films reflect as wave optics says."""

import numpy as np
import pytest

from vrut_lite.geometry.colour import colour_table, rgb_from_spectrum
from vrut_lite.geometry.thin_film import film_reflectance, film_table


def by_matrices(mu, body, ior, thickness_nm):
    """Reflected sunlight's share (3,) by the film's characteristic matrix (Born and Wolf, 1.6)."""
    table = colour_table()
    in_film, in_body = (np.sqrt(1.0 - (1.0 - mu**2) / n**2) for n in (ior, body))
    phase = 2.0 * np.pi * ior * thickness_nm * in_film / table[:, 0]
    shares = []
    for tilted in (False, True):
        air, film, below = (
            n / cosine if tilted else n * cosine
            for n, cosine in ((1.0, mu), (ior, in_film), (body, in_body))
        )
        b = np.cos(phase) + 1j * np.sin(phase) * below / film
        c = 1j * film * np.sin(phase) + below * np.cos(phase)
        shares.append(np.abs((air * b - c) / (air * b + c)) ** 2)
    sun = table[:, 4]
    reflected = rgb_from_spectrum(np.mean(shares, axis=0) * sun, table[:, 0])
    return reflected / rgb_from_spectrum(sun, table[:, 0])


@pytest.mark.parametrize("mu", [1.0, 0.4])
@pytest.mark.parametrize("thickness_nm", [0.0, 110.0, 450.0, 1200.0])
def test_a_film_reflects_as_its_characteristic_matrix_says(mu, thickness_nm):
    """On glass and on a mirror-like body, to half a percent of the light."""
    for body in (1.5, 6.0):
        f0 = ((body - 1.0) / (body + 1.0)) ** 2
        shown = film_reflectance(mu, f0, 1.33, thickness_nm)
        np.testing.assert_allclose(shown, by_matrices(mu, body, 1.33, thickness_nm), atol=5e-3)


def test_a_quarter_wave_takes_the_reflection_of_green_away():
    """As coatings of lenses do: an index of the root of the glass's."""
    ior = np.sqrt(1.5)
    green = film_reflectance(1.0, 0.04, ior, 540.0 / (4.0 * ior))[1]
    assert green < 0.05 * 0.04


def test_without_thickness_there_is_no_colour():
    """White stays white: the weights of the sun's colours sum to one in each channel."""
    shown = film_reflectance(1.0, 0.5, 1.4, 0.0)
    np.testing.assert_allclose(shown, 0.5, rtol=1e-12)


def test_the_table_holds_what_gives_the_reflectance_by_schlick():
    """Between its nodes too, to 1 %; a film of one thickness has one layer."""
    table = film_table(1.8, 200.0, 600.0)
    assert film_table(1.8, 600.0, 600.0).shape == (1, *table.shape[1:])
    layer, row, column = 20, 17, 24
    mu, part = (column + 0.5) / 31, (row + 0.5) / 23
    thickness_nm = 200.0 + 400.0 * layer / 47
    f0 = table[layer, row : row + 2, column : column + 2].mean(axis=(0, 1))
    shown = f0 + (1.0 - f0) * (1.0 - mu) ** 5
    np.testing.assert_allclose(shown, film_reflectance(mu, part**2, 1.8, thickness_nm), atol=0.01)
