"""The tables' axes: exact both ways, on any planet, at the ground, the top and the horizon."""

from dataclasses import replace

import numpy as np
import pytest
from bruneton_sky import Atmosphere
from bruneton_sky.geometry import horizon_mu
from bruneton_sky.tables.parametrisations import (
    Coordinates,
    Parametrisation,
    State,
    allowed_nu,
    irradiance_coordinates,
    irradiance_state,
    node_states,
    parametrisation_of,
    texture_coordinate,
    transmittance_coordinates,
    transmittance_state,
    unit_range,
)
from bruneton_sky.tables.sizes import TableSizes
from hypothesis import assume, example, given
from hypothesis import strategies as st

SIZES = TableSizes(altitude=5, mu=14, nu=3, mu_s=6)
OLD, NEW = parametrisation_of("2008"), parametrisation_of("2017")
YEARS = pytest.mark.parametrize("mapping", [OLD, NEW], ids=["2008", "2017"])
# Closer to an edge than this, but not on it, a double cannot hold the direction of a ray.
ALTITUDE = st.sampled_from([0.0, 1.0]) | st.floats(1e-8, 0.9999)
UNIT = st.floats(0.0, 1.0) | st.sampled_from([0.0, 1.0])
PLANETS = st.builds(
    lambda radius, thickness, sun: replace(
        Atmosphere.earth(),
        ground_radius_m=radius,
        top_altitude_m=radius * thickness,
        mu_s_min=sun,
    ),
    st.floats(1e5, 1e8),
    st.floats(1e-3, 0.3),
    st.floats(-0.9, 0.0),
)


def state_of(air: Atmosphere, height: float, mu: float, mu_s: float, nu: float) -> State:
    """A state; mu from -1 straight down over 0, the horizon from either side, to 1 straight up."""
    h = height * air.top_altitude_m
    level = float(horizon_mu(air.ground_radius_m, h))
    cosine = level + mu * (1.0 - level) if mu >= 0 else level + mu * (1.0 + level)
    hits = np.asarray(np.signbit(mu))
    return State(*map(np.asarray, (h, cosine, mu_s, nu)), hits)


@YEARS
@given(PLANETS, ALTITUDE, st.floats(-1.0, 1.0) | st.sampled_from([-0.0, 0.0]), UNIT, UNIT)
@example(Atmosphere.earth(), 0.0, 0.0, 0.0, 1.0)
@example(Atmosphere.earth(), 0.5, -0.0, 1.0, 0.0)
@example(Atmosphere.earth(), 1.0, -0.0, 0.5, 0.5)
def test_states_come_back(
    mapping: Parametrisation, air: Atmosphere, height: float, mu: float, sun: float, nu: float
) -> None:
    """What is looked up is what is there: state to coordinates to state, to 1e-9."""
    there = state_of(air, height, mu, air.mu_s_min + sun * (1.0 - air.mu_s_min), 2.0 * nu - 1.0)
    # Two rays have no length, whatever their direction.
    assume(not (height == 0 and there.hits_ground) and not (height == 1 and there.mu >= 0))
    at = mapping.to_coordinates(air, SIZES, there)
    assert all(0 <= c <= 1 for c in at)
    back = mapping.to_state(air, SIZES, at)
    assert back.altitude_m == pytest.approx(there.altitude_m, abs=1e-9 * air.top_altitude_m)
    assert np.array(back[1:4]) == pytest.approx(np.array(there[1:4]), abs=1e-9)
    assert back.hits_ground == there.hits_ground


