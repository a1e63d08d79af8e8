"""Aerosol as measured: OPAC's published numbers, mixtures, Mie's theory, phase tables."""

import numpy as np
import pytest

from vrut_lite.atmosphere.aerosol import cornette_shanks_phase
from vrut_lite.atmosphere.aerosols import (
    OPAC_TYPES,
    PhaseTable,
    mixture_optics,
    optics_of_aerosol,
    type_optics,
)
from vrut_lite.atmosphere.aerosols.components import component
from vrut_lite.atmosphere.aerosols.droplets import droplets_phase
from vrut_lite.atmosphere.aerosols.mie import lognormal_volume, optics_of_sizes
from vrut_lite.atmosphere.aerosols.own import OwnAerosol
from vrut_lite.atmosphere.aerosols.phase_table import PHASE_NODES
from vrut_lite.atmosphere.aerosols.stratosphere import BACKGROUND_DEPTH_550, stratosphere
from vrut_lite.atmosphere.aerosols.types import AerosolMixture

# Hess, Koepke and Schult 1998, table 4: optical depth at 550 nm at 80 % humidity.
PUBLISHED_DEPTHS = {
    "continental-clean": 0.064,
    "continental-average": 0.151,
    "continental-polluted": 0.327,
    "urban": 0.643,
    "maritime-clean": 0.096,
    "maritime-polluted": 0.117,
    "maritime-tropical": 0.056,
    "desert": 0.286,
    "arctic": 0.063,
}
# OPAC's own water-soluble particles at 80 % humidity and 550 nm, one per cm^3: extinction and
# scattering in 1/km, mean cosine, and volume phase function in 1/km/sr by angle in degrees.
WATER_SOLUBLE = (9.584e-6, 9.434e-6, 0.704)
WATER_SOLUBLE_PHASE = {
    0: 1.213e-5,
    5: 1.098e-5,
    10: 8.937e-6,
    20: 5.284e-6,
    40: 1.656e-6,
    60: 5.639e-7,
    90: 1.638e-7,
    120: 9.606e-8,
    150: 1.194e-7,
    180: 1.456e-7,
}


def test_the_nine_types_have_the_published_optical_depths():
    """To 0.5 %, and half of the last digit that is printed; with the background of the
    stratosphere, which lies in a layer of its own."""
    assert set(OPAC_TYPES) == set(PUBLISHED_DEPTHS)
    for name, depth in PUBLISHED_DEPTHS.items():
        whole = type_optics(name).optical_depth_550 + BACKGROUND_DEPTH_550
        assert whole == pytest.approx(depth, rel=5e-3, abs=5e-4)


def test_the_table_of_water_soluble_particles_is_opacs():
    """The phase function to 1 %, the rest too, after interpolation onto the table's nodes."""
    waso = component("waso", 80.0)
    at = list(waso.wavelength_nm).index(550.0)
    extinction, scattering, mean_cosine = WATER_SOLUBLE
    assert waso.extinction[at] == pytest.approx(extinction, rel=5e-3)
    assert waso.scattering[at] == pytest.approx(scattering, rel=5e-3)
    table = PhaseTable.of_angles(waso.angle_rad, waso.phase)
    assert table.mean_cosine()[at] == pytest.approx(mean_cosine, rel=5e-3)
    cosines = np.cos(np.radians(list(WATER_SOLUBLE_PHASE)))
    volume_phase = scattering * table(cosines)[:, at]
    # A kilometre's phase function over its scattering has the integral 4 pi, ours 1.
    np.testing.assert_allclose(
        volume_phase, np.array(list(WATER_SOLUBLE_PHASE.values())), rtol=0.01
    )


def test_types_differ_as_their_particles_do():
    """Soot absorbs, salt and dust are grey, salt and dust scatter farther forward."""
    urban, clean = type_optics("urban"), type_optics("continental-clean")
    assert urban.albedo_at(550.0) == pytest.approx(0.817, abs=0.005)
    assert clean.albedo_at(550.0) > 0.95
    assert type_optics("desert").angstrom_exponent < 0.3 < 1.2 < clean.angstrom_exponent
    forward = {name: type_optics(name).phase_at([550.0])(1.0)[0] for name in OPAC_TYPES}
    assert min(forward["desert"], forward["maritime-clean"]) > 2.5 * forward["continental-average"]


def test_humid_air_is_hazier():
    """Water-soluble particles and salt grow; dust and soot do not."""
    depths = [type_optics("maritime-clean", h).optical_depth_550 for h in (0.0, 60.0, 80.0, 95.0)]
    assert depths == sorted(depths)
    assert depths[-1] > 2.5 * depths[0]
    between = type_optics("maritime-clean", 75.0).optical_depth_550
    drier, wetter = (type_optics("maritime-clean", h).optical_depth_550 for h in (70.0, 80.0))
    assert between == pytest.approx(0.5 * (drier + wetter), rel=1e-6)


