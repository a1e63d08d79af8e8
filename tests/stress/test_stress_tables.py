"""Precomputed tables and solved fields for any observer, on all planets."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from bruneton_sky import Atmosphere, TableSizes, precompute
from bruneton_sky.air_volume import AirSizes, air_volume
from bruneton_sky.sky_view import fill_cube, light_view, sky_view
from bruneton_sky.solver import (
    ground_irradiance,
    multiple_scattering,
    single_scattering_fast,
    solve,
)
from long_parameters import mostly_long
from planets import PLANETS, SHORT
from stress_cases import (
    assert_continuous,
    assert_finite,
    assert_light,
    assert_same_on_threads,
)

from vrut_lite.sky.air_volume import look_up_air

SIZES = TableSizes(
    transmittance_altitude=8, transmittance_mu=32, irradiance_altitude=4, irradiance_mu_s=16,
    altitude=6, mu=16, nu=4, mu_s=8,
)  # fmt: skip
SOLID = [name for name in PLANETS if "fog" not in name]
FARTHEST_M = 4e8


@cache
def field_of(name):
    """The solved light of a planet, of two orders only: accuracy is not tested here."""
    return solve(PLANETS[name], orders=2)


@cache
def tables_of(name):
    """A planet's tables with few nodes."""
    return precompute(PLANETS[name], orders=2, sizes=SIZES)


def points(stress, count, air):
    """Points on the ground, in the air, at its top and as far as the moon."""
    special = [1e-6, 2.0, air.top_altitude_m, air.top_altitude_m + 1e-6]
    inside = stress.within(count, 0.0, air.top_altitude_m, special)
    height = np.where(
        stress.random.random(count) < 0.8, inside, stress.within(count, 0.0, FARTHEST_M)
    )
    return (air.ground_radius_m + height)[:, None] * stress.directions(count)


def views(stress, count, air, point):
    """Random directions, and directions at the point's horizon."""
    up = point / np.linalg.norm(point, axis=1, keepdims=True)
    view = stress.directions(count)
    across = view - (view * up).sum(axis=1, keepdims=True) * up
    size = np.linalg.norm(across, axis=1, keepdims=True)
    level = np.divide(across, size, out=np.zeros_like(across), where=size > 1e-6)
    sine = np.minimum(air.ground_radius_m / np.linalg.norm(point, axis=1), 1.0)
    dip = np.arccos(sine) + stress.within(count, -1e-3, 1e-3, [0.0, 1e-9, -1e-9])
    near = level * np.cos(dip)[:, None] - up * np.sin(dip)[:, None]
    some = (stress.random.random(count) < 0.3) & (size[:, 0] > 1e-6)
    chosen = np.where(some[:, None], near, view)
    return chosen / np.linalg.norm(chosen, axis=1, keepdims=True)


@pytest.mark.parametrize("name", mostly_long(SOLID, SHORT.__contains__))
def test_tables_hold_light(name):
    """Every number of every table: finite, not negative, transmittance no more than 1."""
    tables = tables_of(name)
    for part in ("transmittance", "irradiance", "scattering", "single_mie"):
        assert_light(np.asarray(getattr(tables, part)), part)
    assert tables.transmittance.max() <= 1.0
    assert (tables.irradiance <= np.asarray(PLANETS[name].solar_irradiance) * 1.05).all()


@pytest.mark.parametrize("name", SOLID)
def test_look_ups_give_light(stress, name):
    """Sky, ground, air and light on surfaces are finite, from the ground to the moon."""
    tables, air = tables_of(name), PLANETS[name]
    for count in stress.batches("Tables.sky_radiance and others", 4000, most=8192):
        camera = points(stress, count, air)
        view, sun = views(stress, count, air, camera), views(stress, count, air, camera)
        light, clear = tables.sky_radiance(camera, view, sun)
        assert_light(light, "sky")
        assert_light(clear, "transmittance")
        # Weights of a look-up add up to 1 within a rounding.
        assert clear.max() <= 1.0 + 1e-15
        shadow = stress.within(count, 0.0, 1e6, [1.0])
        assert_light(tables.sky_radiance(camera, view, sun, shadow)[1], "shadow")
        assert_finite(tables.radiance_rgb(camera, view, sun), "rgb")
        assert_light(tables.ground_radiance(camera, view, sun), "ground")
        for part in tables.sun_and_sky_irradiance(camera, view, sun):
            assert_light(part, "irradiance")
        away = stress.within(count, 0.0, 1e6, [1e-6, 1.0])[:, None]
        point = camera + away * view
        keep = np.linalg.norm(point, axis=1) > 1.0
        air_light, passed = tables.radiance_to_point(camera[keep], point[keep], sun[keep])
        assert_light(air_light, "to point")
        assert_light(passed, "to point")
        assert passed.max() <= 1.0


