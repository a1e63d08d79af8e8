"""Public functions accept numbers within their ranges and refuse others by parameter name."""

import re
from datetime import UTC, date, datetime, timedelta
from decimal import Decimal

import numpy as np
import pytest
from bruneton_sky import Atmosphere, TableSizes, earth_spectral, precompute, preset
from bruneton_sky import single_scattering as scatter
from bruneton_sky.raised_ground import raise_ground
from bruneton_sky.solver import SolverSizes, multiple_scattering, solve
from dynamic_skylight import HosekWilkieSky, sun_events, sun_position
from hypothesis import given
from hypothesis import strategies as st

from vrut_lite.arguments import as_count, as_number, as_numbers, broadcast

EARTH, SKY = Atmosphere.earth(), HosekWilkieSky(3.0, 0.1, 0.8)
NOON, DAY = datetime(2026, 6, 21, 12, tzinfo=UTC), date(2026, 6, 21)
FIELD = {"camera_m": (0.0, 0.0, 6_360_010.0), "view": (0.0, 0.6, 0.8), "sun": (0.0, 0.0, 1.0)}


class Hostile:
    """An object whose conversion and repr raise."""

    def __array__(self, *arguments, **named):
        raise RuntimeError

    def __repr__(self):
        raise RuntimeError


# Objects that numpy or Python would convert to numbers, and objects that they cannot convert.
NO_NUMBERS = [
    None, True, np.True_, "3", b"3", "1_0", "３", 0.1j, object(), {}, {0.1}, Decimal("0.5"),
    np.array([0.1, None]), np.array(["0.1"]), np.array([True]), [0.1, True], [[0.1], [0.1, 0.2]],
    np.datetime64("2026-06-21"), 10**400, 10**5000, float("nan"), float("inf"), -np.inf,
    np.float32("nan"), [0.1, float("nan")], np.longdouble("1e4000"), NOON, lambda: 0.1,
    Hostile(), np.ma.masked_array([0.1], [True]),
]  # fmt: skip


@pytest.fixture(scope="module")
def tables():
    sizes = TableSizes(
        transmittance_altitude=4, transmittance_mu=8, irradiance_altitude=2, irradiance_mu_s=4,
        altitude=4, mu=8, nu=2, mu_s=4,
    )  # fmt: skip
    return precompute(EARTH, 2, sizes=sizes)


def refusal(call):
    """The sentence of the ValueError that the call must raise."""
    with pytest.raises(ValueError, match=r"\S") as caught:
        call()
    sentence = str(caught.value)
    assert "\n" not in sentence
    assert len(sentence) < 300
    assert not any(trace in sentence for trace in ("could not", "broadcast together", "ufunc"))
    return sentence


# For each parameter its name, which begins the refusal, and a call that is valid otherwise.
PARAMETERS = {
    "turbidity": lambda v, t: HosekWilkieSky(v, 0.1, 0.8),
    "albedo": lambda v, t: HosekWilkieSky(3.0, v, 0.8),
    "sun_elevation_rad": lambda v, t: HosekWilkieSky(3.0, 0.1, v),
    "theta_rad": lambda v, t: SKY.radiance(v, 0.1),
    "gamma_rad": lambda v, t: SKY.raw_radiance(0.1, v),
    "gamma_rad of the spectrum": lambda v, t: SKY.spectral_radiance(0.1, v, 500.0),
    "theta_rad of the disc": lambda v, t: SKY.solar_radiance(v, 0.0, 500.0),
    "wavelength_nm": lambda v, t: SKY.spectral_radiance(0.1, 0.1, v),
    "wavelength_nm of the disc": lambda v, t: SKY.solar_radiance(0.1, 0.0, v),
    "wavelength_nm of a preset": lambda v, t: preset("mars-like", v),
    "wavelength_nm of the earth": lambda v, t: earth_spectral(v),
    "size": lambda v, t: SKY.cube_map(v),
    "size of halves": lambda v, t: SKY.cube_map_float16(v),
    "sun_azimuth_rad": lambda v, t: SKY.cube_map(4, v),
    "scale": lambda v, t: SKY.cube_map_float16(4, scale=v),
    "exposure": lambda v, t: SKY.cube_map_u8(4, exposure=v),
    "faces": lambda v, t: SKY.cube_map(4, faces=(v,)),
    "rows": lambda v, t: SKY.cube_map(4, rows=(0, v)),
    "latitude_deg": lambda v, t: sun_position(NOON, v, 14.0),
    "longitude_deg": lambda v, t: sun_events(DAY, 50.0, v),
    "altitude_m": lambda v, t: sun_position(NOON, 50.0, 14.0, altitude_m=v),
    "pressure_pa": lambda v, t: sun_position(NOON, 50.0, 14.0, pressure_pa=v),
    "temperature_c": lambda v, t: sun_position(NOON, 50.0, 14.0, temperature_c=v),
    "altitude_m of the ground": lambda v, t: raise_ground(EARTH, v),
    "altitude_m of the observer": lambda v, t: scatter(EARTH, v, 0.5, 0.5, 0.5),
    "mu": lambda v, t: scatter(EARTH, 0.0, v, 0.5, 0.5),
    "mu_s": lambda v, t: scatter(EARTH, 0.0, 0.5, v, 0.5),
    "nu": lambda v, t: scatter(EARTH, 0.0, 0.5, 0.5, v),
    "samples": lambda v, t: scatter(EARTH, 0.0, 0.5, 0.5, 0.5, samples=v),
    "samples of midpoint": lambda v, t: scatter(
        EARTH, 0.0, 0.5, 0.5, 0.5, rule="midpoint", samples=(4, v)
    ),
    "orders": lambda v, t: precompute(EARTH, v),
    "mu of the tables": lambda v, t: TableSizes(mu=v),
    "steps of the solver": lambda v, t: SolverSizes(steps=v),
    "optical_depth_550": lambda v, t: EARTH.with_aerosol(v),
    "mie_g": lambda v, t: EARTH.with_aerosol(0.1, mie_g=v),
    "visibility_m": lambda v, t: EARTH.with_fog(v, 100.0),
    "scale_height_m": lambda v, t: EARTH.with_fog(1000.0, v),
    "camera_m": lambda v, t: t.sky_radiance(**FIELD | {"camera_m": v}),
    "view": lambda v, t: t.radiance_rgb(**FIELD | {"view": v}),
    "sun": lambda v, t: t.ground_radiance(**FIELD | {"sun": v}),
    "shadow_length_m": lambda v, t: t.sky_radiance(**FIELD, shadow_length_m=v),
}