def test_a_mixture_of_ones_own_adds_its_components():
    """Twice the particles are twice the depth of the lower layer, with the same phase function."""
    once, twice = (
        mixture_optics(AerosolMixture({"waso": n, "soot": n}, 2.0, 2.0)) for n in (1e3, 2e3)
    )
    (low, aloft), (lower, still_aloft) = once.layers, twice.layers
    assert lower.depth_at([550.0]) == pytest.approx(2.0 * low.depth_at([550.0]))
    assert still_aloft.depth_at([550.0]) == pytest.approx(aloft.depth_at([550.0]))
    assert low.height_m == pytest.approx(2000.0 * (1 - np.exp(-1)))


def test_aerosol_of_ones_own_follows_angstroms_law():
    """Depth, exponent, albedo and one lobe are what was given."""
    own = optics_of_aerosol(0.3, 0.95, 0.7, angstrom_exponent=1.5, scale_height_m=900.0)
    assert own.optical_depth_550 == pytest.approx(0.3)
    assert own.angstrom_exponent == pytest.approx(1.5)
    assert own.albedo_at([400.0, 700.0]) == pytest.approx([0.95, 0.95])
    nu = np.linspace(-1.0, 1.0, 201)
    np.testing.assert_allclose(
        own.phase_at([500.0])(nu)[:, 0], cornette_shanks_phase(nu, 0.7), rtol=2e-4
    )


def test_coefficients_of_a_table_are_the_phase_functions():
    """Henyey and Greenstein's are powers of g."""

    def phase(nu):
        return (1 - 0.8**2) / (4 * np.pi) / (1 + 0.8**2 - 2 * 0.8 * nu) ** 1.5

    chi = PhaseTable.of_function(phase).coefficients(32)[0]
    np.testing.assert_allclose(chi, 0.8 ** np.arange(33), atol=1e-4)


@pytest.mark.long
def test_spheres_by_mies_theory_are_the_tabulated_component():
    """A lognormal distribution of OPAC's size and refractive index gives OPAC's particles."""
    pytest.importorskip("miepython", reason="the package miepython is not installed")

    radius = np.geomspace(0.0067, 1.5, 60)
    own = optics_of_sizes(
        radius, lognormal_volume(radius, 0.0306, 2.24), (550.0, 560.0), (1.399 - 0.002j,) * 2
    )
    waso = component("waso", 80.0)
    at = list(waso.wavelength_nm).index(550.0)
    # One sphere over a square um is 1e6 times one in a cubic cm of a layer of one km, in 1/km.
    assert own.optical_depth_550 == pytest.approx(1e3 * waso.extinction[at], rel=0.02)
    assert own.albedo_at(550.0) == pytest.approx(
        waso.scattering[at] / waso.extinction[at], abs=2e-3
    )
    angles = np.radians([10.0, 40.0, 90.0, 150.0])
    expected = np.interp(angles, waso.angle_rad, waso.phase[at])
    np.testing.assert_allclose(own.phase(np.cos(angles))[:, 0], expected, rtol=0.02)


@pytest.mark.parametrize(
    "make",
    [
        lambda: type_optics("suburban"),
        lambda: type_optics("urban", 120.0),
        lambda: component("sulphate"),
        lambda: optics_of_aerosol(-0.1, 0.9, 0.7),
        lambda: optics_of_aerosol(0.1, 1.2, 0.7),
        lambda: optics_of_aerosol(0.1, 0.9, 1.5),
        lambda: mixture_optics(AerosolMixture({}, 2.0, 2.0)),
        lambda: mixture_optics(AerosolMixture({"waso": -1.0}, 2.0, 2.0)),
        lambda: mixture_optics(AerosolMixture({"waso": np.inf}, 2.0, 2.0)),
        lambda: mixture_optics(AerosolMixture({"waso": 1e3}, 0.0, 2.0)),
        lambda: optics_of_sizes([0.1, 1.0], [1.0, 1.0], [500.0, 600.0], [np.nan, 1.4]),
        lambda: optics_of_sizes([0.1, 1.0], [1.0, 1.0], [500.0, 600.0], [1.0, 1.0]),
        lambda: optics_of_sizes([0.1, 1.0], [1.0, 1.0], [500.0, 600.0], ["a", "b"]),
        lambda: PhaseTable(np.ones((1, 7))),
        lambda: PhaseTable(-np.ones((1, PHASE_NODES))),
        lambda: PhaseTable.of_angles([0.0, 1.0], [1.0, 1.0]),
        lambda: PhaseTable(np.ones((1, PHASE_NODES)), np.zeros((1, PHASE_NODES))),
        lambda: PhaseTable(np.ones((1, PHASE_NODES)), np.full((2, 1, PHASE_NODES), 0.9)),
        lambda: OwnAerosol(angle_deg=(0, 180), phase=(1, 1), p12=(0, 0)).optics,
    ],
)
def test_what_is_impossible_is_refused_in_a_sentence(make):
    with pytest.raises(ValueError, match=r"\w+ \w+"):
        make()


