"""Stars and moon as an eye aloft and in space sees them."""

from datetime import UTC, datetime, timedelta

import numpy as np
import pytest
from night_sky.module import NightSky, stars_seen
from night_sky.night_air import RGB_NM, night_air
from night_sky.planets import planets_at
from night_sky.sight import sight
from night_sky.sky_axes import watch
from night_sky.stars import stars_at

from vrut_lite.atmosphere.refraction import dip_rad
from vrut_lite.atmosphere.sunlight import extinctions_per_m
from vrut_lite.kernel.bus import Kernel
from vrut_lite.kernel.messages import Demand, SetClock
from vrut_lite.messages.camera import MoveCamera
from vrut_lite.messages.haze import SetHaze
from vrut_lite.messages.night import MoonDiscChanged, StarsChanged
from vrut_lite.messages.place import SetPlace
from vrut_lite.sky.moon_disc import moon_samples

HAZE = SetHaze(optical_depth_550=0.2)
NIGHT = datetime(2026, 1, 15, 22, tzinfo=UTC)
PRAGUE = SetPlace(latitude_deg=50.08, longitude_deg=14.44)


def at_prague():
    return watch(NIGHT, PRAGUE.latitude_deg, PRAGUE.longitude_deg)


@pytest.mark.parametrize("height_m", [0.0, 10_000.0, 100_000.0, 400_000.0])
@pytest.mark.parametrize("over_horizon_deg", [4.0, 30.0])
def test_a_star_is_dimmed_by_the_air_on_the_line_to_it(height_m, over_horizon_deg):
    """Summed in metres along the straight ray from the eye: none of it above the air.

    Lower rays are bent: `test_slant_path` holds those.
    """
    elevation = np.radians(over_horizon_deg) - dip_rad(height_m)
    along = np.linspace(0.0, 5e6, 400_001)
    x, y = along * np.cos(elevation), 6.36e6 + height_m + along * np.sin(elevation)
    altitude = np.hypot(x, y) - 6.36e6
    kinds = extinctions_per_m(np.maximum(altitude, 0.0), RGB_NM, HAZE.aerosol_layers)
    each = kinds.sum(axis=0)
    each[altitude > 120_000.0] = 0.0
    depth = np.trapezoid(each, along, axis=0)
    ours = -np.log(night_air(HAZE, height_m).through(np.sin(elevation)))
    assert ours == pytest.approx(depth, rel=0.035, abs=2e-3)


@pytest.mark.parametrize("height_m", [10_000.0, 100_000.0, 400_000.0, 3.6e7])
def test_the_planet_hides_what_lies_below_its_horizon(height_m):
    seen = stars_seen(at_prague(), night_air(HAZE, height_m), height_m)
    elevation = np.arcsin(np.clip(seen.direction.values[:, 1], -1.0, 1.0))
    lowest = elevation.min() + dip_rad(height_m)
    # One star in a square degree: the lowest of a whole turn stands close to the horizon.
    assert 0.0 < lowest < np.radians(1.5 if height_m < 1e6 else 6.0)


def test_far_away_stars_have_all_of_the_catalogues_light():
    """Each where it stands without air; together the sum outside the atmosphere but for those that
    the planet hides."""
    height_m = 3.6e7
    at = at_prague()
    both = stars_at(at), planets_at(at)
    direction = np.concatenate([some.direction for some in both])
    light = np.concatenate([some.irradiance_rgb for some in both])
    seen = stars_seen(at, night_air(HAZE, height_m), height_m)
    beside_planet = np.degrees(np.arccos(np.clip(-direction[:, 1], -1.0, 1.0)))
    radius = np.degrees(np.arcsin(6.371e6 / (6.371e6 + height_m)))
    # Air bends light of stars just behind the planet around it: 1.13 deg on the ground.
    free, hidden = beside_planet > radius + 0.2, beside_planet < radius - 1.2
    total = seen.irradiance_rgb.values.sum(axis=0, dtype=float)
    assert (total > light[free].sum(axis=0) * (1.0 - 1e-6)).all()
    assert (total < light[~hidden].sum(axis=0) * (1.0 + 1e-6)).all()
    brightest = np.argsort(-light[:, 1] * free, kind="stable")[:100]
    np.testing.assert_allclose(seen.irradiance_rgb.values[:100], light[brightest], rtol=1e-6)
    np.testing.assert_allclose(seen.direction.values[:100], direction[brightest], atol=1e-6)


def test_the_moon_sets_behind_the_planet_and_not_at_the_level():
    """From 400 km it is whole 10 deg below the level, cut on the horizon, gone below it."""
    air = night_air(HAZE, 400_000.0)
    shown = {}
    for minute in range(0, 375, 3):
        instant = datetime(2026, 7, 1, 1, tzinfo=UTC) + timedelta(minutes=minute)
        seen = sight(instant, PRAGUE, 2.0, 400_000.0)
        over = np.degrees(np.arcsin(seen.moon.direction[1]) + dip_rad(400_000.0))
        disc = seen.disc(air, "test")
        shown[over] = len(moon_samples(disc)[0])
    over, count = np.array(sorted(shown.items())).T
    assert count[over > 0.3].min() == count.max()
    assert count[over < -0.3].max() == 0
    assert over.max() > 10.0


def test_the_lower_limb_is_behind_more_air():
    """Each place of a moon on the horizon from 100 km has the air of its own height."""
    eye_m, places = 100_000.0, []
    air = night_air(HAZE, eye_m)
    for minute in range(0, 40, 2):
        instant = datetime(2026, 7, 1, 4, 20, tzinfo=UTC) + timedelta(minutes=minute)
        seen = sight(instant, PRAGUE, 2.0, eye_m)
        disc = seen.disc(air, "test")
        through = np.reshape(disc.through_rgb, (-1, 3))
        assert (np.diff(through, axis=0) >= 0.0).all()
        middle = air.through(np.array(seen.moon.direction[1]))
        np.testing.assert_allclose(through[4], middle, atol=1e-3)
        places.append(through[[0, -1], 1])
    low, high = np.array(places).T
    assert ((high > 0.6) & (low < 0.35)).any()


def test_an_eye_that_climbs_is_told_other_stars_without_other_light():
    kernel = Kernel()
    kernel.add_module(NightSky)
    posted = []
    kernel.tap(lambda message, _: posted.append(type(message).__name__))
    wanted = StarsChanged.__name__, MoonDiscChanged.__name__, "BackgroundChanged"
    for message in (
        PRAGUE, SetClock(instant=NIGHT), *(Demand(consumer="test", message=k) for k in wanted)
    ):  # fmt: skip
        kernel.inject(message)
    kernel.pump_until_idle()
    on_ground = kernel.last(StarsChanged)
    posted.clear()
    for height_m, told in ((1.7, False), (9000.0, True), (9010.0, False), (1.7, True)):
        eye_m, target_m = (0.0, height_m, 0.0), (0.0, height_m, -1.0)
        kernel.inject(MoveCamera(eye_m=eye_m, target_m=target_m))
        kernel.pump_until_idle()
        assert ("StarsChanged" in posted) == told
        assert "NightLightChanged" not in posted
        if height_m == 9000.0:
            aloft = kernel.last(StarsChanged)
            assert aloft.direction.values[:, 1].min() < -np.sin(np.radians(1.5))
            assert len(aloft.direction.values) > len(on_ground.direction.values)
        posted.clear()
    assert kernel.last(StarsChanged) == on_ground
    kernel.close()
