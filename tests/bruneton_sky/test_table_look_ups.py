"""What tables answer: Bruneton's own look-ups, and sense wherever he has none."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
from bruneton_reference import GROUND_RADIUS_M, reference, reference_tables
from bruneton_sky.geometry import distance_to_ground
from bruneton_sky.tables import look_ups
from bruneton_sky.tables.interpolate import interpolate
from bruneton_sky.tables.tables import Tables
from hypothesis import example, given
from hypothesis import strategies as st
from numpy.typing import NDArray

from vrut_lite.geometry.colour import rgb_from_spectrum
from vrut_lite.numeric_types import FloatArray

TABLES = reference_tables()
TOP_RADIUS_M = GROUND_RADIUS_M + TABLES.atmosphere.top_altitude_m
UP = np.array([0.0, 0.0, 1.0])


def direction(zenith_deg: float, azimuth_deg: float = 0.0) -> NDArray[np.float64]:
    """A unit vector."""
    zenith, azimuth = np.radians([zenith_deg, azimuth_deg])
    across = np.sin(zenith)
    return np.array([across * np.cos(azimuth), across * np.sin(azimuth), np.cos(zenith)])


SUN = direction(50.0)


def standing(altitude_m: float) -> NDArray[np.float64]:
    """A point on the planet's axis."""
    return (GROUND_RADIUS_M + altitude_m) * UP


@pytest.fixture
def linear_in_the_sun(monkeypatch: pytest.MonkeyPatch) -> None:
    """Look-ups interpolate the sun's axis by lines too, as Bruneton's do."""

    def lines(tables: Sequence[FloatArray], at: Sequence[FloatArray]) -> tuple[FloatArray, ...]:
        return tuple(interpolate(table, at) for table in tables)

    monkeypatch.setattr(look_ups, "interpolate_suns", lines)


@pytest.mark.usefixtures("linear_in_the_sun")
def test_sky_is_brunetons() -> None:
    """540 rays, 1 m to 3,000 km, suns to -10 deg, with shadows: his GetSkyRadiance to 1e-6."""
    data = reference()
    rays = (data[f"sky_{name}"] for name in ("camera", "view", "sun", "shadow_length"))
    radiance, transmittance = TABLES.sky_radiance(*rays)
    assert radiance == pytest.approx(data["sky_radiance"], rel=1e-6)
    assert transmittance == pytest.approx(data["sky_transmittance"], rel=1e-6)


@pytest.mark.usefixtures("linear_in_the_sun")
def test_air_before_points_is_brunetons() -> None:
    """216 segments, with shadows: his GetSkyRadianceToPoint to 1e-6, negative values made 0.

    Left out are points that the ground hides, where his values mean nothing: those marked in
    the file, and for the transmittance three more whose segments pass under by less than 0.5 m.
    """
    data = reference()
    segment = (data[f"pt_{name}"] for name in ("camera", "point", "sun", "shadow_length"))
    radiance, transmittance = TABLES.radiance_to_point(*segment)
    seen = ~data["pt_occluded"]
    truth = np.maximum(data["pt_radiance"], 0.0)
    assert radiance[seen] == pytest.approx(truth[seen], rel=1e-6)
    way = data["pt_point"] - data["pt_camera"]
    length, radius = np.linalg.norm(way, axis=1), np.linalg.norm(data["pt_camera"], axis=1)
    mu = (way * data["pt_camera"]).sum(axis=1) / (length * radius)
    with np.errstate(invalid="ignore"):
        ground = distance_to_ground(GROUND_RADIUS_M, radius - GROUND_RADIUS_M, mu)
    hits = (mu < 0) & (radius * np.sqrt(1 - mu * mu) < GROUND_RADIUS_M)
    seen &= ~hits | (length < ground + 1.0)
    assert seen.sum() == 203
    assert transmittance[seen] == pytest.approx(data["pt_transmittance"][seen], rel=1e-6)


