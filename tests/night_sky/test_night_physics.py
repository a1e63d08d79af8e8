"""Moon, stars, glow and refraction, against publications and another ephemeris."""

from datetime import UTC, datetime

import numpy as np
import pytest
from dynamic_skylight import sun_position
from night_sky.earth_shadow import earth_shadow, light_left
from night_sky.eclipse import hidden_area, left_of_disc, sun_left
from night_sky.events import next_full_moon, next_rise_and_set, next_solar_eclipse
from night_sky.glow import GlowSources, airglow_cd, glow
from night_sky.lamp_sky import lamp_share
from night_sky.moon import moon_at
from night_sky.moon_light import Phase, earthshine_radiance_rgb, irradiance_rgb
from night_sky.night_air import RGB_NM, SENT_DOWN, night_air
from night_sky.sky_axes import unit, watch
from night_sky.stars import LUX_OF_MAGNITUDE_0, irradiance_of, stars_at

from vrut_lite.atmosphere.gases import rayleigh_optical_depth
from vrut_lite.atmosphere.refraction import apparent_elevation, refraction_rad, trace
from vrut_lite.geometry.colour import LUMENS_PER_WATT, luminance
from vrut_lite.messages.haze import DEFAULT_HAZE, SetHaze

CLEAR = SetHaze(optical_depth_550=0.05)
SPRING_NIGHT = datetime(2026, 3, 20, 1, tzinfo=UTC)


def lux(rgb):
    return float(luminance(rgb)) * LUMENS_PER_WATT


def of_phase(degrees, waxing=False):
    sign = 1.0 if waxing else -1.0
    return Phase(np.radians(degrees), sign * np.radians(degrees))


@pytest.mark.parametrize(
    ("degrees", "expected"),
    [(1.55, 0.374), (7.0, 0.274), (30.0, 0.146), (60.0, 0.0677), (90.0, 0.0270)],
)
def test_waning_moonlight_is_rolos(degrees, expected):
    # Kieffer and Stone's table integrated to lux, computed apart from this code.
    assert lux(irradiance_rgb(of_phase(degrees))) == pytest.approx(expected, rel=0.01)


@pytest.mark.parametrize(("degrees", "more"), [(30.0, 1.05), (60.0, 1.10), (90.0, 1.14)])
def test_a_waxing_moon_is_brighter_than_a_waning_one(degrees, more):
    waxing, waning = (lux(irradiance_rgb(of_phase(degrees, side))) for side in (True, False))
    assert waxing / waning == pytest.approx(more, abs=0.01)


def test_moonlight_has_no_step_where_allens_curve_takes_over():
    before, after = (lux(irradiance_rgb(of_phase(degrees))) for degrees in (96.999, 97.001))
    assert after == pytest.approx(before, rel=1e-3)


def test_a_full_moon_in_the_zenith_gives_a_third_of_a_lux():
    on_ground = irradiance_rgb(of_phase(1.55)) * night_air(CLEAR).through(np.ones(1))[0]
    assert lux(on_ground) == pytest.approx(0.33, abs=0.05)


def test_earthshine_is_brightest_at_new_moon():
    assert lux(earthshine_radiance_rgb(of_phase(179.0))) == pytest.approx(0.6, rel=0.05)
    assert lux(earthshine_radiance_rgb(of_phase(5.0))) < 0.005


def test_stars_to_magnitude_six_and_a_half_sum_to_the_bright_star_catalogue():
    # The Bright Star Catalogue sums to 96.08 stars of magnitude 0; magnitudes differ in the second
    # decimal.
    light = luminance(stars_at(watch(SPRING_NIGHT, 50.0, 14.0)).irradiance_rgb) * LUMENS_PER_WATT
    magnitude_0 = light / LUX_OF_MAGNITUDE_0
    assert magnitude_0[magnitude_0 >= 10.0 ** (-0.4 * 6.5)].sum() == pytest.approx(96.08, rel=0.01)


