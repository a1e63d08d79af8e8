"""Controls of lamps against hand-computed days."""

import numpy as np
import pytest
from daylight_numbers.lamps.closed_loops import ClosedLoops
from daylight_numbers.lamps.lighting_controls import (
    by_hour,
    dimmed_by_photosensor,
    lit_minutes,
    occupied_minutes,
    power_share,
)

from vrut_lite.messages.lighting import LightingControl

TARGET, PEAK = 500.0, 1000.0


def sine_day(hours):
    """Daylight from 6 to 18 h."""
    return PEAK * np.sin(np.pi * (hours - 6.0) / 12.0).clip(0.0)


def test_a_closed_loop_has_the_energy_of_a_sine_shaped_day():
    """Lamps of 1 kW and 600 lx, least output 0: from 6 to 18 h they fill T - E where E < T, the
    integral of (T - P sin) / L, by hand; steps of 10 minutes are within 0.5 %."""
    lamps_lx = 600.0
    control = LightingControl("closed_loop", TARGET, min_dimming=0.0, min_power=0.0)
    hours = (np.arange(72) + 0.5) / 6.0 + 6.0
    loop = ClosedLoops((control,), np.array([1000.0]), np.array([[lamps_lx]]))
    output = loop.output(sine_day(hours)[None], np.ones((1, 72), bool))[0]
    energy = power_share(control, output).sum() / 6.0
    crossing = 12.0 / np.pi * np.arcsin(TARGET / PEAK)
    by_hand = 2.0 * (
        TARGET * crossing - PEAK * 12.0 / np.pi * (1.0 - np.cos(np.pi * crossing / 12.0))
    )
    assert energy == pytest.approx(by_hand / lamps_lx, rel=5e-3)


def test_an_open_loop_has_the_energy_of_a_sine_shaped_day():
    """Output 1 - (1 - m) E / D down to m: here D is the peak, so that it is linear all day and its
    integral 12 (1 - (1 - m) 2 / pi) h."""
    control = LightingControl("open_loop", TARGET, min_dimming=0.2, min_power=0.2, dark_at_lx=PEAK)
    hours = (np.arange(72) + 0.5) / 6.0 + 6.0
    output = dimmed_by_photosensor(control, sine_day(hours))
    assert output.min() >= 0.2
    energy = power_share(control, output).sum() / 6.0
    assert energy == pytest.approx(12.0 * (1.0 - 0.8 * 2.0 / np.pi), rel=5e-3)


@pytest.mark.parametrize("delay", [0, 10, 45])
def test_on_off_goes_at_the_very_minute(delay):
    """Daylight rises by 100 lx an hour from 7:30 and falls from 15:30: it has 500 lx at 12:30. Of a
    target of 400 lx it has enough from 11:30 to 13:30."""
    lux = np.zeros(48)
    lux[7:13] = 100.0 * np.arange(6)
    lux[13:19] = lux[7:13][::-1] - 100.0
    lux = lux.clip(0.0)
    control = LightingControl("on_off", 400.0, delay_min=delay)
    lit = lit_minutes(control, lux)
    on = np.flatnonzero(np.diff(lit.astype(int))) + 1
    assert on[:4].tolist() == [8 * 60, 11 * 60 + 30 + delay, 13 * 60 + 30, 18 * 60]
    assert lit[24 * 60 : 48 * 60].sum() == 600


def test_hours_of_occupation_go_over_midnight_and_leave_out_weekends():
    """18 to 2 h, an apartment's, all 365 days; 1 January 2025 is a Wednesday."""
    night = by_hour(occupied_minutes(LightingControl(occupied_h=(18.0, 2.0)), 365))
    assert night.sum() == 365 * 8
    assert (night[:24] > 0).nonzero()[0].tolist() == [0, 1, 18, 19, 20, 21, 22, 23]
    work = by_hour(occupied_minutes(LightingControl(weekdays_only=True, occupied_h=(8, 17.5)), 365))
    assert work.sum() == 261 * 9.5
    assert work[3 * 24 : 5 * 24].sum() == 0.0
    assert work[17] == 0.5


def test_power_is_linear_from_the_least_output_on():
    control = LightingControl(min_dimming=0.1, min_power=0.2)
    found = power_share(control, np.array([0.0, 0.1, 0.55, 1.0]))
    np.testing.assert_allclose(found, [0.0, 0.2, 0.6, 1.0])
    assert power_share(LightingControl(min_dimming=1.0), np.array([1.0])) == 1.0