@YEARS
@given(PLANETS, ALTITUDE, UNIT, UNIT, UNIT)
def test_coordinates_come_back(
    mapping: Parametrisation, air: Atmosphere, height: float, mu: float, nu: float, sun: float
) -> None:
    """Every place between nodes is one state: coordinates to state to coordinates, to 1e-9."""
    sky = texture_coordinate(mu, SIZES.mu // 2)
    units = (height, SIZES.altitude), (nu, SIZES.nu), (sun, SIZES.mu_s)
    altitude, angle, mu_s = (texture_coordinate(*unit) for unit in units)
    for along in (0.5 + 0.5 * sky, 0.5 - 0.5 * sky):
        there = Coordinates(altitude, along, angle, mu_s)
        state = mapping.to_state(air, SIZES, there)
        # Within a millionth of the horizon mu no longer tells how long a ray to the ground is.
        assume(not (state.hits_ground and (mu > 1 - 1e-6 or height == 0)))
        back = mapping.to_coordinates(air, SIZES, state)
        wasted = mapping is OLD and abs(state.mu) > 1.0 - 1e-12
        assert back.mu == pytest.approx(there.mu, abs=1e-9) or wasted
        others = [back[i] for i in (0, 2, 3)], [there[i] for i in (0, 2, 3)]
        assert others[0] == pytest.approx(others[1], abs=1e-9)


@given(PLANETS, ALTITUDE, UNIT)
def test_flat_tables_come_back(air: Atmosphere, height: float, along: float) -> None:
    """Transmittance and irradiance: coordinates to state to coordinates, to 1e-9."""
    shape = (16, 64)
    there = texture_coordinate(height, 16), texture_coordinate(along, 64)
    back = transmittance_coordinates(air, shape, *transmittance_state(air, shape, *there))
    assert back == pytest.approx(there, abs=1e-9)
    back = irradiance_coordinates(air, shape, *irradiance_state(air, shape, *there))
    assert back == pytest.approx(there, abs=1e-9)


@pytest.mark.parametrize("year", ["2008", "2017"])
def test_nodes_are_texel_centres(year, other_planet: Atmosphere) -> None:  # type: ignore[no-untyped-def]
    """Node i of n lies at (i + 0.5) / n, and the ends are ground, top, zenith and lowest sun."""
    nodes = node_states(other_planet, SIZES, year)
    assert nodes.altitude_m.ravel()[[0, -1]] == pytest.approx([0.0, 90_000.0], abs=1e-6)
    assert nodes.mu_s.ravel()[[0, -1]] == pytest.approx([-0.3, 1.0], abs=1e-9)
    level = horizon_mu(other_planet.ground_radius_m, nodes.altitude_m[2:, 0])
    assert nodes.mu[2:, 0] == pytest.approx(level, abs=1e-12)
    assert nodes.mu[2:, -1] == pytest.approx(level, abs=1e-12)
    at = parametrisation_of(year).to_coordinates(other_planet, SIZES, nodes)
    assert at.mu_s.ravel() * SIZES.mu_s == pytest.approx(np.arange(SIZES.mu_s) + 0.5, abs=1e-6)


def test_half_texels() -> None:
    """An axis of n nodes spans 0.5 / n to 1 - 0.5 / n, where a GPU samples texels unmixed."""
    assert texture_coordinate([0.0, 1.0], 4) == pytest.approx([0.125, 0.875])
    assert unit_range([0.125, 0.875], 4) == pytest.approx([0.0, 1.0])


def test_published_formulas_of_2008() -> None:
    """The thesis's equations 2.31 to 2.34, corrected, in radii at a middling state."""
    air, ground, top = Atmosphere.earth(), 6.36e6, 6.42e6
    air = replace(air, mu_s_min=-0.2)
    r, mu, mu_s, nu = 6.375e6, -0.2, 0.4, 0.3
    rho, tangent = np.sqrt(r * r - ground * ground), np.sqrt(top * top - ground * ground)
    delta = r * r * mu * mu - rho * rho
    down = 0.5 + (r * mu + np.sqrt(delta)) / (2 * rho)
    up = 0.5 - (0.1 * r - np.sqrt((0.1 * r) ** 2 - rho**2 + tangent**2)) / (2 * (rho + tangent))
    sizes = TableSizes(altitude=10**9, mu=2 * 10**9, nu=10**9, mu_s=10**9)
    for cosine, hits, u_mu in ((mu, True, down), (0.1, False, up)):
        state = State(*map(np.asarray, (r - ground, cosine, mu_s, nu)), np.asarray(hits))
        at = OLD.to_coordinates(air, sizes, state)
        u_mu_s = (1 - np.exp(-3 * mu_s - 0.6)) / (1 - np.exp(-3.6))
        # With so many nodes half a texel is nothing.
        assert at == pytest.approx((rho / tangent, u_mu, (1 + nu) / 2, u_mu_s), abs=1e-8)


def test_nu_is_held_to_what_two_zenith_angles_allow() -> None:
    """Two directions 30 and 50 deg from the zenith are 20 to 80 deg apart."""
    cosines = np.cos(np.radians([30.0, 50.0]))
    held = allowed_nu(cosines[0], cosines[1], np.array([-1.0, 0.5, 1.0]))
    assert held == pytest.approx([np.cos(np.radians(80.0)), 0.5, np.cos(np.radians(20.0))])


def test_unknown_parametrisation_is_refused() -> None:
    """A year in which none was published cannot be meant."""
    with pytest.raises(ValueError, match='must be "2017" or "2008", not \'2012\''):
        parametrisation_of("2012")  # type: ignore[arg-type]