@pytest.mark.usefixtures("linear_in_the_sun")
def test_irradiance_is_brunetons() -> None:
    """54 surfaces, three altitudes, tilted too: his GetSunAndSkyIrradiance to 1e-6."""
    data = reference()
    surfaces = (data[f"irr_{name}"] for name in ("point", "normal", "sun"))
    sun, sky = TABLES.sun_and_sky_irradiance(*surfaces)
    assert sun == pytest.approx(data["irr_sun_irradiance"], rel=1e-6)
    assert sky == pytest.approx(data["irr_sky_irradiance"], rel=1e-6)


ANGLE = st.floats(0.0, 180.0) | st.sampled_from([0.0, 90.0, 180.0])
ALTITUDE = st.floats(0.0, 70_000.0) | st.sampled_from([0.0, 60_000.0, 4e8])


@given(ALTITUDE, ANGLE, ANGLE, st.floats(0.0, 360.0), st.floats(0.0, 1e6))
@example(0.0, 29.0, 0.0, 0.0, 3.2991693737023704e-162)
def test_answers_are_finite_and_not_negative(
    altitude_m: float, view_deg: float, sun_deg: float, azimuth_deg: float, length_m: float
) -> None:
    """From anywhere, to anywhere, under any sun: light is not negative, transmittance <= 1."""
    camera, view, sun = standing(altitude_m), direction(view_deg), direction(sun_deg, azimuth_deg)
    sky = TABLES.sky_radiance(camera, view, sun, shadow_length_m=0.1 * length_m)
    before = TABLES.radiance_to_point(camera, camera + length_m * view, sun, 0.1 * length_m)
    for radiance, transmittance in (sky, before):
        assert np.all(np.isfinite(radiance))
        assert np.all(radiance >= 0)
        assert np.all((transmittance >= 0) & (transmittance <= 1))
    light = TABLES.sun_and_sky_irradiance(camera, view, sun)
    others = [*light, TABLES.ground_radiance(camera, view, sun)]
    assert all(np.all(np.isfinite(values) & (values >= 0)) for values in others)


def test_rays_that_miss_the_air_are_dark_and_clear() -> None:
    """Space is black: no air on the ray, nothing added and nothing taken."""
    camera = standing(3e6)
    for view in (UP, direction(90.0), direction(135.0)):
        radiance, transmittance = TABLES.sky_radiance(camera, view, SUN)
        assert not radiance.any()
        assert np.all(transmittance == 1.0)
    radiance, transmittance = TABLES.radiance_to_point(camera, camera - 1e6 * UP, SUN)
    assert radiance == pytest.approx(0.0, abs=1e-12)
    assert transmittance == pytest.approx(1.0, abs=1e-12)


@pytest.mark.parametrize("impact_m", [1e6, 6.3e6, 6_359_999.0, 6_360_001.0, 6.4e6, 6_419_999.0])
def test_the_moon_sees_what_the_rays_entry_sees(impact_m: float) -> None:
    """A ray through empty space does not change: from 380,000 km as from where it enters."""
    entry = np.array(
        [impact_m, 0.0, np.sqrt((TOP_RADIUS_M - impact_m) * (TOP_RADIUS_M + impact_m))]
    )
    near = TABLES.sky_radiance(entry * (1 - 1e-13), -UP, SUN)
    far = TABLES.sky_radiance(entry + 3.8e8 * UP, -UP, SUN)
    assert far[0] == pytest.approx(near[0], rel=1e-5)
    assert far[1] == pytest.approx(near[1], rel=1e-5)


