"""Closed loops of lamps: bounds, targets, and least power against two other ways to find it."""

import itertools

import numpy as np
import pytest
from daylight_numbers.lamps.closed_loops import ClosedLoops
from daylight_numbers.lamps.lighting_controls import power_share
from hypothesis import given, settings
from hypothesis import strategies as st

from vrut_lite.messages.lighting import LightingControl

TARGET = 500.0


def loops_of(lux, least, target=TARGET, extra=0.05):
    """Groups with power at the least output that is `extra` above its light's share."""
    count = len(lux)
    control = LightingControl(
        "closed_loop", target, min_dimming=least, min_power=min(least + extra, 1.0)
    )
    return ClosedLoops((control,) * count, 100.0 - 13.0 * np.arange(count), np.array(lux))


def power_of(loops, output):
    """Power (T,) in W of outputs (G, T)."""
    shares = [power_share(c, o) for c, o in zip(loops.controls, output, strict=True)]
    return loops.watts @ np.array(shares)


@st.composite
def cases(draw, count=None):
    """Lux between groups, daylight of their zones, least output."""
    count = draw(st.integers(1, 3)) if count is None else count
    numbers = st.floats(20.0, 600.0)
    lux = [draw(st.lists(numbers, min_size=count, max_size=count)) for _ in range(count)]
    day = draw(st.lists(st.floats(0.0, 700.0), min_size=count, max_size=count))
    return np.array(lux), np.array(day)[:, None], draw(st.floats(0.0, 0.6))


@settings(max_examples=60, deadline=None)
@given(cases())
def test_output_is_off_or_in_bounds_and_meets_the_target_where_lamps_can(case):
    """A zone that all lamps leave too dark is as bright as they make it."""
    lux, day, least = case
    output = loops_of(lux, least).output(day, np.ones(day.shape, bool))
    assert np.all((output == 0.0) | ((output >= least) & (output <= 1.0)))
    reachable = np.minimum(TARGET, day[:, 0] + lux.sum(axis=1))
    assert np.all(day[:, 0] + lux @ output[:, 0] >= reachable * (1.0 - 1e-6))


@settings(max_examples=25, deadline=None)
@given(cases(count=2))
def test_no_outputs_of_a_fine_grid_have_less_power(case):
    lux, day, least = case
    loops = loops_of(lux, least)
    found = power_of(loops, loops.output(day, np.ones(day.shape, bool)))[0]
    levels = [0.0, *np.linspace(max(least, 1e-9), 1.0, 60)]
    pairs = np.array(list(itertools.product(levels, repeat=2))).T
    reachable = np.minimum(TARGET, day + lux.sum(axis=1)[:, None])
    meet = np.all(day + lux @ pairs >= reachable, axis=0)
    assert found <= power_of(loops, pairs)[meet].min() + 1e-3


@settings(max_examples=25, deadline=None)
@given(cases(count=3))
def test_the_best_vertex_is_the_mixed_integer_programs_optimum(case):
    """HiGHS finds no less power, nor more."""
    lux, day, least = case
    loops = loops_of(lux, least)
    used = np.ones(day.shape, bool)
    missing = np.clip(1.0 - day[:, 0] / TARGET, 0.0, (lux / TARGET).sum(axis=1))
    program = loops.by_program(lux / TARGET, missing, used[:, 0])[:, None]
    ours = power_of(loops, loops.output(day, used))
    np.testing.assert_allclose(ours, power_of(loops, program), rtol=1e-4, atol=2e-3)


@settings(max_examples=25, deadline=None)
@given(cases(), st.floats(1.01, 1.5))
def test_power_rises_with_the_target(case, times):
    lux, day, least = case
    used = np.ones(day.shape, bool)
    low, high = loops_of(lux, least), loops_of(lux, least, times * TARGET)
    power = [power_of(loops, loops.output(day, used))[0] for loops in (low, high)]
    assert power[0] <= power[1] + 1e-3


def test_rows_of_six_groups_are_solved_time_by_time():
    """Rows in light of each other, the sixth by the window: in the dark all reach 500 lx with less
    than full power, and by daylight the last is off."""
    near = np.abs(np.subtract.outer(np.arange(6), np.arange(6)))
    loops = loops_of(400.0 * 0.45**near, 0.1)
    day = np.array([[0.0] * 6, [0.0, 20.0, 50.0, 100.0, 300.0, 800.0]]).T
    output = loops.output(day, np.ones((6, 2), bool))
    assert np.all(day + loops.lux @ output >= TARGET * (1.0 - 1e-6))
    assert power_of(loops, output)[0] < loops.watts.sum()
    assert output[5, 1] == 0.0


def test_rooms_apart_are_solved_apart():
    """Six groups in three rooms have what each room has alone."""
    lux = np.kron(np.eye(3), [[450.0, 80.0], [80.0, 450.0]])
    day = np.array([0.0, 200.0, 50.0, 400.0, 600.0, 600.0])[:, None]
    loops = loops_of(lux, 0.1)
    found = loops.output(day, np.ones((6, 1), bool))
    for first in (0, 2, 4):
        room = slice(first, first + 2)
        alone = ClosedLoops(loops.controls[room], loops.watts[room], loops.lux[room, room])
        expected = alone.output(day[room], np.ones((2, 1), bool))
        np.testing.assert_allclose(found[room], expected)


def test_zones_that_nobody_uses_have_no_light():
    loops = loops_of([[100.0, 10.0], [10.0, 100.0]], 0.1)
    found = loops.output(np.zeros((2, 1)), np.array([[True], [False]]))
    np.testing.assert_allclose(found, [[1.0], [0.0]])


@pytest.mark.parametrize("least", [0.0, 1.0])
def test_lamps_without_a_range_are_switched(least):
    """Least output 1: on and off; least output 0: any output."""
    loops = loops_of([[600.0]], least, extra=0.0)
    output = loops.output(np.array([[0.0, 350.0, 550.0]]), np.ones((1, 3), bool))[0]
    expected = [1.0, 1.0, 0.0] if least else [500.0 / 600.0, 0.25, 0.0]
    np.testing.assert_allclose(output, expected)
