"""Multiple scattering in cases whose answer is known without solving."""

from dataclasses import replace

import numpy as np
import pytest
from bruneton_sky import Atmosphere
from bruneton_sky.geometry import distance_to_ground, make_ray
from bruneton_sky.optical_path import optical_depth, optical_depth_to_top
from bruneton_sky.phase import mie_phase, rayleigh_phase
from bruneton_sky.published.precompute import march_tables
from bruneton_sky.published.single_scattering import single_scattering
from bruneton_sky.solver import (
    SolverSizes,
    SourceField,
    ground_irradiance,
    multiple_scattering,
    single_scattering_fast,
    solve,
)
from bruneton_sky.solver.grid import azimuths
from bruneton_sky.solver.nodes import NodeLight, make_nodes
from bruneton_sky.solver.wavelength_groups import groups_of_air
from bruneton_sky.tables.parametrisations import node_states
from bruneton_sky.tables.sizes import TableSizes

SMALL = SolverSizes(altitude=12, mu_s=24, direction_mu=16, direction_azimuth=8, degree=8)
SUNS = np.linspace(-0.3, 1.0, 66)
FEW = TableSizes(altitude=4, mu=8, nu=4, mu_s=6)


def rays(mu_s: float, count: int = 9) -> tuple[np.ndarray, np.ndarray]:
    """mu, nu of rays all around, of one mu after the other."""
    mu = np.repeat(np.linspace(-1.0, 1.0, count), 5)
    cosine = np.tile(np.cos(np.linspace(0.0, np.pi, 5)), count)
    return mu, mu * mu_s + np.sqrt((1.0 - mu**2) * (1.0 - mu_s**2)) * cosine


def look(field: SourceField, altitude_m: float, mu_s: float) -> np.ndarray:
    mu, nu = rays(mu_s)
    return multiple_scattering(field, altitude_m, mu, mu_s, nu)


def conservative(air: Atmosphere, albedo: float) -> Atmosphere:
    none = (0.0,) * len(air.wavelength_nm)
    return replace(
        air,
        mie_extinction=air.mie_scattering,
        absorption_extinction=none,
        ground_albedo=(albedo,) * len(none),
    )


@pytest.mark.parametrize("order", [3, 4])
def test_furnace(order: int) -> None:
    """In isotropic light of radiance 1, over a ground of radiance 1, air that absorbs nothing
    shines so that all radiance stays 1: a source function of 1 along a ray gives 1 - T, however
    few the bins and azimuths of the higher orders."""
    air, sizes = conservative(Atmosphere.earth(), 1.0), replace(SMALL, higher_azimuth=5)
    group = groups_of_air(air)[0]
    nodes = make_nodes(air, group, replace(sizes, higher_bins=6))
    shape = (12, 16, sizes.azimuths_of(order), 24 * 4)
    ones = np.ones(shape, dtype=np.float32)
    source = nodes.source(NodeLight(nodes.operator.project(ones)))
    # The sky's irradiance that makes a white ground shine with radiance 1 is that of ones, pi.
    light = nodes.next_radiance(source, ones, order).reshape(*shape[:3], 24, 4)[..., :3]
    through = nodes.bins.end[:, :, None, None, :3]
    down = nodes.operator.directions.downward
    lit = nodes.suns.mu_s >= 1.0  # every sun alike
    assert light[:, down] == pytest.approx(1.0, abs=2e-4)
    expected = np.broadcast_to(1.0 - through, light.shape)[:, ~down]
    assert light[:, ~down][..., lit, :] == pytest.approx(expected[..., lit, :], abs=2e-4)