def test_a_segment_to_space_is_the_whole_sky() -> None:
    """Beyond the top there is no air: the segment's light is the ray's, likewise from space."""
    camera = standing(2000.0)
    for view in (direction(20.0, 70.0), direction(88.0), direction(100.0, 10.0)):
        sky = TABLES.sky_radiance(camera, view, SUN)[0]
        before = TABLES.radiance_to_point(camera, camera + 5e6 * view, SUN)[0]
        assert before == pytest.approx(sky, rel=1e-9)
    far = standing(1e6)
    whole, seen = TABLES.radiance_to_point(far, standing(0.0), SUN)
    assert whole == pytest.approx(TABLES.sky_radiance(far, -UP, SUN)[0], rel=1e-9)
    assert seen == pytest.approx(TABLES.radiance_to_point(standing(6e4), standing(0.0), SUN)[1])


def test_a_segment_without_length_and_one_into_the_ground() -> None:
    """Nothing lies before one's own eye; a point under the ground looks as the ground above it."""
    camera = standing(500.0)
    radiance, transmittance = TABLES.radiance_to_point(camera, camera, SUN)
    assert not radiance.any()
    assert np.all(transmittance == 1.0)
    down = direction(120.0)
    ground = camera + distance_to_ground(GROUND_RADIUS_M, 500.0, down[2]) * down
    above, below = (
        TABLES.radiance_to_point(camera, point, SUN) for point in (ground, ground + 3000.0 * down)
    )
    # The tables' axis of altitude is steep at the ground: a nanometre is 1e-7 of it.
    assert below[0] == pytest.approx(above[0], rel=1e-5)
    assert below[1] == pytest.approx(above[1], rel=1e-7)


def test_a_shadow_over_the_whole_ray_leaves_no_light() -> None:
    """A shaft as long as the ray is dark from end to end; a longer shaft is no brighter."""
    camera, view = standing(1000.0), direction(70.0, 40.0)
    lengths = np.array([0.0, 1e3, 1e4, 3e5])
    radiance, _ = TABLES.sky_radiance(camera, view, SUN, lengths)
    assert np.all(np.diff(radiance, axis=0) < 0)
    assert radiance[-1] == pytest.approx(0.0, abs=1e-12)
    point = camera + 2e4 * view
    dark, _ = TABLES.radiance_to_point(camera, point, SUN, 2e4)
    assert dark == pytest.approx(0.0, abs=1e-12)


def test_ground_is_a_lit_lambertian_sphere() -> None:
    """Seen straight down from the top: T albedo / pi (sun mu_s + sky), by the other look-ups."""
    camera, ground = standing(60_000.0), standing(0.0)
    seen = TABLES.ground_radiance(camera, -UP, SUN)
    clear = TABLES.radiance_to_point(camera, ground, SUN)[1]
    reflected = np.asarray(TABLES.atmosphere.ground_albedo) / np.pi
    surface = reflected * sum(TABLES.sun_and_sky_irradiance(ground, UP, SUN))
    assert seen == pytest.approx(clear * surface, rel=1e-9)
    assert not TABLES.ground_radiance(camera, UP, SUN).any()
    assert not TABLES.ground_radiance(standing(3e6), direction(130.0), SUN).any()


def test_surface_sees_half_the_sky_when_upright() -> None:
    """Ambient occlusion by the ground's plane: a level surface all, a wall half, a ceiling none."""
    point, wall = standing(0.0), direction(90.0, 180.0)
    level, upright, ceiling = (
        TABLES.sun_and_sky_irradiance(point, normal, SUN)[1] for normal in (UP, wall, -UP)
    )
    assert upright == pytest.approx(0.5 * level)
    assert ceiling == pytest.approx(0.0, abs=1e-15)


def test_the_sun_rises_early_in_space() -> None:
    """From 3,000 km the planet is a disc of 43 deg: the sun shows to 47 deg below level.

    Between 43.3 deg and that it passes through the air; above, nothing dims it.
    """
    satellite, solar = standing(3e6), np.asarray(TABLES.atmosphere.solar_irradiance)
    for zenith_deg, share in ((90.0, 1.0), (136.0, 1.0), (140.0, 0.0), (180.0, 0.0)):
        sun = direction(zenith_deg)
        light, _ = TABLES.sun_and_sky_irradiance(satellite, sun, sun)
        assert light == pytest.approx(share * solar)
    grazing = direction(180.0 - np.degrees(np.arcsin(6.37e6 / 9.36e6)))
    light, _ = TABLES.sun_and_sky_irradiance(satellite, grazing, grazing)
    assert np.all((light > 0) & (light < 0.8 * solar))


