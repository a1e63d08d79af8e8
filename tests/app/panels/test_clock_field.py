"""The time of day as people type it."""

import pytest
from PySide6.QtCore import Qt, QTime

from vrut_lite.app.panels.clock_field import ClockField, time_of


@pytest.mark.parametrize(
    ("text", "hour", "minute", "second"),
    [
        ("8:30", 8, 30, 0), ("08:30:15", 8, 30, 15), ("8.30", 8, 30, 0), ("8h30", 8, 30, 0),
        ("0830", 8, 30, 0), ("2155", 21, 55, 0), ("830", 8, 30, 0), ("8", 8, 0, 0),
        (" 9 pm ", 21, 0, 0), ("9:15am", 9, 15, 0), ("12 am", 0, 0, 0), ("12:01 p.m.", 12, 1, 0),
        ("21 55", 21, 55, 0),
    ],
)  # fmt: skip
def test_times_are_read_as_people_write_them(text, hour, minute, second):
    """With and without marks, leading zeros and halves of the day."""
    assert time_of(text) == QTime(hour, minute, second)


@pytest.mark.parametrize("text", ["", "noonish", "25:00", "8:61", "13 pm", "8:3:2:1", "-1"])
def test_what_is_no_time_is_none(text):
    """A sentence follows, and the clock stays."""
    assert time_of(text) is None


@pytest.fixture
def field(qtbot):
    field = ClockField()
    qtbot.addWidget(field)
    field.typed, field.lines = [], []
    field.time_typed.connect(field.typed.append)
    field.refused.connect(field.lines.append)
    field.show_time(QTime(16, 0, 0))
    field.show()
    field.setFocus()
    return field


def test_an_hour_is_typed_over_all_that_was_there(field, qtbot):
    """Ctrl+A, 21:55, Enter: one hour is handed over, and none at each key."""
    qtbot.keyClick(field, Qt.Key.Key_A, Qt.KeyboardModifier.ControlModifier)
    # The clock plays on meanwhile.
    field.show_time(QTime(16, 10))
    qtbot.keyClicks(field, "21:55")
    field.show_time(QTime(16, 20))
    assert field.text() == "21:55"
    assert field.typed == []
    qtbot.keyClick(field, Qt.Key.Key_Return)
    assert field.typed == [QTime(21, 55)]
    assert field.text() == "21:55:00"


def test_what_was_typed_is_taken_back_or_refused(field, qtbot):
    """Escape hands nothing over; nonsense brings a sentence and the hour before."""
    field.selectAll()
    qtbot.keyClicks(field, "3")
    qtbot.keyClick(field, Qt.Key.Key_Escape)
    assert field.text() == "16:00:00"
    field.selectAll()
    qtbot.keyClicks(field, "tea")
    qtbot.keyClick(field, Qt.Key.Key_Return)
    assert field.text() == "16:00:00"
    assert field.typed == []
    assert "'tea'" in field.lines[0]


def test_arrows_step_what_the_cursor_is_in(field, qtbot):
    """Hours on the left, then minutes, then seconds."""
    for place, time in ((1, QTime(17, 0)), (4, QTime(17, 1)), (7, QTime(17, 1, 1))):
        field.setCursorPosition(place)
        qtbot.keyClick(field, Qt.Key.Key_Up)
        assert field.typed[-1] == time
