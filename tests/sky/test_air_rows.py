"""The zenith angles of the rows of a volume of air."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from vrut_lite.sky.air_rows import (
    BELOW_LEVEL_M,
    AirGrid,
    horizon_depth,
    row_heights,
    rows_below,
    rows_of,
)
from vrut_lite.sky.air_volume import node_rays, span_m

EARTH, OTHER = (6_360_000.0, 60_000.0), (1_200_000.0, 150_000.0)
ALTITUDES = st.sampled_from([0.0, 2.0, 300.0, 3000.0, 12e3, 59_999.0, 2e5, 4e8])
GRIDS = st.builds(
    lambda altitude_m, planet, reach_m, above, below: AirGrid(
        altitude_m, *planet, reach_m, above, below
    ),
    ALTITUDES,
    st.sampled_from([EARTH, OTHER]),
    st.floats(0.0, 8.0).map(lambda exponent: 10.0**exponent),
    st.integers(2, 40),
    st.integers(2, 30),
)


@given(GRIDS)
def test_rows_are_found_where_they_lie(grid: AirGrid) -> None:
    """Rows are monotone from the horizon up and down, and `rows_of` inverts `row_heights` within
    1e-4 of a row, the precision of a direction from far away."""
    heights = row_heights(grid)
    above, below = heights[: grid.rows_above], heights[grid.rows_above :]
    assert np.all(np.diff(above) > 0.0)
    assert np.all(np.diff(below) < 0.0)
    assert above[0] == below[0] == horizon_depth(grid)[0]
    assert below[-1] == 0.0
    row, is_below = rows_of(grid, below[1:])
    assert is_below.all()
    assert row == pytest.approx(grid.rows_above + np.arange(1, grid.rows_below), abs=1e-4)
    assert rows_of(grid, above)[0] == pytest.approx(np.arange(grid.rows_above), abs=1e-4)


@pytest.mark.parametrize("planet", [EARTH, OTHER])
@pytest.mark.parametrize("reach_m", [5e3, 4e4, 1.5e5, 1e6])
@pytest.mark.parametrize("altitude_m", [2.0, 300.0, 3000.0, 12e3])
def test_a_row_lies_at_the_kink_of_the_spans(
    altitude_m: float, reach_m: float, planet: tuple[float, float]
) -> None:
    """Between two rows all rays end at the same bound, reach or depth: across the kink linear
    interpolation would err by percents."""
    grid = AirGrid(altitude_m, *planet, reach_m, 32, 24)
    rays, radius = node_rays(grid, 2, 0.5), planet[0]
    mu, spans = rays.mu[32:], rays.span_m[32:]
    tangent_m = np.sqrt((altitude_m + BELOW_LEVEL_M) * (2 * radius + altitude_m - BELOW_LEVEL_M))
    bend_m = min(reach_m, float(tangent_m))
    if bend_m <= altitude_m + BELOW_LEVEL_M:
        # Every ray ends at the reach.
        assert rows_below(grid)[1:] == (0.5, 0.5)
        return
    row = round(rows_below(grid).moved_place * 23)
    assert spans[row] == pytest.approx(bend_m, rel=1e-4)
    # The next row toward the nadir ends at the depth.
    there = np.sqrt((radius + altitude_m) ** 2 + spans[row + 1] * (
        spans[row + 1] + 2.0 * (radius + altitude_m) * mu[row + 1]))  # fmt: skip
    assert there - radius == pytest.approx(-BELOW_LEVEL_M, abs=0.1)
    assert spans[row + 1] < bend_m
    between = span_m(grid, altitude_m, np.linspace(mu[0], mu[row], 50), np.full(50, True))
    assert np.all(between >= bend_m * (1.0 - 1e-6))


def test_rows_are_denser_toward_the_horizon_from_high_up() -> None:
    """From high up in the air rows of the first degree below the horizon are 0.3 degrees apart at
    most, where a hundred kilometres off a degree is 1.7 km of height (0.7 by d = x^2 alone); from
    the ground and from space d is x^2, except at the moved row."""
    for altitude_m, most_deg in ((12e3, 0.25), (3000.0, 0.3)):
        grid = AirGrid(altitude_m, *EARTH, 1.5e5, 32, 24)
        below = np.degrees(np.arcsin(row_heights(grid)[32:] - 1.0))
        near = below[below > below[0] - 1.0]
        assert len(near) > 3
        assert np.abs(np.diff(near)).max() < most_deg
    for altitude_m in (0.0, 3.6e7):
        assert rows_below(AirGrid(altitude_m, *EARTH, 1.5e5, 32, 24)).crowding == pytest.approx(
            1.0, abs=1e-5
        )
