"""The nodes of a volume of air, and look-ups of it."""

import msgspec
import numpy as np
import pytest
from air_phases import lobe
from hypothesis import given
from hypothesis import strategies as st

from vrut_lite.array import Array
from vrut_lite.messages.air import AirVolume
from vrut_lite.messages.gpu_texture import GpuTexture
from vrut_lite.sky.air_rows import AirGrid, grid_of, horizon_depth, row_heights
from vrut_lite.sky.air_volume import (
    entry_distance_m,
    light_of,
    look_up_air,
    node_rays,
    slice_shares,
    span_m,
)

SLICES, ROWS_ABOVE, ROWS_BELOW, COLUMNS = 7, 5, 4, 6
ROWS = ROWS_ABOVE + ROWS_BELOW
SUN = (0.48, 0.6, -0.64)
EARTH, OTHER = (6_360_000.0, 60_000.0), (1_200_000.0, 150_000.0)
ALTITUDES = [0.0, 2.0, 3000.0, 59_999.0, 200_000.0, 4e8]


def grid_at(
    altitude_m: float, planet: tuple[float, float] = EARTH, reach_m: float = 9e4
) -> AirGrid:
    """An observer over a planet."""
    return AirGrid(altitude_m, *planet, reach_m, ROWS_ABOVE, ROWS_BELOW)


def volume_of(grid: AirGrid, light: np.ndarray, extinction: np.ndarray) -> AirVolume:
    """A volume of these values: light (3, slices, rows, columns, 3), without a phase function."""
    return AirVolume(
        light=Array(light.astype(np.float16)),
        columns=COLUMNS,
        extinction=Array(extinction.astype(np.float32)),
        radiance_scale=2.0,
        aerosol_phase=lobe(factor=1.0 / (4.0 * np.pi), angles=2),
        sun_direction=SUN,
        **grid._asdict(),
    )


def even_volume(grid: AirGrid, extinction_per_m: float = 1e-5) -> AirVolume:
    """The same air everywhere."""
    light = np.broadcast_to(
        np.array([1.0, 2.0, 4.0])[:, None, None, None, None], (3, SLICES, ROWS, COLUMNS, 3)
    )
    return volume_of(grid, light, np.full((SLICES, ROWS, 3), extinction_per_m))


def rayleigh(nu: float) -> float:
    """The phase function of molecules, sr^-1."""
    return 3.0 / (16.0 * np.pi) * (1.0 + nu * nu)


def direction_of(one_plus_mu: float, cos_phi: float) -> np.ndarray:
    """The unit vector at a height and an azimuth from the sun."""
    sine = np.sqrt(one_plus_mu * (2.0 - one_plus_mu))
    ahead = np.array([SUN[0], SUN[2]]) / np.hypot(SUN[0], SUN[2])
    aside = np.array([-ahead[1], ahead[0]])
    level = sine * (cos_phi * ahead + np.sqrt(1.0 - cos_phi * cos_phi) * aside)
    return np.array([level[0], one_plus_mu - 1.0, level[1]])


@pytest.mark.parametrize("planet", [EARTH, OTHER])
@pytest.mark.parametrize("altitude_m", ALTITUDES)
def test_look_up_is_exact_on_the_nodes(altitude_m: float, planet: tuple[float, float]) -> None:
    """A look-up at a node returns the node's light, for any observer and planet: nodes are filled
    for the rays they are looked up for. Within 1e-4, the precision of a direction from 4e8 m in
    float64."""
    grid = grid_at(altitude_m, planet)
    dice = np.random.default_rng(7)
    light = dice.uniform(0.5, 2.0, (3, SLICES, ROWS, COLUMNS, 3))
    extinction = dice.uniform(0.5e-5, 2e-5, (SLICES, ROWS, 3))
    volume = volume_of(grid, light, extinction)
    rays = node_rays(grid, COLUMNS, SUN[1])
    heights = row_heights(grid)
    shares = slice_shares(SLICES, altitude_m)
    # Excluded: the horizon, which is a row on both sides; the air's edge, which has no air; nadir
    # and zenith, where all azimuths coincide.
    inner = [r for r in range(ROWS) if r not in (0, ROWS_ABOVE, ROWS_ABOVE - 1, ROWS - 1)]
    for row in inner:
        for column, cos_phi in enumerate(1.0 - 2.0 * np.linspace(0.0, 1.0, COLUMNS) ** 2):
            view = direction_of(heights[row], cos_phi)
            inside_m = shares[1:] * rays.span_m[row]
            entry = float(entry_distance_m(volume, view))
            found = look_up_air(volume, np.broadcast_to(view, (SLICES - 1, 3)), entry + inside_m)
            depth = volume.extinction.values[1:, row].astype(float) * inside_m[:, None]
            weight = -np.expm1(-depth) * 2.0
            assert found.transmittance == pytest.approx(np.exp(-depth), rel=1e-4)
            shaded, direct, aerosol = light_of(volume)[:, 1:, row, column].astype(float)
            assert found.shaded == pytest.approx(weight * shaded, rel=2e-4)
            nu = float(view @ np.array(SUN))
            sunlit = weight * (direct * rayleigh(nu) + aerosol / (4.0 * np.pi))
            assert found.sunlit == pytest.approx(sunlit, rel=2e-4)


