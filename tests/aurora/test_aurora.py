"""The aurora: where it stands, how bright it is, that frame and numbers have the same light."""

from datetime import UTC, datetime, timedelta

import numpy as np
import pytest
from aurora.curtains import LINES, AuroraShown, line_colours, phases_at, radiance
from aurora.module import Aurora
from aurora.oval import aurora_over
from dynamic_skylight.module import DynamicSkyLight
from hypothesis import given
from hypothesis import strategies as st

from vrut_lite.geometry.colour import luminance
from vrut_lite.kernel.bus import Kernel
from vrut_lite.kernel.messages import Demand, EnableModule, Fault, SetClock, SetSetting
from vrut_lite.messages.place import SetPlace
from vrut_lite.messages.sky_light import SkyLightChanged
from vrut_lite.sky.sky_sum import SkySum

NIGHT = datetime(2026, 12, 9, 21, tzinfo=UTC)


def shown(**changes):
    """A band as wide as the sky, of even brightness at the zenith."""
    parts = {
        "poleward": (0.0, 0.0, -1.0), "edge_km": 100.0, "width_km": 300.0, "lean": 0.2,
        "kilorayleigh": 100.0, "haze": 0.0, "phases": phases_at(0.0), "source": "test",
    }  # fmt: skip
    return AuroraShown(**(parts | changes))


def over(latitude, longitude, kp=4.0, instant=NIGHT, **changes):
    place = SetPlace(latitude_deg=latitude, longitude_deg=longitude, **changes)
    return aurora_over(place, instant, kp, 0.1, "test")


def test_a_column_has_the_brightness_of_its_kilorayleighs():
    """Diffuse light alone, seen from below: each line's column is its share of the kR.

    The red line's tail above 400 km, 4 % of it, is cut off.
    """
    band = shown(edge_km=-5e4, width_km=1e5, lean=0.0)
    up = radiance(band, np.array([0.0, 1.0, 0.0]), 50.0)
    # 6 % of an arc's brightness, and no sheet near by.
    expected = 6.0 * line_colours().sum(axis=0)
    np.testing.assert_allclose(up, expected, rtol=0.04)


def test_the_green_line_of_100_kr_is_20_mcd():
    """Class III of the International Brightness Coefficient: 0.019 cd/m^2 by photometry alone."""
    photons = 100.0 * 1e13 / (4.0 * np.pi)
    watts = photons * 6.626e-34 * 2.998e8 / (LINES[0][0] * 1e-9)
    candelas = 683.0 * luminance(100.0 * line_colours()[0])
    assert candelas == pytest.approx(683.0 * watts * 0.998, rel=0.01)


@pytest.mark.parametrize(("kp", "edge_deg"), [(0, 66.5), (5, 56.3), (9, 48.1)])
def test_the_edge_at_midnight_is_noaas(kp, edge_deg):
    """A place on the edge has it overhead; its table is met to a tenth of a degree."""
    places = np.linspace(-180.0, 180.0, 721)
    nights = [over(60.0, place, kp) for place in places]
    midnight = max(nights, key=lambda found: found.kilorayleigh)
    from_pole = np.radians(places[nights.index(midnight)] + 72.68)
    high, low = np.sin(np.radians([60.0, 80.65])), np.cos(np.radians([60.0, 80.65]))
    magnetic = np.degrees(np.arcsin(high.prod() + low.prod() * np.cos(from_pole)))
    assert midnight.edge_km / 111.2 + magnetic == pytest.approx(edge_deg, abs=0.1)


def test_it_lies_north_in_the_north_and_south_in_the_south():
    """World axes: north is -Z, turned as the place is."""
    assert over(55.0, 10.0).poleward[2] < -0.9
    assert over(-45.0, 147.0).poleward[2] > 0.9
    turned = over(55.0, 10.0, north_offset_rad=0.5 * np.pi).poleward
    assert abs(turned[0]) > 0.9