@pytest.mark.parametrize("parameter", PARAMETERS)
def test_non_numbers_are_refused_by_parameter_name(tables, parameter):
    """Texts, booleans, complex numbers, objects, ragged lists, NaN and infinity are refused."""
    name = parameter.split()[0]
    call = PARAMETERS[parameter]
    for value in NO_NUMBERS:
        if value is None and name in ("pressure_pa", "mie_g"):
            continue
        assert refusal(lambda v=value, c=call: c(v, tables)).startswith(name), value


@pytest.mark.parametrize(
    ("call", "said"),
    [
        (lambda: SKY.radiance(-0.1, 0.1), "theta_rad must lie between 0 and 3.141592654 rad"),
        (lambda: SKY.radiance(0.1, 3.15), "gamma_rad must lie between 0 and .* not 3.15"),
        (lambda: SKY.radiance([0.1, 0.2], [0.1, 0.2, 0.3]), r"theta_rad \(2,\), gamma_rad \(3,\)"),
        (lambda: SKY.cube_map(10**6), "size must lie between 1 and 8192, not 1000000"),
        (lambda: SKY.cube_map(0), "size must lie between 1 and 8192, not 0"),
        (lambda: SKY.cube_map(-4), "not -4"),
        (lambda: SKY.cube_map(4.0), "size must be a whole number .* not 4.0"),
        (lambda: SKY.cube_map(4, out=[0.0]), r"out must be .* not \[0.0\]"),
        (lambda: SKY.cube_map(4, faces="012345"), "faces must be of the class tuple or list"),
        (lambda: SKY.cube_map(4, rows=3), "rows must be two whole numbers"),
        (lambda: sun_position(NOON, 50, 14, pressure_pa=1e6), "pressure_pa must lie between 0 and"),
        (lambda: sun_position(NOON, 50, 14, temperature_c=1e3), "temperature_c must lie between"),
        (lambda: sun_position(NOON, 50, 14, altitude_m=1e9), "altitude_m must lie between -11000"),
        (lambda: sun_position(NOON, 50, 14, ["preetham"]), "method must be one of 'ephemeris', "),
        (lambda: sun_position(DAY, 50, 14), "when must be of the class datetime"),
        (lambda: sun_position("2026-06-21", 50, 14), "when must be of the class datetime"),
        (lambda: sun_position(datetime.max.replace(tzinfo=UTC), 50, 14), "years 1600 to 2600"),
        (lambda: sun_position(datetime.min.replace(tzinfo=UTC), 50, 14), "years 1600 to 2600"),
        (lambda: sun_events(NOON, 50, 14), "day must be a date"),
        (lambda: sun_events(date.max, 50, 14), "years 1600 to 2600"),
        (lambda: sun_events(DAY, 50, 14, time_zone="UTC"), "time_zone must be of the class tzinfo"),
        (lambda: sun_events(DAY, 50, 14, method="spa"), "method must be one of"),
        (lambda: Atmosphere.earth(ozone="no"), "ozone must be True or False, not 'no'"),
        (lambda: earth_spectral((680.0, 300.0)), "wavelength_nm must lie between 360 and 830 nm"),
        (lambda: preset(["mars-like"]), "no atmosphere"),
        (lambda: precompute(None), "atmosphere must be of the class Atmosphere, not None"),
        (lambda: precompute(EARTH, progress=print.__name__), "progress must be a function"),
        (lambda: precompute(EARTH, cache="/tmp"), "cache must be of the class ArrayCache"),
        (lambda: precompute(EARTH, 10**9), "orders must lie between 1 and 1000"),
        (lambda: precompute(EARTH, sizes=(4, 8)), "sizes must be of the class TableSizes"),
        (
            lambda: precompute(EARTH, sizes=TableSizes(altitude=10**6, mu=10**6)),
            "values of the table scattering must lie between",
        ),
        (lambda: scatter(EARTH, 0.0, [0.5, 0.4], 0.5, [0.1, 0.2, 0.3]), r"mu \(2,\), .*nu \(3,\)"),
        (lambda: scatter(EARTH, 0.0, 0.5, 0.5, 0.5, rule=None), "rule must be one of"),
        (lambda: scatter(EARTH, 0.0, 0.5, 0.5, 0.5, samples=10**7), "must lie between 1 and 1024"),
        (lambda: scatter(EARTH, 6e4 + 1, 0.5, 0.5, 0.5), "altitude_m must lie between 0 and 60000"),
        (lambda: solve(EARTH, tolerance="0.1"), "tolerance of the orders must be a number"),
        (lambda: multiple_scattering(solve(EARTH, 1), 0.0, [1.1], 0.5, [0.5]), "mu must lie"),
    ],
)
def test_values_out_of_range_are_refused_with_the_range(call, said):
    """Refused before memory is taken, in a sentence that gives the range."""
    assert re.search(said, refusal(call))