@pytest.mark.parametrize("name", ["earth", "mars", "rock", "giant"])
def test_looked_up_skies_have_no_jump(stress, name):
    """Continuous in view above the horizon, sun and altitude."""
    tables, air = tables_of(name), PLANETS[name]
    up, north = np.array([0.0, 1.0, 0.0]), np.array([0.0, 0.0, -1.0])

    def at(angle):
        return np.cos(angle)[:, None] * north + np.sin(angle)[:, None] * up

    for count in stress.batches("Tables.sky_radiance and others", 400, most=400):
        height = stress.within(count, 0.0, air.top_altitude_m, [1e-6, 2.0])
        dip = np.arccos(air.ground_radius_m / (air.ground_radius_m + height))
        view = np.clip(stress.within(count, -0.5, np.pi / 2), 1e-4 - dip, np.pi / 2)
        sun = stress.within(count, -np.pi / 2, np.pi / 2, [0.0, 1e-9, -1e-9])

        def look(view, sun, height):
            camera = (air.ground_radius_m + height)[:, None] * up
            return tables.sky_radiance(camera, at(view), at(sun))[0]

        # Near an end of its axis a texture coordinate is a root, steep enough to show.
        assert_continuous(look, view, sun, height, most=1e-5)
        assert_continuous(lambda s, v, h, look=look: look(v, s, h), sun, view, height, most=1e-5)


@pytest.mark.parametrize("name", mostly_long(PLANETS, SHORT.__contains__))
def test_solved_fields_give_light(stress, name):
    """Single and multiple scattering are finite and not negative for any ray and sun."""
    field, air = field_of(name), PLANETS[name]
    for count in stress.batches("multiple_scattering, single_scattering_fast", 1200, most=300):
        place = float(stress.within(1, 0.0, air.top_altitude_m, [1e-6, 2.0])[0])
        mu = stress.within(count, -1.0, 1.0, [0.0, 1e-9, -1e-9])
        mu_s = float(stress.within(1, -1.0, 1.0, [0.0, 1e-9, -1e-9])[0])
        turn = np.cos(stress.within(count, 0.0, np.pi))
        nu = mu * mu_s + np.sqrt((1.0 - mu**2) * (1.0 - mu_s**2)) * turn
        assert_light(multiple_scattering(field, place, mu, mu_s, nu))
        for part in single_scattering_fast(field, place, mu, mu_s, nu):
            assert_light(part)
        assert_light(ground_irradiance(field, mu[:20]))


@pytest.mark.parametrize("name", mostly_long(PLANETS, SHORT.__contains__))
def test_sky_views_are_light(stress, name):
    """Cube maps (float32) for observers from the ground to the moon: finite and not negative."""
    field, air = field_of(name), PLANETS[name]
    size = 16
    for _ in stress.batches("sky_view, fill_cube (texels)", 4 * 6 * size**2, 6 * size**2):
        heights = [0.0, 1e-6, 10.0, air.top_altitude_m, air.top_altitude_m + 1e-6, FARTHEST_M]
        place = float(stress.within(1, 0.0, air.top_altitude_m, heights[:4])[0])
        place = float(stress.random.choice([place, stress.random.choice(heights)]))
        (sun,) = stress.directions(1)
        view = sky_view(field, place, sun)
        assert_light(view.nodes, f"{place} {sun}")
        assert_light(fill_cube(view, size, np.zeros(3)), f"{place} {sun}")
        assert_light(fill_cube(light_view(field, sun), size, np.zeros(3)), f"{sun}")


