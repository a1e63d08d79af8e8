"""Legend and lines of pictures in false colours."""

import numpy as np
import pytest

from vrut_lite.geometry.false_colours import (
    UNUSED,
    Scale,
    coloured,
    iso_lines,
    round_levels,
    scale_of,
)
from vrut_lite.pictures.value_picture import value_pixels, values_of


def test_the_legend_spans_the_values_and_what_has_none_is_grey():
    """Darkest and brightest colour are the ends of the scale."""
    scale = scale_of(np.geomspace(1.0, 100.0, 101))
    assert scale.low == pytest.approx(1.0, rel=0.1)
    assert scale.at(0.5) == pytest.approx(10.0, rel=0.01)
    pixels = coloured(np.array([scale.low, scale.high, np.nan, 0.0]), scale)
    assert pixels.tolist() == [[68, 1, 84], [253, 231, 37], list(UNUSED), list(UNUSED)]


def test_a_picture_of_nothing_has_no_legend():
    """Where no surface is seen there is no scale to draw."""
    nothing = np.full((200, 300), np.nan, np.float32)
    assert (value_pixels(values_of(nothing, "illuminance")) == UNUSED).all()


def test_iso_lines_are_where_round_values_are_passed():
    """Of values that double from column to column: a line a round value, none beside the wall."""
    values = np.tile(2.0 ** np.arange(8), (4, 1))
    values[:, 5] = np.nan
    levels = round_levels(Scale(1.0, 128.0))
    assert levels[0] > 1.0
    assert len(levels) <= 6
    line = iso_lines(values, levels)
    assert (line == line[0]).all()
    assert (line[0, [0, 5, 6]] == -1).all()
    for column in (1, 2, 3, 4, 7):
        if line[0, column] >= 0:
            assert values[0, column - 1] <= levels[line[0, column]] < values[0, column]
    assert (iso_lines(values, levels, steepest=1.5) == -1).all()
