"""Exposure and the tone curve, on the CPU."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from vrut_lite.geometry import colour
from vrut_lite.geometry.colour import LUMENS_PER_WATT, SRGB_FROM_XYZ
from vrut_lite.messages.picture import SetExposure
from vrut_lite.pictures import exposure, tone_map
from vrut_lite.pictures.display import display_picture, dither
from vrut_lite.pictures.exposure import ev100_of
from vrut_lite.pictures.night_eye import adapted_cd, as_sharp_as_seen, seen_by_eye


@pytest.mark.parametrize("luminance_cd_m2", [500.0, 4000.0, 30000.0])
def test_a_grey_wall_by_day_lands_on_middle_grey(luminance_cd_m2):
    """The meter puts a uniform picture by day at 0.18, whatever its luminance."""
    radiance = np.full((20, 30, 3), luminance_cd_m2 / 683.0)
    ev100 = exposure.automatic_ev100(radiance)
    assert radiance.mean() * exposure.scale_of(ev100) == pytest.approx(0.18, rel=1e-3)


def test_night_looks_darker_than_day_but_not_black():
    """A scene of 0.001 cd/m^2 is shown darker than one of 1000, and above nothing."""
    dark = np.full((20, 30, 3), 1e-3 / 683.0)
    shown = dark.mean() * exposure.scale_of(exposure.automatic_ev100(dark))
    assert 0.0 < shown < 0.05


def test_exposure_follows_the_light_from_candlelight_dusk_to_noon_snow():
    """From 0.001 to 100,000 cd/m^2 a uniform picture is shown between 0.4 % and 18 %.

    0.18 in the full adaptation of day (EV 9, 111 cd/m^2, and up), darker towards night but
    never black; more light never makes a lower EV100 nor a darker picture.
    """
    luminances = np.logspace(-3, 5, 81)
    ev100, shown = [], []
    for luminance in luminances / 683.0:
        ev100.append(exposure.automatic_ev100(np.full((8, 8, 3), luminance)))
        shown.append(luminance * exposure.scale_of(ev100[-1]))
    assert np.all(np.diff(ev100) > 0.0)
    assert np.all(np.diff(shown) > -1e-9)
    np.testing.assert_allclose(np.array(shown)[luminances > 111.0], 0.18, rtol=1e-3)
    assert min(shown) > 0.004
    assert -4.0 < ev100[0] < -2.0
    assert 18.0 < ev100[-1] < 19.0


def test_the_suns_disc_does_not_darken_the_picture():
    """A disc of 0.1 % of the pixels, a million times as bright, changes nothing."""
    radiance = np.full((100, 100, 3), 3.0)
    without = exposure.automatic_ev100(radiance)
    radiance[50, 50:60] = 3e6
    assert exposure.automatic_ev100(radiance) == pytest.approx(without, abs=1e-6)


def test_a_large_picture_is_metered_as_a_small_one_of_it():
    """A gradient of 2 million pixels and one of 20,000: within a hundredth of a stop."""
    ev100 = []
    for height, width in ((100, 200), (1000, 2000)):
        column = np.geomspace(0.5, 20.0, height)[:, None, None]
        row = np.geomspace(1.0, 3.0, width)[None, :, None]
        ev100.append(exposure.automatic_ev100(column * row * np.ones(3)))
    assert ev100[0] == pytest.approx(ev100[1], abs=0.01)


def room_with_windows(share, ratio):
    """A room (20,000 pixels) whose walls differ by a stop or two, and windows on their share."""
    rng = np.random.default_rng(1)
    walls = 3.0 * np.exp2(rng.normal(0.0, 0.8, 20_000))
    walls[: int(share * walls.size)] = 3.0 * ratio
    return walls[:, None] * np.ones(3)


def wall_stops(share, ratio):
    """Stops by which the walls are shown above middle grey."""
    radiance = room_with_windows(share, ratio)
    return np.log2(3.0 * exposure.scale_of(exposure.automatic_ev100(radiance)) / 0.18)


@pytest.mark.parametrize("share", [0.0, 0.05, 0.12, 0.2, 0.3])
@pytest.mark.parametrize("ratio", [100.0, 300.0])
def test_a_room_is_exposed_for_its_walls_and_not_for_its_windows(share, ratio):
    """Within 0.6 stops of middle grey, whatever is outside."""
    assert abs(wall_stops(share, ratio)) < 0.6


def test_exposure_does_not_jump_while_a_window_comes_into_view():
    """No hundredth of the picture changes it by more than half a stop."""
    stops = [wall_stops(share, 100.0) for share in np.arange(0.0, 1.0, 0.01)]
    assert np.abs(np.diff(stops)).max() < 0.5
    assert stops[-1] == pytest.approx(-np.log2(100.0), abs=0.2)


def test_what_differs_by_four_stops_counts_all_alike():
    """Outdoors the mean is the plain log mean: sky and shadow, each on half of the picture."""
    stops = np.tile([0.0, 1.0, 2.0, 3.0, 4.0], 2000)
    ev100 = exposure.automatic_ev100(3.0 * np.exp2(stops)[:, None] * np.ones(3))
    mean = np.sort(stops)[:-20].mean()
    expected = exposure.automatic_ev100(np.full((10, 3), 3.0 * 2.0**mean))
    assert ev100 == pytest.approx(expected, abs=1e-6)


def test_space_around_a_planet_does_not_blow_it_out():
    """Black on seven tenths of the picture counts as four stops below the lit part."""
    radiance = np.full((10_000, 3), 30.0)
    radiance[:7000] = 0.0
    shown = 30.0 * exposure.scale_of(exposure.automatic_ev100(radiance)) / 0.18
    assert np.log2(shown) == pytest.approx(0.7 * 4.0, abs=0.05)


# Luminance (W m^-2 sr^-1) of white matter in full sun: 27,000 cd/m^2.
FULL_SUN = 40.0


def shown_in_sun(albedo_shares, white=FULL_SUN):
    """Byte (of 255) of each albedo, in a picture with these shares of matter under the sun."""
    albedos = np.concatenate([np.full(round(1000 * n), a) for a, n in albedo_shares.items()])
    radiance = FULL_SUN * albedos[:, None] * np.ones(3)
    scale = exposure.scale_of(exposure.automatic_ev100(radiance, white))
    return {a: 255.0 * tone_map.agx(FULL_SUN * a * scale * np.ones(3))[0] for a in albedo_shares}


def test_snow_is_white_and_a_black_cat_black():
    """A meter alone shows both as middle grey; a photographer knows the light they stand in."""
    snow, cat = {0.85: 0.8, 0.2: 0.2}, {0.03: 0.4, 0.12: 0.6}
    assert shown_in_sun(snow, white=0.0)[0.85] < 140.0
    assert shown_in_sun(snow)[0.85] > 205.0
    assert shown_in_sun(cat, white=0.0)[0.03] > 70.0
    assert shown_in_sun(cat)[0.03] < 60.0


def test_plaster_in_the_sun_is_just_below_clipping():
    """In a street half in shade, paving, brick and plaster: brighter by up to a stop, unclipped."""
    street = {0.04: 0.4, 0.2: 0.35, 0.4: 0.2, 0.8: 0.05}
    metered, corrected = shown_in_sun(street, white=0.0), shown_in_sun(street)
    assert metered[0.8] + 10.0 < corrected[0.8] < 240.0
    assert metered[0.2] + 10.0 < corrected[0.2]


@pytest.mark.parametrize("luminance_cd_m2", [1e-3, 1.0, 50.0])
def test_dusk_and_night_keep_the_meters_exposure(luminance_cd_m2):
    """A night that is corrected as a day would look like one."""
    radiance = np.linspace(0.2, 2.0, 300)[:, None] * np.ones(3) * luminance_cd_m2 / LUMENS_PER_WATT
    metered = exposure.automatic_ev100(radiance)
    for white in np.geomspace(1e-3, 1e3, 7) * radiance.max():
        assert exposure.automatic_ev100(radiance, white) == metered


@pytest.mark.parametrize("share", [0.0, 0.05, 0.2])
def test_a_room_by_day_keeps_the_meters_exposure(share):
    """Its walls have a hundredth of the light outside, whatever the sun does there."""
    radiance = room_with_windows(share, 100.0)
    assert exposure.automatic_ev100(radiance, 300.0) == exposure.automatic_ev100(radiance)


def test_the_photographers_correction_never_jumps():
    """Light that fades, a subject that comes into view, a cloud: no small change of these moves the
    exposure by more than a few times as much."""
    stops = np.linspace(-2.0, 2.0, 400)
    for brightest in np.linspace(0.0, 5.0, 11):
        picture = np.exp2(np.append(stops, np.full(20, brightest)))[:, None] * np.ones(3)
        fading = [(2.0**x, 2.0**x) for x in np.arange(-12.0, 4.0, 0.04)]
        shading = [(1.0, 2.0**x) for x in np.arange(-3.0, 9.0, 0.04)]
        for sequence in (fading, shading):
            ev100 = [
                exposure.automatic_ev100(20.0 * light * picture, 20.0 * card)
                for light, card in sequence
            ]
            assert np.abs(np.diff(ev100)).max() < 0.16


@settings(deadline=None)
@given(st.lists(st.floats(0, 1e8), min_size=3, max_size=3), st.floats(1.0, 4.0))
def test_the_tone_curve_stays_in_range_and_rises(rgb, factor):
    """Any radiance lands in [0, 1], and a brighter grey is never shown darker."""
    assert (tone_map.agx(rgb) >= 0.0).all()
    assert (tone_map.agx(rgb) <= 1.0).all()
    grey = np.full(3, max(rgb))
    assert (tone_map.agx(grey * factor) >= tone_map.agx(grey) - 1e-6).all()


@settings(deadline=None)
@given(st.lists(st.floats(-1.0, 1e8), min_size=3, max_size=3))
def test_every_curve_shows_something_for_any_radiance(rgb):
    """The values lie in range without NaN, also for colours outside the gamut."""
    for curve in ("agx", "exponential", "none"):
        shown = tone_map.tone_mapped(rgb, curve)
        assert ((shown >= 0.0) & (shown <= 1.0)).all()


def test_by_night_the_eye_sees_no_colour_and_by_day_all():
    """Below 2e-3 cd/m² of daylight rods alone see, above 5 cones (CIE 191:2010); to rods blue is
    brighter than red of the same luminance (Purkinje)."""
    red, blue = np.array([1.0, 0.1, 0.1]), np.array([0.1, 0.1, 1.0])
    red, blue = red / colour.luminance(red), blue / colour.luminance(blue)
    night = seen_by_eye(np.array([red, blue]) * 1e-3 / LUMENS_PER_WATT)
    hue = night / night.sum(axis=-1, keepdims=True)
    np.testing.assert_allclose(hue[0], hue[1], rtol=1e-9)
    assert colour.luminance(night[1]) > 3.0 * colour.luminance(night[0])
    day = np.array([red, blue]) * 10.0 / LUMENS_PER_WATT
    np.testing.assert_allclose(seen_by_eye(day), day, rtol=1e-12)
    white = seen_by_eye(np.full(3, 1e-3 / LUMENS_PER_WATT))
    assert colour.luminance(white) * LUMENS_PER_WATT == pytest.approx(1e-3, rel=0.01)


def mesopic_coefficient(luminance_cd_m2, scotopic_over_photopic):
    """CIE 191:2010's m by its own iteration, damped."""
    peak, m = 683.0 / 1699.0, 0.5
    for _ in range(200):
        scotopic = scotopic_over_photopic * luminance_cd_m2
        mesopic = (m * luminance_cd_m2 + (1 - m) * scotopic * peak) / (m + (1 - m) * peak)
        m = 0.5 * m + 0.5 * np.clip(0.7670 + 0.3334 * np.log10(mesopic), 0.0, 1.0)
    return m