@given(
    altitude_m=st.sampled_from(ALTITUDES),
    planet=st.sampled_from([EARTH, OTHER]),
    reach_m=st.sampled_from([50.0, 9e4, 1e7]),
    height=st.floats(-1.0, 1.0),
    azimuth=st.floats(0.0, 7.0),
    share=st.floats(0.0, 1.5),
)
def test_uniform_air_is_the_same_in_every_direction(
    altitude_m: float,
    planet: tuple[float, float],
    reach_m: float,
    height: float,
    azimuth: float,
    share: float,
) -> None:
    """With equal values at all nodes T = exp(-extinction * metres in the air) in every direction
    and at every distance, the horizon, zenith, nadir and the air's edge included."""
    grid = grid_at(altitude_m, planet, reach_m)
    volume = even_volume(grid)
    sine = np.sqrt((1.0 - height) * (1.0 + height))
    view = np.array([sine * np.sin(azimuth), height, -sine * np.cos(azimuth)])
    entry = float(entry_distance_m(volume, view))
    metres = (entry if np.isfinite(entry) else 0.0) + share * reach_m
    found = look_up_air(volume, view, metres)
    depth = -np.log(found.transmittance)
    whole = 1e-5 * min(share * reach_m, reach_m)
    assert np.all(depth <= whole * (1.0 + 1e-6) + 1e-12)
    assert np.ptp(depth) == 0.0
    weight = -np.expm1(-depth) * 2.0
    assert found.shaded == pytest.approx(weight * 1.0)
    nu = float(view @ np.array(SUN))
    assert found.sunlit == pytest.approx(weight * (2.0 * rayleigh(nu) + 4.0 / (4.0 * np.pi)))
    if not np.isfinite(entry):
        assert np.all(depth == 0.0)


def test_light_on_the_gpu_is_not_looked_up_here() -> None:
    """The look-up refuses light on the GPU, in a sentence that says what to do."""
    texture = GpuTexture(size=(COLUMNS, ROWS, 3 * SLICES), format="rgba32f", recipe="")
    volume = msgspec.structs.replace(even_volume(grid_at(2.0)), light=texture)
    with pytest.raises(ValueError, match="ask for air made on the CPU"):
        look_up_air(volume, np.array([0.0, 0.0, -1.0]), 10.0)


@pytest.mark.parametrize("altitude_m", [0.0, 2.0, 3000.0, 59_999.0])
def test_no_step_at_the_horizon(altitude_m: float) -> None:
    """Just above and below the horizon the same distance has the same air."""
    grid = grid_at(altitude_m)
    volume = even_volume(grid)
    horizon = horizon_depth(grid)[0]
    for metres in (10.0, 1e3, 3e4):
        above, below = (
            look_up_air(volume, direction_of(horizon * (1.0 + side), 0.3), metres).transmittance
            for side in (1e-9, -1e-9)
        )
        assert above == pytest.approx(below, rel=1e-9)
        assert above == pytest.approx(np.exp(-1e-5 * min(metres, 9e4)), rel=1e-6)