def test_stars_of_blue_and_red_have_planckian_colours():
    nanowatts = 1e9 * irradiance_of(np.zeros(3), np.array([0.0, 0.65, 1.5]))
    expected = [[3.29, 3.77, 5.46], [4.28, 3.76, 3.52], [5.81, 3.61, 1.90]]
    assert np.allclose(nanowatts, expected, rtol=0.03)


@pytest.mark.parametrize(("sfu", "least", "most"), [(70, 1.7e-4, 2.2e-4), (200, 2.9e-4, 3.5e-4)])
def test_the_moonless_zenith_is_as_dark_as_published(sfu, least, most):
    zenith = glow(
        np.array([[0.0, 1.0, 0.0]]),
        watch(SPRING_NIGHT, 50.0, 14.0),
        night_air(CLEAR),
        GlowSources(sfu),
    )
    assert least < lux(zenith[0]) < most


def test_lamps_brighten_the_zenith_to_the_magnitude_asked_for():
    up, here, air = np.array([[0.0, 1.0, 0.0]]), watch(SPRING_NIGHT, 50.0, 14.0), night_air(CLEAR)
    by_lamps = glow(up, here, air, GlowSources(zenith_magnitude=18.0)) - glow(
        up, here, air, GlowSources()
    )
    assert lux(by_lamps[0]) == pytest.approx(7.1e-3 - 1.78e-4, rel=0.01)


@pytest.mark.parametrize("elevation_deg", [90.0, 30.0, 10.0])
def test_the_sky_over_towns_is_light_of_the_ground_that_air_scatters(elevation_deg):
    """By chance: a place on the ray, a direction from the ground, two paths through flat air; in
    blue, where there is no ozone."""
    haze, rng, count = SetHaze(optical_depth_550=0.2), np.random.default_rng(7), 200_000
    sine, blue = np.sin(np.radians(elevation_deg)), RGB_NM[2:]
    layers = [(8434.5, rayleigh_optical_depth(blue), np.ones(1), None)]
    share = haze.optical_depth_550 / haze.optics.optical_depth_550
    for layer in haze.optics.layers:
        table = layer.phase_at(blue).values[0]
        depth = share * layer.depth_at(blue)
        layers.append((layer.height_m, depth, layer.albedo_at(blue), table))
    up, turn = rng.random(count), rng.random(count) * 2.0 * np.pi
    cosine = -up * sine - np.sqrt((1.0 - up**2) * (1.0 - sine**2)) * np.cos(turn)
    total = 0.0
    for height_m, depth, albedo, table in layers:
        altitude = rng.exponential(height_m, count)
        below = sum(d * -np.expm1(-altitude / h) for h, d, _, _ in layers)
        phase = 3.0 / (16.0 * np.pi) * (1.0 + cosine**2)
        if table is not None:
            at = np.sqrt(0.5 - 0.5 * cosine)
            phase = np.interp(at, np.linspace(0.0, 1.0, table.size), table)
        seen = depth / sine * albedo * phase * np.exp(-below / up - below / sine)
        total += 2.0 * np.pi * seen.mean()
    assert lamp_share(haze, sine)[2] == pytest.approx(total, rel=0.03)


def test_a_suburbs_sky_grows_towards_the_horizon_as_one_photographed():
    """A photograph has 5.6 times as much light at 8 deg as at 85 deg, in the mean over azimuths."""
    azimuth, seen = np.linspace(0.0, 2.0 * np.pi, 36, endpoint=False), {}
    for degrees in (8.0, 85.0):
        level, up = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
        around = [level * np.sin(azimuth), np.full(36, up), level * np.cos(azimuth)]
        here, air = watch(SPRING_NIGHT, 50.0, 14.0), night_air(DEFAULT_HAZE)
        sky = glow(np.stack(around, axis=-1), here, air, GlowSources(zenith_magnitude=20.0))
        seen[degrees] = luminance(sky).mean()
    assert seen[8.0] / seen[85.0] == pytest.approx(5.6, rel=0.1)