@pytest.mark.parametrize(("ratio", "tolerance"), [(2.47, 0.015), (1.41, 0.075)])
def test_rods_and_cones_share_as_in_cie_191(ratio, tolerance):
    """Of a red that rods do not see the part m is left, as it is for daylight and for lamps."""
    red = SRGB_FROM_XYZ @ [1.0, 0.2, 0.0]
    red /= colour.luminance(red)
    for cd_m2 in np.geomspace(1e-3, 8.0, 30):
        light = red * cd_m2 / LUMENS_PER_WATT
        cones = seen_by_eye(light) / light
        np.testing.assert_allclose(cones, mesopic_coefficient(cd_m2, ratio), atol=tolerance)


def test_a_lamp_lit_room_keeps_the_lamps_colour():
    """At 1 cd/m² m is 0.77: a warm lamp's wall stays orange, a white one's grey to 6 %."""
    warm = np.array([1.0, 0.45, 0.13])
    room = np.array([warm / colour.luminance(warm), np.ones(3)])[None] / LUMENS_PER_WATT
    field_cd = adapted_cd(ev100_of(SetExposure(), room), "eye")
    assert field_cd == pytest.approx(1.0, rel=0.01)
    lamp, white = seen_by_eye(room, field_cd)[0]
    assert lamp[0] > 1.5 * lamp[1] > 2.0 * lamp[2]
    assert np.ptp(white) < 0.06 * white.mean()
    # A dark corner of the room is not seen by rods alone: the eye is adapted to the room.
    corner = seen_by_eye(room * 0.002, field_cd)[0, 0]
    np.testing.assert_allclose(corner / corner.sum(), lamp / lamp.sum(), rtol=1e-6)