def test_rgb_is_the_skylights_colour() -> None:
    """The one rule of colour, with the exponent of skylight, as the single-scattering sky's."""
    spectral, _ = TABLES.sky_radiance(standing(0.0), direction(30.0), SUN)
    rgb = rgb_from_spectrum(spectral, TABLES.atmosphere.wavelength_nm, 3.0)
    assert TABLES.radiance_rgb(standing(0.0), direction(30.0), SUN) == pytest.approx(rgb)


def test_arguments_broadcast() -> None:
    """One camera, a grid of views, a row of suns."""
    views = np.stack([direction(z) for z in (0.0, 45.0, 80.0)])[:, None]
    suns = np.stack([direction(z) for z in (10.0, 95.0)])
    radiance, transmittance = TABLES.sky_radiance(standing(10.0), views, suns)
    assert radiance.shape == (3, 2, 3)
    assert transmittance.shape in {(3, 1, 3), (3, 2, 3)}
    alone = TABLES.sky_radiance(standing(10.0), views[1, 0], suns[1])[0]
    assert radiance[1, 1] == pytest.approx(alone)


@pytest.mark.parametrize(
    ("camera", "view", "sun", "sentence"),
    [
        (standing(-100.0), UP, SUN, "camera_m must not lie below the ground"),
        (standing(np.nan), UP, SUN, "camera_m must lie between .* not nan"),
        (standing(0.0), 2.0 * UP, SUN, "view must be unit vectors"),
        (standing(0.0), UP, SUN[:2], "sun must be finite numbers of shape"),
        (5.0, UP, SUN, "camera_m must be finite numbers of shape"),
    ],
)
def test_bad_values_are_refused(camera, view, sun, sentence: str) -> None:  # type: ignore[no-untyped-def]
    """One sentence that names what is wrong."""
    with pytest.raises(ValueError, match=sentence):
        TABLES.sky_radiance(camera, view, sun)


def test_bad_numbers_are_refused() -> None:
    """Lengths and shares have their range too."""
    with pytest.raises(ValueError, match=r"shadow_length_m must lie between 0 and .* not -1"):
        TABLES.sky_radiance(standing(0.0), UP, SUN, -1.0)


def test_arrays_of_another_shape_are_refused() -> None:
    """Tables that do not match their sizes would be looked up wrongly in silence."""
    with pytest.raises(
        ValueError, match=r"irradiance of the tables must have the shape \(8, 16, 3\)"
    ):
        replace(TABLES, irradiance=TABLES.irradiance[1:])


def test_haze_that_no_light_crosses_gives_no_nan() -> None:
    """Where both transmittances of a ratio underflow the way is opaque, not undefined."""
    opaque: Tables = replace(TABLES, transmittance=np.zeros_like(TABLES.transmittance))
    _, transmittance = opaque.radiance_to_point(standing(0.0), standing(0.0) + 1e4 * UP, SUN)
    assert not transmittance.any()


def test_a_surface_that_looks_down_sees_no_sky() -> None:
    """Its share of the sky, (1 + n . up) / 2, is a rounding below 0 for some: they see none."""
    up = np.random.default_rng(1).normal(size=(2000, 3))
    up /= np.linalg.norm(up, axis=1, keepdims=True)
    _, sky = TABLES.sun_and_sky_irradiance((GROUND_RADIUS_M + 10.0) * up, -up, up)
    assert (sky >= 0.0).all()
    assert (sky < 1e-14).all()