def test_a_read_only_output_is_refused(tables):
    """A read-only view of another array is refused as output and stays unchanged."""
    out = np.zeros((6, 4, 4, 3), np.float32)
    out.flags.writeable = False
    assert "read-only" in refusal(lambda: SKY.cube_map(4, out=out))
    assert "out must be" in refusal(lambda: SKY.cube_map(4, out=out.astype(">f4")))
    assert not out.any()


def test_incompatible_shapes_are_named(tables):
    """The sentence names the parameters, which numpy's own does not."""
    two, three = np.tile(FIELD["view"], (2, 1)), np.tile(FIELD["sun"], (3, 1))
    assert "view (2, 3), sun (3, 3)" in refusal(
        lambda: tables.sky_radiance(FIELD["camera_m"], two, three)
    )
    assert "shadow_length_m (2,)" in refusal(
        lambda: tables.sky_radiance(FIELD["camera_m"], FIELD["view"], three, [1.0, 2.0])
    )
    assert "normal (2, 3)" in refusal(
        lambda: tables.sun_and_sky_irradiance(FIELD["camera_m"], two, three)
    )
    camera = np.tile(FIELD["camera_m"], (2, 1))
    assert "point_m (3, 3)" in refusal(
        lambda: tables.radiance_to_point(camera, 7e6 * three, FIELD["sun"])
    )


def test_directions_of_another_length_are_refused_with_it(tables):
    """A vector of length 2 is probably a point, so directions are not normalised silently."""
    assert "view must be unit vectors, not 2 long" in refusal(
        lambda: tables.sky_radiance(FIELD["camera_m"], (0.0, 0.0, 2.0), FIELD["sun"])
    )


def test_numbers_of_every_kind_are_taken():
    """Integers and floats of Python and numpy are accepted, alone, in lists and in arrays."""
    expected = HosekWilkieSky(3, 0, 1).radiance(1, 1)
    for kind in (np.float32, np.float16, np.int8, np.uint64, np.longdouble, np.array):
        sky = HosekWilkieSky(kind(3), kind(0), kind(1))
        np.testing.assert_array_equal(sky.radiance(kind(1), kind(1)), expected)
    assert SKY.cube_map(np.int64(4), faces=[2]).shape == (6, 4, 4, 3)
    assert SKY.radiance([], []).shape == (0, 3)
    assert sun_position(NOON + timedelta(days=1), 50, np.float32(14)).elevation_rad > 0.0


@given(st.floats(1.0, 2.0), st.floats(allow_nan=True), st.integers())
def test_a_range_is_what_it_says(inside, number, whole):
    """Values in the range are returned unchanged, others are refused."""
    assert as_number("x", inside, 1.0, 2.0) == inside
    assert as_numbers("x", [inside, 1.0], 1.0, 2.0)[0] == inside
    if not 1.0 <= number <= 2.0:
        assert repr(number) in refusal(lambda: as_numbers("x", [inside, number], 1.0, 2.0))
    if 1 <= whole <= 9:
        assert as_count("x", whole, 1, 9) == whole
    else:
        refusal(lambda: as_count("x", whole, 1, 9))


@given(st.floats(np.pi, np.pi + 3e-9))
def test_rounding_at_the_end_of_a_range_is_clipped(angle):
    """An angle that rounding has carried beyond pi becomes pi."""
    np.testing.assert_array_equal(SKY.raw_radiance(0.1, angle), SKY.raw_radiance(0.1, np.pi))


def test_compatible_shapes_are_broadcast():
    """Arrays are returned in the order of the keywords."""
    one, two = broadcast(a=np.zeros((3, 1)), b=np.ones(2))
    assert one.shape == two.shape == (3, 2)