def test_the_air_refills_an_even_sky_as_the_solved_field_does():
    # All orders by bruneton_sky's field at 570 nm, from the zenith to 85 deg.
    sine = np.cos(np.radians([0.0, 30.0, 60.0, 75.0, 85.0]))
    through = night_air(CLEAR).through(sine)[:, 1]
    arriving = through + SENT_DOWN * (1.0 - through)
    assert np.allclose(arriving, [0.92, 0.90, 0.84, 0.73, 0.52], atol=0.03)


def test_airglow_brightens_toward_the_horizon_as_a_layer_does():
    high, low = airglow_cd(np.array([1.0, np.cos(np.radians(75.0))]), 130.0)
    assert low / high == pytest.approx(3.28, rel=0.01)


def test_refraction_is_that_of_a_traced_standard_atmosphere():
    minutes = 60.0 * np.degrees(trace(np.radians([0.0, 0.5, 2.0])))
    assert np.allclose(minutes, [33.8, 28.3, 18.1], atol=0.1)
    # Bennett's formula, for 10 deg C and 1010 hPa.
    at = np.array([0.3, 1.2, 3.0, 20.0, 60.0])
    bennett = 1.0 / np.tan(np.radians(at + 7.31 / (at + 4.4)))
    assert np.allclose(60.0 * np.degrees(refraction_rad(np.radians(at))), bennett, atol=0.7)


def test_the_table_of_refraction_is_within_a_fifth_of_a_minute_of_tracing():
    at = np.radians(np.linspace(0.013, 88.0, 37))
    assert np.abs(refraction_rad(at) - trace(at)).max() < np.radians(0.2 / 60.0)


def test_a_disc_on_the_horizon_is_flattened():
    radius = np.radians(16.0 / 60.0)
    edges = np.degrees(apparent_elevation(np.array([-1.0, 1.0]) * radius + np.radians(-0.29)))
    assert 60.0 * (edges[1] - edges[0]) == pytest.approx(26.9, abs=0.5)


def test_the_moon_keeps_its_face_to_the_earth():
    # The mean sub-earth point is the origin of the moon's own axes; it librates by 8 deg or so.
    for day in (1, 8, 15, 22):
        phase = moon_at(watch(datetime(2026, 5, day, tzinfo=UTC), 10.0, 40.0)).phase
        assert abs(phase.seen_latitude_rad) < np.radians(8.0)
        assert abs(phase.seen_longitude_rad) < np.radians(9.5)


def test_the_sun_lights_the_moon_from_the_sun():
    moon = moon_at(watch(datetime(2026, 5, 24, 20, tzinfo=UTC), 50.0, 14.0))
    assert moon.lit_fraction == pytest.approx(0.645, abs=0.01)  # 33 h after first quarter.
    assert moon.phase.sun_longitude_rad > 0.0  # Morning on the moon's east: it waxes.


@pytest.fixture(scope="module")
def skyfield():
    # The oracle is an extra of its own; `pip install vrut-lite-lab[bench]` brings it.
    api = pytest.importorskip("skyfield.api", reason="needs skyfield")
    data = pytest.importorskip("skyfield_data", reason="needs skyfield-data (DE421)")
    folder = data.get_skyfield_data_path()
    return api, api.load_file(folder + "/de421.bsp"), api.load.timescale(builtin=True)


@pytest.mark.long
@pytest.mark.filterwarnings("ignore::RuntimeWarning")
@pytest.mark.parametrize("year", [2000, 2013, 2026, 2040])
@pytest.mark.parametrize("place", [(50.0, 14.4), (-33.9, 151.2), (0.0, -78.0)])
def test_the_moon_stands_where_de421_has_it(skyfield, year, place):
    api, ephemeris, timescale = skyfield
    instant = datetime(year, 8, 12, 18, 30, tzinfo=UTC)
    observer = ephemeris["earth"] + api.wgs84.latlon(*place, elevation_m=300.0)
    seen = observer.at(timescale.from_datetime(instant)).observe(ephemeris["moon"]).apparent()
    ours = moon_at(watch(instant, *place, 300.0)).true_direction
    assert np.degrees(np.linalg.norm(_world(seen) - ours)) < 0.002