@pytest.mark.parametrize("planet", [EARTH, OTHER])
@pytest.mark.parametrize("altitude_m", [0.0, 2.0, 3000.0, 40_000.0])
def test_slices_reach_past_the_ground(altitude_m: float, planet: tuple[float, float]) -> None:
    """Slices of rays below the horizon continue below the level, straight down by 500 m: the air
    before objects on the ground must be complete."""
    grid = grid_at(altitude_m, planet, reach_m=1e7)
    radius = planet[0] + altitude_m
    heights = horizon_depth(grid)[0] * (1.0 - np.linspace(0.0, 1.0, 50) ** 2)
    mu = heights - 1.0
    squares = altitude_m * (2.0 * planet[0] + altitude_m)
    root = np.sqrt(np.maximum((radius * mu) ** 2 - squares, 0.0))
    to_ground = squares / np.maximum(root - radius * mu, 1e-30)
    span = span_m(grid, altitude_m, mu, True)
    assert np.all(span >= np.minimum(to_ground, 1e7) * (1.0 - 1e-9))
    assert span[-1] == pytest.approx(altitude_m + 500.0)


@pytest.mark.parametrize("planet", [EARTH, OTHER])
def test_spans_end_where_the_air_ends(planet: tuple[float, float]) -> None:
    """Upward spans end at the top of the air: vertically at its height, along the level after
    sqrt(2 R top + top^2)."""
    grid = grid_at(0.0, planet, reach_m=1e9)
    radius, top_m = planet
    assert float(span_m(grid, 0.0, 1.0, False)) == pytest.approx(top_m)
    chord_m = np.sqrt(top_m * (2.0 * radius + top_m))
    assert float(span_m(grid, 0.0, 0.0, False)) == pytest.approx(chord_m)


@pytest.mark.parametrize("planet", [EARTH, OTHER])
def test_an_eye_at_the_top_of_the_air_sees_no_step(planet: tuple[float, float]) -> None:
    """Downward rays from a metre below and above the top of the air give the same air."""
    top_m = planet[1]
    for mu in (-0.2, -0.5, -1.0):
        view = np.array([np.sqrt(1.0 - mu * mu), mu, 0.0])
        inside, outside = (
            look_up_air(even_volume(grid_at(top_m + side, planet)), view, 5e4).transmittance
            for side in (-1.0, 1.0)
        )
        assert inside == pytest.approx(outside, rel=1e-4)


@pytest.mark.parametrize("altitude_m", [70_000.0, 4e8])
def test_rays_enter_the_air_where_it_begins(altitude_m: float) -> None:
    """Rays enter at the top of the air, and rays past the planet never; also from the Moon's
    distance, where rounding is 1e-7 m of 4e8."""
    volume = even_volume(grid_at(altitude_m))
    radius, top_radius = 6_360_000.0 + altitude_m, 6_420_000.0
    for sine in np.array([0.0, 0.3, 0.9, 0.999]) * top_radius / radius:
        mu = -np.sqrt((1.0 - sine) * (1.0 + sine))
        metres = float(entry_distance_m(volume, np.array([sine, mu, 0.0])))
        there = np.hypot(metres * sine, radius + metres * mu)
        assert there == pytest.approx(top_radius, abs=1.0)
    sine = 1.001 * top_radius / radius
    mu = np.sqrt((1.0 - sine) * (1.0 + sine))
    for miss in ([sine, -mu, 0.0], [sine, mu, 0.0], [0.0, 1.0, 0.0]):
        assert np.isinf(entry_distance_m(volume, np.array(miss)))


def test_slices_are_dense_near_the_ground() -> None:
    """Slices are dense at an eye on the ground, uniform at 5 km, and dense at the far end for a
    higher eye, where the ground and the haze are."""
    low, middle, high = (np.diff(slice_shares(9, h)) for h in (0.0, 5000.0, 60_000.0))
    assert np.all(np.diff(low) > 0.0)
    assert middle == pytest.approx(np.full(8, 0.125))
    assert np.all(np.diff(high) < 0.0)
    for shares in (low, middle, high):
        assert shares.sum() == pytest.approx(1.0)


def test_a_volumes_grid_has_its_parameters() -> None:
    """`grid_of` returns the parameters with which the volume was made."""
    grid = grid_at(1234.0, OTHER)
    assert grid_of(even_volume(grid)) == grid