def test_sky_views_are_the_same_on_two_threads(stress):
    """Kernels that release the GIL give the same bits on two threads."""
    field, sun = field_of("earth"), np.array([0.6, 0.5, 0.62449979983984])
    for _ in stress.batches("sky_view, fill_cube (texels)", 3 * 6 * 32**2):
        assert_same_on_threads(lambda: sky_view(field, 2000.0, sun).nodes)
        view = sky_view(field, 2000.0, sun)
        assert_same_on_threads(fill_cube, view, 32, np.ones(3))
        assert_same_on_threads(lambda: air_volume(field, 2.0, sun, 2e4).light.values)
        mu = stress.within(200, -1.0, 1.0)
        assert_same_on_threads(multiple_scattering, field, 10.0, mu, 0.3, mu * 0.3)


SMALL = AirSizes(slices=6, rows_above=8, rows_below=6, columns=5, steps=2)


@pytest.mark.parametrize("name", mostly_long(PLANETS, SHORT.__contains__))
def test_air_volumes_are_light(stress, name):
    """Air to any reach, from a millimetre to all of it, from the ground to the moon.

    In any direction and distance transmittance is in [0, 1], and it never falls as the distance
    shrinks.
    """
    field, air = field_of(name), PLANETS[name]
    for count in stress.batches("air_volume, look_up_air", 1200, most=200):
        heights = [1e-6, 2.0, air.top_altitude_m]
        place = float(stress.within(1, 0.0, 1.5 * air.top_altitude_m, heights)[0])
        place = FARTHEST_M if stress.random.random() < 0.1 else place
        reach = float(10.0 ** stress.within(1, -3.0, 8.0)[0])
        (sun,) = stress.directions(1)
        volume = air_volume(field, place, sun, reach, SMALL)
        for part in (volume.light, volume.extinction):
            assert_light(part.values, f"{place} {reach} {sun}")
        direction = stress.directions(count)
        distance = stress.within(count, 0.0, 2.0 * reach, [1e-6, 1.0, reach])
        seen = look_up_air(volume, direction, distance)
        for part in seen:
            assert_light(part, f"{place} {reach} {sun}")
        assert seen.transmittance.max() <= 1.0
        most = 0.0 if reach < 1.0 else 1e-5
        near = np.minimum(distance, 0.999 * reach)

        def look(at, x, y, z, volume=volume):
            return look_up_air(volume, np.stack([x, y, z], axis=-1), at).transmittance

        assert_continuous(look, near, *direction.T, step=1e-6 * reach, most=most + 1e-6)


BAD = [
    0.0, -1.0, np.nan, np.inf, -np.inf, "air", None, (), [[1.0], [2.0, 3.0]],
    1e-300, 1e-30, 1e-3, 1e3, 1e12, 1e30, 1e300,
]  # fmt: skip


def test_invalid_atmospheres_are_refused_in_a_sentence(stress):
    """Every invalid number of an atmosphere is refused in a sentence that names it.

    Accepted atmospheres give finite light.
    """
    fields = [
        name
        for name in Atmosphere.__dataclass_fields__
        if name != "mie_phase" and not name.endswith("_table")
    ]
    for _ in stress.batches("Atmosphere", len(fields) * len(BAD), len(fields) * len(BAD)):
        for name in fields:
            for value in BAD:
                try:
                    air = replace(PLANETS["earth"], **{name: value})
                except ValueError as refusal:
                    said = str(refusal)
                    assert name.removesuffix("_extinction").removesuffix("_scattering")[:4] in said
                    assert said.count("\n") == 0
                    continue
                light = single_scattering_of(air)
                assert_light(light, f"{name} = {value}")


def single_scattering_of(air):
    """Single scattering of an atmosphere at some rays."""
    from bruneton_sky import single_scattering

    return single_scattering(air, 0.0, [1.0, 0.1, 0.0], 0.5, [0.5, 0.3, 0.1])