def test_spheres_much_smaller_than_a_wavelength_polarise_as_molecules_do():
    """Rayleigh's limit, whose scattering matrix is known in closed form, holds sign and scale."""
    pytest.importorskip("miepython", reason="the package miepython is not installed")
    wavelength = [500.0, 600.0]
    phase = optics_of_sizes([0.004, 0.005], [1.0, 1.0], wavelength, [1.5, 1.5]).phase
    nu = np.linspace(-1.0, 1.0, 21)
    p12, p33 = phase.polarisation(nu)
    assert p12[:, 0] == pytest.approx(-(1.0 - nu**2) / (1.0 + nu**2), abs=0.005)
    assert p33[:, 0] == pytest.approx(2.0 * nu / (1.0 + nu**2), abs=0.005)


def test_what_is_mixed_polarises_by_what_each_part_scatters():
    """P12 and P33 add as the phase function does, weighted by it, not by themselves."""
    nodes = np.zeros((1, PHASE_NODES))
    dark, bright = PhaseTable(nodes + 1.0, [nodes - 0.6, nodes]), PhaseTable(nodes + 1.0)
    p12, p33 = PhaseTable.mixed([dark, bright], [[1.0], [3.0]]).polarisation(0.3)
    assert (p12[0], p33[0]) == pytest.approx((-0.15, 0.75))
    rows = PhaseTable(
        np.concatenate([nodes + 1.0] * 2), [nodes - [[0.6], [0.0]], nodes * [[0], [0]]]
    )
    assert rows.at_rows([[0.5, 0.5]]).polarisation(0.3)[0] == pytest.approx([-0.3])


def test_hazes_of_fine_particles_polarise_more_than_those_of_coarse_ones():
    """At a right angle; light scattered forward keeps its polarisation in all of them."""
    at_90 = {
        name: type_optics(name).phase_at([550.0]).polarisation(0.0)[0][0] for name in OPAC_TYPES
    }
    assert at_90["urban"] < at_90["maritime-clean"] < at_90["desert"]
    assert -0.5 < min(at_90.values()) < -0.4
    assert max(at_90.values()) == pytest.approx(0.0, abs=0.02)
    for name in OPAC_TYPES:
        p12, p33 = type_optics(name).phase_at([550.0]).polarisation(1.0)
        assert (p12[0], p33[0]) == pytest.approx((0.0, 1.0), abs=1e-3)


def test_a_users_scattering_matrix_reaches_the_table():
    own = OwnAerosol(angle_deg=(0, 90, 180), phase=(2, 1, 2), p12=(0, -0.4, 0), p33=(2, 0, -2))
    p12, p33 = own.optics.phase.polarisation([1.0, 0.0, -1.0])
    assert p12[:, 0] == pytest.approx([0.0, -0.4, 0.0], abs=1e-3)
    assert p33[:, 0] == pytest.approx([1.0, 0.0, -1.0], abs=1e-3)


def test_tables_are_equal_by_content():
    """They stand in what keys a cache."""
    one, same = (PhaseTable(np.ones((2, PHASE_NODES))) for _ in range(2))
    assert one == same
    assert hash(one) == hash(same)
    assert one != PhaseTable(np.ones((1, PHASE_NODES)))


def test_droplets_have_a_fogbow_and_no_peak_that_harmonics_cannot_carry():
    """Mie's mean cosine and bow stay; the harmonics to degree 16 hold what is left."""
    phase = droplets_phase((635.0, 550.0, 445.0))
    assert phase.mean_cosine() == pytest.approx([0.845] * 3, abs=0.01)
    bow, beside = (phase(np.cos(np.radians(angle)))[1] for angle in (142.0, 120.0))
    assert bow > 4.0 * beside
    assert np.abs(phase.coefficients(24)[:, 17:]).max() < 0.02


def test_droplets_of_the_stratosphere_are_those_of_their_depth():
    """The background's are small: their depth falls with the wavelength to the power -1.3, about
    Angstrom's mean; those of an eruption are larger, and nearly grey. None absorb."""
    exponents = []
    for depth in (0.005, 0.3):
        layer = stratosphere(depth)
        assert layer.depth_at([550.0])[0] == pytest.approx(depth)
        assert layer.albedo_at([450.0, 650.0]) == pytest.approx(1.0, abs=1e-6)
        blue, red = layer.depth_at([445.0, 635.0])
        exponents.append(np.log(blue / red) / np.log(635.0 / 445.0))
    assert exponents[0] == pytest.approx(1.3, abs=0.1)
    assert abs(exponents[1]) < 0.6