def moonlit(luminance_cd_m2):
    """A landscape under 4100 K: ground, a red thing and blue sky, (4, 3)."""
    hues = np.array([[1.25, 0.97, 0.64], [2.0, 0.75, 0.5], [0.6, 1.0, 1.8], [0.25, 0.2, 0.13]])
    return hues / LUMENS_PER_WATT * luminance_cd_m2


def test_moonlight_is_neutral_to_blue_to_the_eye_and_warm_to_a_long_exposure():
    """A full moon is redder than the sun (4100 K); rods show it bluish (Jensen 2000), a camera
    balanced for daylight as it is. The long exposure is brighter, by stops."""
    shown = {}
    for look in ("eye", "exposure"):
        wish = SetExposure(night_look=look)
        shown[look] = display_picture(moonlit(0.02)[None], wish=wish, bits=16)[0] / 65535.0
    eye, camera = shown["eye"][0], shown["exposure"][0]
    assert eye[2] > eye[1] >= eye[0] - 0.005
    assert camera[0] > camera[1] > camera[2]
    assert camera.mean() > 2.0 * eye.mean()


def test_the_eyes_rods_are_saturated_by_day():
    """A dark corner of a bright picture keeps its colours, exactly as in a camera's picture; from
    dusk on rods come in without a step."""
    by_day = moonlit(np.array([[0.05], [1.0], [3000.0], [500.0]]))[None]
    eye, camera = (SetExposure(night_look=look) for look in ("eye", "exposure"))
    same = [display_picture(by_day, 10.0, wish, bits=16) for wish in (eye, camera)]
    np.testing.assert_array_equal(*same)
    dusk = [display_picture(moonlit(5.0)[None], ev, eye, bits=16) for ev in np.arange(3, 11, 0.05)]
    steps = np.abs(np.diff(np.array(dusk, float), axis=0)) / 65535.0
    assert steps.max() < 0.02