@pytest.mark.parametrize(
    ("visibility_m", "orders", "error"),
    [(None, 6, 5e-3), pytest.param(200.0, 20, 0.01, marks=pytest.mark.long)],
)
def test_without_absorption_all_sunlight_returns(
    visibility_m: float | None, orders: int, error: float
) -> None:
    """Without absorption over white ground all sunlight returns: within 0.5 % of solar
    irradiance times the disc's area, all orders, ground and air together (issue: 0.5 %); with
    white fog 100 m high, 1 %."""
    air = conservative(Atmosphere.earth(), 1.0)
    if visibility_m is not None:
        air = air.with_fog(visibility_m, 100.0)
    field = solve(air, orders=orders, all_orders=True)
    radius, top = air.ground_radius_m, air.top_altitude_m
    # Over the top: flux(mu_s) = integral of L mu over outgoing directions; the disc of the
    # sun's light at the top has the area pi r^2, and the sphere's rings 2 pi r^2 d mu_s.
    suns, sun_weight = np.polynomial.legendre.leggauss(24)
    x, w = np.polynomial.legendre.leggauss(16)
    horizon = np.sqrt(1.0 - (radius / (radius + top)) ** 2)
    down = np.concatenate(
        [-horizon - (1.0 - horizon) * (0.5 + 0.5 * x) ** 2, -horizon * (0.5 + 0.5 * x)]
    )
    weight = np.concatenate([(1.0 - horizon) * (0.5 + 0.5 * x) * w, 0.5 * horizon * w])
    turns = azimuths(12)
    mu = np.repeat(down, turns.size)
    ring = np.repeat(weight * -down, turns.size) * 2.0 * np.pi / turns.size
    outgoing, irradiance = np.zeros(3), ground_irradiance(field, SUNS)
    for mu_s, share in zip(suns, sun_weight, strict=True):
        nu = mu * mu_s + np.sqrt((1 - mu**2) * (1 - mu_s**2)) * np.tile(np.cos(turns), down.size)
        light = multiple_scattering(field, top, mu, mu_s, nu)
        light += single_scattering(
            air, top, mu, mu_s, nu, samples=10 if visibility_m is None else 24
        )
        light += ground_seen(air, irradiance, mu, mu_s, nu)
        outgoing += share * (ring[:, None] * light).sum(axis=0)
    scattered_out = 2.0 * outgoing
    # Sunlight that grazes the air and leaves it unscattered does not come in at all.
    grazing = direct_beam_through(air)
    entered = np.asarray(air.solar_irradiance) * (1.0 - grazing)
    assert scattered_out == pytest.approx(entered, rel=error)


def ground_seen(
    air: Atmosphere, irradiance: np.ndarray, mu: np.ndarray, mu_s: float, nu: np.ndarray
) -> np.ndarray:
    """Radiance (n, C) of the white ground at the end of rays from the top."""
    top, radius = air.top_altitude_m, air.ground_radius_m
    ray = make_ray(radius, top, mu)
    hits = ray.hits_ground()
    distance = distance_to_ground(radius, top, mu)
    sun = np.clip(((radius + top) * mu_s + distance * nu) / radius, -1.0, 1.0)
    end_y = -np.sqrt(np.maximum(-ray.perigee_altitude_m, 0.0))
    passed = np.exp(-optical_depth(air, ray, np.zeros(mu.size), end_y))
    direct = np.exp(-optical_depth_to_top(air, 0.0, np.maximum(sun, 0.0)))
    direct *= np.maximum(sun, 0.0)[:, None] * np.asarray(air.solar_irradiance)
    sky = np.stack([np.interp(sun, SUNS, lane) for lane in irradiance.T], axis=-1)
    return np.where(hits[:, None], passed * (direct + sky) / np.pi, 0.0)


def direct_beam_through(air: Atmosphere) -> np.ndarray:
    """Share (C,) of the sunlight on the disc of the air's top that passes above the ground."""
    radius, top = air.ground_radius_m, air.top_altitude_m
    x, w = np.polynomial.legendre.leggauss(64)
    perigee = 0.5 * top * (x + 1.0)
    passed = np.exp(-2.0 * optical_depth_to_top(air, perigee, np.zeros(64)))
    area = (0.5 * top * w * 2.0 * (radius + perigee))[:, None] * passed
    return area.sum(axis=0) / (radius + top) ** 2


def test_without_matter_there_is_no_light(other_planet: Atmosphere) -> None:
    """Without matter to scatter everything is exactly zero, and is told to be skipped."""
    none = (0.0,) * 4
    empty = replace(other_planet, rayleigh_scattering=none, mie_scattering=none)
    field = solve(empty, sizes=SMALL)
    assert np.all(look(field, 100.0, 0.3) == 0.0)
    assert np.all(ground_irradiance(field, [0.5]) == 0.0)
    assert not any(table.any() for table in march_tables(field, FEW))
    assert (field.skipped["molecules"], field.skipped["aerosol"]) == (1, 1)


def test_zero_terms_are_counted_as_skipped(other_planet: Atmosphere) -> None:
    """The counters tell of a missing absorber and of black ground, and of nothing else; and of the
    bins that rays through little air do without, always."""
    none = (0.0,) * 4
    dark = replace(other_planet, absorption_extinction=none, ground_albedo=none)
    skipped = solve(dark, orders=2, sizes=SMALL).skipped
    bins = skipped.pop("bins")
    assert skipped == {"molecules": 0, "aerosol": 0, "absorber": 1, "ground": 1, "orders": 0}
    assert solve(other_planet, orders=2, sizes=SMALL).skipped == {
        **dict.fromkeys(skipped, 0),
        "bins": bins,
    }
    assert bins > 0