def test_curtains_move_by_the_clock_and_come_back_with_it():
    """The same hour has the same curtains; seconds later they have moved a little."""
    later = over(60.0, 10.0, instant=NIGHT + timedelta(seconds=2))
    assert over(60.0, 10.0) == over(60.0, 10.0)
    moved = np.angle(np.exp(1j * np.subtract(later.phases, over(60.0, 10.0).phases)))
    assert 0.0 < np.abs(moved).max() < 0.2


@given(
    latitude=st.floats(-90, 90), longitude=st.floats(-180, 180), kp=st.floats(0, 9),
    eye_km=st.one_of(st.floats(0, 89), st.floats(91, 40_000)), seed=st.integers(0, 99),
)  # fmt: skip
def test_no_place_no_eye_gives_a_bad_number(latitude, longitude, kp, eye_km, seed):
    """Poles, date line, any Kp, from the ground to space: finite, never below 0."""
    directions = np.random.default_rng(seed).normal(size=(40, 3))
    directions[0] = [0.0, 1.0, 0.0]
    directions[1] = [1.0, 0.0, 0.0]
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    found = radiance(over(latitude, longitude, kp), directions, eye_km)
    assert np.isfinite(found).all()
    assert (found >= 0.0).all()


@pytest.fixture
def kernel():
    kernel = Kernel()
    for module in (DynamicSkyLight, Aurora, SkySum):
        kernel.add_module(module)
    kernel.inject(Demand(consumer="test", message="SkyLightChanged"))
    kernel.inject(Demand(consumer="test", message="SkyRadianceChanged"))
    kernel.inject(SetPlace(latitude_deg=60.0, longitude_deg=10.0), SetClock(instant=NIGHT))
    kernel.pump_until_idle()
    yield kernel
    kernel.close()


def act(kernel, *inputs):
    """Sends inputs; returns the light's message, and lux on level ground by the sky."""
    kernel.inject(*inputs)
    kernel.pump_until_idle()
    assert kernel.last(Fault) is None
    found = kernel.last(SkyLightChanged)
    up = found.ambient.irradiance_sh_rgb.values
    return found, 683.0 * float(luminance(np.maximum(up, 0.0)[0]))


def test_it_lights_the_ground_and_goes_with_its_setting_and_its_module(kernel):
    """Off by default; on, harmonics, cube and radiance have its light; off, all is as before."""
    before, dark = act(kernel)
    assert before.layers == ()
    strong = SetSetting(module="aurora", name="kp", value=6.0)
    on = SetSetting(module="aurora", name="on", value=True)
    lit, bright = act(kernel, strong, on)
    assert lit.layers == ("glow",)
    assert bright > 1.5 * dark
    cube = lit.background.cube.values.astype(float) * lit.background.radiance_scale
    clear = before.background.cube.values.astype(float) * before.background.radiance_scale
    assert cube.max() > 2.0 * clear.max()
    gone, again = act(kernel, SetSetting(module="aurora", name="on", value=False))
    assert gone.layers == ()
    assert again == dark
    act(kernel, on)
    gone, again = act(kernel, EnableModule(module="aurora", enabled=False))
    assert gone.layers == ()
    assert again == dark


def test_enabled_again_it_is_shown_again(kernel):
    """A module that is enabled again posts its aurora, though nothing else has changed."""
    act(kernel, SetSetting(module="aurora", name="on", value=True))
    shown = []
    kernel.tap(lambda message, _: shown.append(message))
    act(kernel, EnableModule(module="aurora", enabled=False))
    lit, _ = act(kernel, EnableModule(module="aurora"))
    assert sum(isinstance(message, AuroraShown) for message in shown) == 1
    assert lit.layers == ("glow",)


def test_by_day_it_is_outshone(kernel):
    """Nothing is computed, and the counters say so."""
    on = SetSetting(module="aurora", name="on", value=True)
    found, _ = act(kernel, SetClock(instant=NIGHT.replace(hour=11)), on)
    assert found.layers == ()
    counters = kernel.seats["aurora"].module.counters
    assert counters.skipped["aurora: outshone by the sun"] > 0
    assert counters.done["aurora"] == 0