def test_the_papers_curve_and_none_are_what_they_say():
    """1 - exp(-k L) with k such that 0.18 stays 0.18; none is sRGB itself, cut off at 1."""
    picture = np.array([0.0, 0.18, 0.5, 2.0])
    decoded = {c: srgb_decode(tone_map.tone_mapped(picture, c)) for c in ("exponential", "none")}
    k = -np.log(0.82) / 0.18
    np.testing.assert_allclose(decoded["exponential"], 1 - np.exp(-k * picture), atol=1e-12)
    np.testing.assert_allclose(decoded["exponential"][1], 0.18)
    np.testing.assert_allclose(decoded["none"], [0.0, 0.18, 0.5, 1.0], atol=1e-12)


def srgb_decode(encoded):
    """IEC 61966-2-1."""
    return np.where(encoded <= 0.04045, encoded / 12.92, ((encoded + 0.055) / 1.055) ** 2.4)


def test_middle_grey_is_shown_as_a_middle_grey():
    """AgX shows 0.18 at about half of the display's range, neutral to 1 %."""
    shown = tone_map.agx([0.18, 0.18, 0.18])
    assert 0.35 < shown.mean() < 0.55
    assert np.ptp(shown) < 0.01


def test_the_dither_is_unbiased_and_below_one_step():
    """It must break bands without brightening: mean below 1 % of a step, always under one."""
    noise = dither(512, 512)
    assert abs(noise.mean()) < 0.01
    assert np.abs(noise).max() < 1.0