@pytest.mark.parametrize("gone", ["rayleigh_scattering", "mie_scattering"])
def test_a_substance_without_matter_is_left_out(other_planet: Atmosphere, gone: str) -> None:
    """What is zero is skipped, and a trace of it changes the light by a trace only."""
    extinction = {"mie_extinction": (0.0,) * 4} if gone == "mie_scattering" else {}
    without = solve(replace(other_planet, **{gone: (0.0,) * 4}, **extinction), sizes=SMALL)
    trace = dict.fromkeys((gone, *extinction), (1e-12,) * 4)
    with_trace = solve(replace(other_planet, **trace), sizes=SMALL)
    kind = "molecules" if gone == "rayleigh_scattering" else "aerosol"
    assert (without.skipped[kind], with_trace.skipped[kind]) == (1, 0)
    ours, nearly = look(without, 500.0, 0.4), look(with_trace, 500.0, 0.4)
    assert ours == pytest.approx(nearly, rel=1e-4, abs=1e-9)
    assert ours.max() > 1e-4


def test_one_order_is_dark_above_the_first() -> None:
    """One order of scattering leaves nothing for the orders from two on."""
    field = solve(Atmosphere.earth(), orders=1, sizes=SMALL)
    assert field.orders_done == 1
    assert np.all(look(field, 0.0, 0.5) == 0.0)


def test_orders_add_up() -> None:
    """Order n's light falls off as the field's ratio says, and a tolerance stops the sum."""
    air = Atmosphere.earth()
    light = [
        look(solve(air, orders=n, sizes=SMALL), 0.0, 0.5).mean(axis=0) for n in (2, 3, 4, 5, 9)
    ]
    third, fourth, fifth = np.diff(light[:4], axis=0)
    assert np.all((third > fourth) & (fourth > fifth) & (fifth > 0.0))
    every = solve(air, orders=4, sizes=SMALL, all_orders=True)
    node = int(np.argmin(np.abs(make_nodes(air, groups_of_air(air)[0], SMALL).suns.mu_s - 0.5)))
    assert every.tail_ratio[node] == pytest.approx(fourth / third, rel=0.03)
    # The orders beyond nine are a ratio^8 of the second, 3e-4 in the blue; Q and U fall off faster.
    assert look(every, 0.0, 0.5).mean(axis=0) == pytest.approx(light[4], rel=1.5e-3)
    early = solve(air, orders=9, sizes=SMALL, tolerance=0.02)
    assert 3 <= early.orders_done < 9
    assert early.skipped["orders"] == 9 - early.orders_done


def test_sun_plane_mirrors_the_sky(other_planet: Atmosphere) -> None:
    """Only mu, mu_s and nu count; rays in any order give the same light."""
    field = solve(other_planet, sizes=SMALL)
    mu, nu = rays(0.2)
    turned = np.random.default_rng(1).permutation(mu.size)
    whole = multiple_scattering(field, 300.0, mu, 0.2, nu)
    assert multiple_scattering(field, 300.0, mu[turned], 0.2, nu[turned]) == pytest.approx(
        whole[turned], rel=2e-5
    )


def test_wavelengths_do_not_mix(other_planet: Atmosphere) -> None:
    """Wavelengths in one group, in two, or alone differ by the placing of bins only, 0.5 %."""
    nine = replace(
        Atmosphere.earth(),
        **{  # type: ignore[arg-type]
            name: tuple(np.repeat(getattr(Atmosphere.earth(), name), 3))
            for name in (
                "solar_irradiance", "rayleigh_scattering", "mie_scattering", "mie_extinction",
                "absorption_extinction", "ground_albedo",
            )
        },
        wavelength_nm=tuple(np.linspace(680.0, 440.0, 9)),
    )  # fmt: skip
    many = look(solve(nine, sizes=SMALL), 0.0, 0.5)
    few = look(solve(Atmosphere.earth(), sizes=SMALL), 0.0, 0.5)
    assert many == pytest.approx(np.repeat(few, 3, axis=1), rel=5e-3)


def mars() -> Atmosphere:
    """Thin air of long scale height, much dust, a small planet; figures of its order only."""
    return replace(
        Atmosphere.earth(ozone=False),
        ground_radius_m=3_389_500.0,
        top_altitude_m=120_000.0,
        rayleigh_scattering=(2e-8, 5e-8, 1.2e-7),
        rayleigh_scale_height_m=11_100.0,
        mie_scattering=(4e-5, 3.8e-5, 3.2e-5),
        mie_extinction=(4.2e-5, 4.2e-5, 4.2e-5),
        mie_scale_height_m=11_000.0,
        mie_g=0.76,
        ground_albedo=(0.3, 0.2, 0.1),
    )


