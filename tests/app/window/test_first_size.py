"""A first window on small and large screens."""

import pytest
from PySide6.QtCore import QRect

from vrut_lite.app.window.first_size import first_place


@pytest.mark.parametrize(
    "free",
    [
        QRect(0, 0, 1366, 768),
        QRect(0, 28, 1280, 692),
        QRect(1920, 0, 1600, 1000),
        QRect(0, 0, 800, 480),
    ],
)
def test_a_first_window_lies_inside_the_free_area_with_its_frame(free):
    """Otherwise the time bar and the status line would be below the screen's edge."""
    place = first_place(free)
    assert free.contains(place)
    assert place.top() - free.top() >= 24


def test_a_first_window_does_not_fill_a_large_screen():
    """A picture of 4K pixels takes seconds without a graphics card."""
    place = first_place(QRect(0, 0, 3840, 2160))
    assert (place.width(), place.height()) == (1600, 1000)


def test_a_window_may_be_narrower_than_900_points(shared_headless_window):
    """Half of a laptop's screen."""
    assert shared_headless_window.window.minimumSizeHint().width() < 900