@pytest.mark.long
@pytest.mark.filterwarnings("ignore::RuntimeWarning")
@pytest.mark.parametrize("year", [2000, 2026, 2040])
def test_stars_stand_where_skyfields_astrometry_has_them(skyfield, year):
    # Sirius, Arcturus, Vega, 61 Cygni: places and motions of Hipparcos.
    stars = [
        (101.287155, -16.716116, -546.01, -1223.07, 379.21),
        (213.915300, 19.182409, -1093.39, -2000.06, 88.83),
        (279.234735, 38.783689, 200.94, 286.23, 130.23),
        (316.724748, 38.749417, 4164.17, 3249.99, 285.88),
    ]
    api, ephemeris, timescale = skyfield
    instant, place = datetime(year, 2, 3, 22, tzinfo=UTC), (50.0, 14.4)
    at = ephemeris["earth"] + api.wgs84.latlon(*place)
    ours = stars_at(watch(instant, *place)).direction
    for ra, dec, motion_ra, motion_dec, parallax in stars:
        star = api.Star(
            ra_hours=ra / 15.0, dec_degrees=dec, ra_mas_per_year=motion_ra,
            dec_mas_per_year=motion_dec, parallax_mas=parallax,
        )  # fmt: skip
        theirs = _world(at.at(timescale.from_datetime(instant)).observe(star).apparent())
        assert np.degrees(np.linalg.norm(ours - theirs, axis=1).min()) < 0.01


def _world(seen):
    altitude, azimuth, _ = seen.altaz()
    north, east, up = unit(np.degrees(azimuth.radians), np.degrees(altitude.radians))
    return np.array([east, up, -north])


@pytest.mark.parametrize(
    ("area", "left"), [(0.63, 0.627), (0.20, 0.166), (0.086, 0.061), (0.020, 0.011)]
)
def test_an_eclipse_leaves_less_light_than_area(area, left):
    # Neckel's disc beside the moon's of 12 August 2026, at 550 nm, computed apart from this code.
    separations = np.linspace(0.0, 2.0, 401)
    areas = [_area_left(separation, 1.035) for separation in separations]
    separation = float(np.interp(area, areas, separations))
    assert left_of_disc(separation, 1.035)[1] == pytest.approx(left, rel=0.05, abs=6e-4)


def _area_left(d, r):
    """Of a unit disc beside one of radius r, by the lens of two circles."""
    if d >= 1.0 + r:
        return 1.0
    if d <= r - 1.0:
        return 0.0
    a = np.arccos((d * d + 1.0 - r * r) / (2.0 * d))
    b = np.arccos((d * d + r * r - 1.0) / (2.0 * d * r))
    kite = 0.5 * np.sqrt((-d + 1 + r) * (d + 1 - r) * (d - 1 + r) * (d + 1 + r))
    return 1.0 - (a + r * r * b - kite) / np.pi


def test_the_eclipse_of_august_2026_is_total_in_burgos():
    at = watch(datetime(2026, 8, 12, 12, tzinfo=UTC), 42.34, -3.70, 850.0)
    eclipse = next_solar_eclipse(at)
    assert eclipse.kind == "total"
    assert abs((eclipse.at - datetime(2026, 8, 12, 18, 29, tzinfo=UTC)).total_seconds()) < 60
    assert sun_left(watch(eclipse.at, 42.34, -3.70, 850.0)).max() < 1e-6