@pytest.mark.parametrize("kind", ["earth", "other", "mars", "thin", "thick", "lowest"])
def test_radiance_is_finite_and_not_negative_on_any_planet(
    other_planet: Atmosphere, kind: str
) -> None:
    """Every number is finite and none negative: any planet, place and sun."""
    earth = Atmosphere.earth()
    air = {
        "earth": earth,
        "other": other_planet,
        "mars": mars(),
        "thin": replace(earth, rayleigh_scale_height_m=40.0, mie_scale_height_m=10.0),
        "thick": earth.with_aerosol(5.0),
        "lowest": replace(earth, mu_s_min=-1.0),
    }[kind]
    field = solve(air, sizes=SMALL, all_orders=True)
    for height in (0.0, 1.7, 0.3 * air.top_altitude_m, air.top_altitude_m):
        for mu_s in (1.0, 0.3, 0.0, -0.05, -0.2):
            light = look(field, height, mu_s)
            assert np.all(np.isfinite(light))
            assert np.all(light >= 0.0)
    for table in (*march_tables(field, FEW), ground_irradiance(field, [1.0, 0.0, -0.2])):
        assert np.all(np.isfinite(table))
        assert np.all(table >= 0.0)


@pytest.mark.parametrize(
    ("mu_s", "mean", "most"), [(0.9, 3e-4, 1e-3), (0.3, 5e-4, 1.5e-3), (0.0, 1e-3, 5e-3)]
)
def test_single_scattering_by_bins(mu_s: float, mean: float, most: float) -> None:
    """Mean and 99th percentile are what its docstring says, against the exact rule."""
    air = Atmosphere.earth()
    field = solve(air, orders=1)
    mu, nu = rays(mu_s, 41)
    for height in (0.0, 12_000.0):
        rayleigh, mie = single_scattering_fast(field, height, mu, mu_s, nu)
        ours = rayleigh * rayleigh_phase(nu)[:, None] + mie * mie_phase(air, nu)[:, None]
        exact = single_scattering(air, height, mu, mu_s, nu, samples=32)
        bright = exact > 1e-3 * exact.max(axis=0)
        error = np.abs(ours - exact)[bright] / exact[bright]
        assert error.mean() < mean
        assert np.percentile(error, 99) < most


def test_impossible_sizes_and_orders_are_refused() -> None:
    """Sizes and orders that make no sense are refused by name."""
    for wrong in ({"altitude": 1}, {"direction_mu": 7}, {"steps": 4}):
        with pytest.raises(ValueError, match=next(iter(wrong))):
            SolverSizes(**wrong)
    with pytest.raises(ValueError, match="orders"):
        solve(Atmosphere.earth(), orders=0)
    with pytest.raises(ValueError, match="tolerance"):
        solve(Atmosphere.earth(), tolerance=-1.0)
    field = solve(Atmosphere.earth(), orders=1, sizes=SMALL)
    with pytest.raises(ValueError, match="altitude_m"):
        multiple_scattering(field, 60_001.0, [0.5], 0.5, [0.5])
    with pytest.raises(ValueError, match="one size"):
        multiple_scattering(field, 0.0, [0.5, 0.4], 0.5, [0.5])


def test_tables_hold_light_scattered_once() -> None:
    """The tables' light scattered once, with both phase functions, is `single_scattering`.

    By day, in the mean to 2e-4 of the brightest and everywhere to 5e-3, with 40 bins a ray.
    """
    air = Atmosphere.earth()
    field = solve(air, orders=1, sizes=replace(SMALL, single_bins=40))
    sizes = TableSizes(altitude=5, mu=12, nu=6, mu_s=8)
    at = node_states(air, sizes, "2017")
    h, mu, mu_s, nu = np.broadcast_arrays(at.altitude_m, at.mu, at.mu_s, at.nu)
    rayleigh, mie = march_tables(field, sizes)
    ours = rayleigh * rayleigh_phase(nu)[..., None] + mie * mie_phase(air, nu)[..., None]
    exact = single_scattering(air, h, mu, mu_s, nu, samples=24)
    inside = (h > 0.0) & (h < air.top_altitude_m) & (mu_s > 0.1)
    # Of the two rays that graze the ground only the table knows which one stops there.
    inside[:, [0, -1]] = False
    error = np.abs(ours - exact)[inside] / exact[inside].max()
    assert error.max() < 5e-3
    assert error.mean() < 2e-4