def test_a_smooth_ramp_shows_no_bands():
    """A ramp over four 8-bit steps: means of columns follow it to a tenth of a step."""
    ramp = np.broadcast_to(np.linspace(2.00, 2.06, 512)[None, :, None], (512, 512, 3))
    shown = display_picture(ramp, ev100=11.0).astype(float).mean(axis=(0, 2))
    smooth = np.polynomial.Polynomial.fit(np.arange(512), shown, 3)(np.arange(512))
    assert np.ptp(shown) > 0.3
    assert np.abs(shown - smooth).max() < 0.12


def test_by_starlight_the_eye_makes_out_less_than_by_day():
    """Bars of a tenth of a degree: by day they stand, by starlight next to nothing is left of them,
    and no light is lost (Shlaer 1937, after Ward Larson and others 1997)."""
    bars = np.broadcast_to(1.0 + 0.5 * (-1.0) ** np.arange(24), (24, 24))[..., None] * np.ones(3)
    pixel = np.radians(0.1)
    by_day = as_sharp_as_seen(100.0 * bars, pixel)
    np.testing.assert_allclose(by_day, 100.0 * bars)
    by_stars = as_sharp_as_seen(bars * 2e-5 / LUMENS_PER_WATT, pixel)[8:-8, 8:-8]
    assert np.ptp(by_stars) < 0.05 * by_stars.mean()
    assert by_stars.mean() == pytest.approx(2e-5 / LUMENS_PER_WATT, rel=0.02)
    np.testing.assert_array_equal(as_sharp_as_seen(bars, 0.0), bars)


def test_a_star_is_round_however_much_the_picture_magnifies():
    """Seen through a telescope, where the eye's blur is wider than any sum, a star is a disc that
    falls off from its middle, not a square."""
    star = np.full((41, 41, 3), 1e-6 / LUMENS_PER_WATT)
    star[20, 20] = 3e-4 / LUMENS_PER_WATT
    seen = as_sharp_as_seen(star, np.radians(1.0 / 400.0))[..., 1]
    rows, columns = np.mgrid[-20:21, -20:21]
    apart = np.hypot(rows, columns)
    shown = (seen > 1.02 * seen[0, 0]) & (apart > 0.0)
    assert 3.0 < apart[shown].max() <= apart[~shown & (apart > 0.0)].min() + 1.0
    ring = [seen[(apart > r - 0.5) & (apart <= r + 0.5)].mean() for r in (1, 3, 5)]
    assert ring[0] > 1.2 * ring[1] > 1.2 * ring[2]