@pytest.mark.parametrize(
    ("city", "latitude", "longitude", "hidden"),
    [
        ("Warsaw", 52.23, 21.01, 0.86),
        ("Budapest", 47.50, 19.04, 0.66),
        ("Rome", 41.90, 12.50, 0.77),
    ],
)
def test_an_eclipse_is_seen_though_the_sun_sets_before_its_middle(
    city, latitude, longitude, hidden
):
    """12 August 2026, by the light that is left at its greatest moment above the horizon."""
    eclipse = next_solar_eclipse(watch(datetime(2026, 8, 1, tzinfo=UTC), latitude, longitude))
    assert eclipse.at.date().isoformat() == "2026-08-12"
    assert eclipse.kind == "partial"
    left = sun_left(watch(eclipse.at, latitude, longitude)).mean()
    assert 1.0 - left == pytest.approx(hidden, abs=0.03)
    sun = sun_position(eclipse.at, latitude, longitude)
    assert sun.apparent_elevation_rad == pytest.approx(0.0, abs=np.radians(0.3))


@pytest.mark.parametrize("separation", [0.0, 0.02, 0.5, 1.0, 1.9, 2.2])
@pytest.mark.parametrize("radius", [0.95, 1.0, 1.04])
def test_the_hidden_area_is_that_of_two_circles(separation, radius):
    """Beside an integral over the disc, annular and total ones too."""
    assert hidden_area(separation, radius) == pytest.approx(
        1.0 - _counted_left(separation, radius), abs=2e-3
    )


def _counted_left(separation, radius):
    y, x = np.mgrid[-1.0:1.0:1001j, -1.0:1.0:1001j]
    disc = np.hypot(x, y) <= 1.0
    return float((np.hypot(x - separation, y)[disc] > radius).mean())


def test_full_moon_rise_and_set_are_the_almanacs():
    # Prague, 3 January 2026: full at 10:03 UT (almanac).
    at = watch(datetime(2026, 1, 1, 12, tzinfo=UTC), 50.08, 14.44)
    assert abs((next_full_moon(at) - datetime(2026, 1, 3, 10, 3, tzinfo=UTC)).total_seconds()) < 60
    rise, fall = next_rise_and_set(at)
    assert datetime(2026, 1, 1, 12, tzinfo=UTC) < rise < fall


# 28 August 2026: partial, 0.930 of the moon's diameter in the umbra, seen from Lisbon; 31 December
# 2028: total. Times and sizes are NASA's (Espenak, Five Millennium Canon of Lunar Eclipses).
@pytest.mark.parametrize(
    ("instant", "place", "covered"),
    [
        (datetime(2026, 8, 28, 4, 13, tzinfo=UTC), (38.7, -9.1), 0.930),
        (datetime(2028, 12, 31, 16, 52, tzinfo=UTC), (35.0, 105.0), 1.246),
        (datetime(2026, 8, 28, 2, 34, tzinfo=UTC), (38.7, -9.1), 0.0),
    ],
)
def test_the_umbra_covers_as_much_of_the_moon_as_published(instant, place, covered):
    at = watch(instant, *place)
    moon = moon_at(at)
    shadow = earth_shadow(at, moon, 2.0)
    apart = np.linalg.norm(np.cross(moon.direction, shadow.direction))
    magnitude = (shadow.umbra_rad + moon.angular_radius_rad - apart) / moon.angular_radius_rad / 2.0
    assert magnitude == pytest.approx(covered, abs=0.025)


def test_an_eclipsed_moon_is_as_dark_as_danjons_scale_is_chosen():
    """Of a total eclipse four to three hundred millionths of the light are left, red the most."""
    at = watch(datetime(2028, 12, 31, 16, 52, tzinfo=UTC), 35.0, 105.0)
    moon = moon_at(at)
    left = [light_left(moon, earth_shadow(at, moon, number)) for number in (0.0, 2.0, 4.0)]
    assert left[0].max() < left[1].max() < left[2].max() < 3e-3
    assert all(red > green > blue for red, green, blue in left)
    assert light_left(moon, None).min() == 1.0
