"""The message inspector, by its own widgets: live messages, their causes, and journals."""

import pytest
from PySide6.QtWidgets import QFileDialog
from window_driver import NOON

from vrut_lite.app.engine.message_rows import MessageRow, open_journal, value_text
from vrut_lite.app.panels.message_table import MOST_LIVE, MessageModel
from vrut_lite.kernel.messages import ClockMoved, SetClock, SetSetting
from vrut_lite.kernel.module import Manifest, Module, handles


class Failing(Module):
    manifest = Manifest(name="failing", title="Failing", version="1")

    @handles(ClockMoved)
    def on_clock(self, message):
        raise ZeroDivisionError("on purpose")


def watching(window):
    """The window, with its messages in sight."""
    window.window.docks["messages"].show()
    window.settled()
    return window


@pytest.fixture
def driver(shared_headless_window):
    window = watching(shared_headless_window)
    inspector = window.panel("messages")
    inspector.filter.clear()
    window.click(inspector.clear)
    window.settled()
    return window


@pytest.fixture
def new_driver(headless_window):
    """A window whose journal begins with the test."""
    return watching(headless_window)


@pytest.fixture
def inspector(request):
    name = "new_driver" if "new_driver" in request.fixturenames else "driver"
    return request.getfixturevalue(name).panel("messages")


def types(inspector):
    return [row.type_name for row in inspector.table.messages.shown]


def set_clock(driver, minute):
    driver.session.send(SetClock(instant=NOON.replace(minute=minute)))
    driver.settled()


def tree_of(item):
    return {item.text(0): [tree_of(item.child(i)) for i in range(item.childCount())]}


def test_messages_come_as_they_are_delivered(driver, inspector):
    """The rows show sender and receivers in the kernel's order."""
    set_clock(driver, 1)
    driver.until(lambda: "AmbientChanged" in types(inspector))
    shown = types(inspector)
    assert shown[shown.index("SetClock") :][:3] == ["SetClock", "ClockMoved", "SunMoved"]
    rows = {row.type_name: row for row in inspector.table.messages.shown}
    assert rows["BackgroundChanged"].sender == "dynamic_skylight"
    assert "scene" in rows["BackgroundChanged"].receivers
    assert rows["SetClock"].is_input
    assert not rows["SunMoved"].is_input
    assert rows["SunMoved"].ms > 0.0


def test_a_filter_leaves_what_has_its_words(driver, inspector):
    """The filter searches type, sender and receivers in any case; an empty one shows all rows."""
    set_clock(driver, 2)
    driver.until(lambda: "AmbientChanged" in types(inspector))
    everything = types(inspector)
    driver.qtbot.keyClicks(inspector.filter, "changed DYNAMIC")
    assert "BackgroundChanged" in types(inspector)
    assert all(name.endswith("Changed") for name in types(inspector))
    inspector.filter.clear()
    assert types(inspector)[: len(everything)] == everything


def test_while_it_pauses_or_hides_nothing_is_watched(driver, inspector):
    """A pause costs the kernel nothing, and what went by meanwhile is not made up for."""
    set_clock(driver, 3)
    driver.until(lambda: "AmbientChanged" in types(inspector))
    driver.click(inspector.pause)
    driver.settled()
    driver.click(inspector.clear)
    driver.settled()
    assert types(inspector) == []
    set_clock(driver, 4)
    driver.settled()
    driver.click(inspector.pause)
    driver.settled()
    set_clock(driver, 5)
    driver.until(lambda: "SetClock" in types(inspector))
    assert types(inspector).count("SetClock") == 1
    driver.window.docks["messages"].hide()
    driver.settled()
    assert not driver.asked(lambda stage: inspector._watch.watching)


def test_what_was_seen_before_a_pause_or_a_clear_is_not_shown_after_it(driver, inspector):
    """Rows on their way when the user pauses are shown at once; those at a clear are gone."""
    set_clock(driver, 8)
    driver.click(inspector.pause)
    driver.until(lambda: "SetClock" in types(inspector))
    driver.click(inspector.pause)
    driver.settled()
    set_clock(driver, 9)
    driver.click(inspector.clear)
    driver.settled()
    set_clock(driver, 10)
    driver.until(lambda: "AmbientChanged" in types(inspector))
    assert types(inspector).count("SetClock") == 1


def test_what_caused_a_message_is_drawn_from_its_input_on(driver, inspector):
    """A new sky's cause is the hour's night light, whose cause is the clock, whose is the user."""
    set_clock(driver, 6)
    driver.until(lambda: "AmbientChanged" in types(inspector))
    rows = inspector.table.messages.shown
    inspector.table.go_to([r for r in rows if r.type_name == "BackgroundChanged"][-1].number)
    tree = tree_of(inspector.causes.topLevelItem(0))
    (clock,) = tree["SetClock"]
    (night,) = [branch for branch in clock["ClockMoved"] if "NightLightChanged" in branch]
    assert [next(iter(branch)) for branch in night["NightLightChanged"]][:3] == [
        "BackgroundChanged", "KeyLightChanged", "AmbientChanged",
    ]  # fmt: skip
    assert inspector.causes.currentItem().text(0) == "BackgroundChanged"
    fields = {
        inspector.content.topLevelItem(i).text(0): inspector.content.topLevelItem(i).text(1)
        for i in range(inspector.content.topLevelItemCount())
    }
    assert fields["cube"] == "float16 (6, 16, 16, 3)"
    inspector.causes.setCurrentItem(inspector.causes.topLevelItem(0))
    inspector.causes.itemActivated.emit(inspector.causes.topLevelItem(0), 0)
    assert inspector.content.topLevelItem(0).text(0) == "instant"


def test_a_faults_cause_is_found(new_driver, inspector):
    """The cause is the user's input whose transaction contains the fault."""
    driver = new_driver
    driver.asked(lambda stage: stage.kernel.add_module(Failing))
    set_clock(driver, 7)
    # The first comes with its welcome, before any input.
    driver.until(lambda: types(inspector).count("Fault") == 2)
    faults = [row for row in inspector.table.messages.shown if row.type_name == "Fault"]
    inspector.table.go_to(faults[-1].number)
    (clock,) = tree_of(inspector.causes.topLevelItem(0))["SetClock"]
    assert {"Fault": []} in clock["ClockMoved"]


def test_a_journal_is_saved_opened_and_stepped_through(
    new_driver, inspector, monkeypatch, tmp_path
):
    """Each step goes to the next input and what came of it; closed, live messages are back."""
    driver = new_driver
    path = str(tmp_path / "session.mcap")
    monkeypatch.setattr(QFileDialog, "getSaveFileName", lambda *_: (path, ""))
    monkeypatch.setattr(QFileDialog, "getOpenFileName", lambda *_: (path, ""))
    bar = inspector.journal
    set_clock(driver, 8)
    driver.session.send(SetSetting(module="clouds", name="base_m", value=900.0))
    driver.settled()
    driver.click(bar.save)
    driver.until(lambda: "session.mcap" in bar.recorded.text())
    driver.until(lambda: "SettingChanged" in types(inspector))
    live = types(inspector)
    driver.click(bar.open)
    driver.until(lambda: bar.is_open)
    rows = inspector.table.messages.rows
    inputs = [row.type_name for row in rows if row.is_input]
    stepped = []
    while bar.next.isEnabled():
        driver.click(bar.next)
        stepped.append(inspector.causes.topLevelItem(0).text(0))
    assert stepped == inputs
    assert [name for name in stepped if name.startswith("Set")][-2:] == ["SetClock", "SetSetting"]
    driver.click(bar.back)
    assert inspector.causes.topLevelItem(0).text(0) == inputs[-2]
    assert f"{len(inputs) - 1} of {len(inputs)}" in bar.name.text()
    driver.click(bar.close_journal)
    assert types(inspector)[: len(live)] == live
    assert not bar.next.isVisible()


def test_a_step_is_done_in_the_window_if_wished(new_driver, inspector, tmp_path):
    """A journal played by hand moves the clock of the window itself."""
    driver = new_driver
    path = str(tmp_path / "session.mcap")
    set_clock(driver, 9)
    driver.session.save_journal(path, lambda _: inspector.journal.open_from(path))
    driver.until(lambda: inspector.journal.is_open)
    set_clock(driver, 40)
    driver.click(inspector.journal.play)
    while inspector.journal.next.isEnabled():
        driver.click(inspector.journal.next)
        driver.settled()
    assert driver.session.last(ClockMoved).instant == NOON.replace(minute=9)


def test_a_file_that_is_no_journal_is_told(driver, inspector, tmp_path):
    """One line names the error, and the rows shown before stay."""
    file = tmp_path / "no.mcap"
    file.write_bytes(b"no journal")
    inspector.journal.open_from(str(file))
    driver.until(lambda: "no.mcap" in driver.window.news.text())
    assert not inspector.journal.is_open


# --- the parts, without a window -----------------------------------------------------------


def rows(*numbers):
    return [MessageRow(n, 0, "Tick", "host", True, (), None, ()) for n in numbers]


def test_the_oldest_messages_make_place(qtbot):
    """A window that is open for days holds no more than so many."""
    model = MessageModel(None)
    for first in range(0, 3 * MOST_LIVE, 100):
        model.append(rows(*range(first, first + 100)))
        assert model.rowCount() <= MOST_LIVE
    last = 3 * MOST_LIVE - 1
    assert model.row_of(last).number == last
    assert model.row_of(0) is None
    assert model.index_of(last).row() == model.rowCount() - 1


def test_live_messages_behind_a_journal_make_place_too(driver, inspector, tmp_path):
    """A journal left open while time plays must not gather live messages for ever."""
    path = str(tmp_path / "session.mcap")
    driver.session.save_journal(path, lambda _: inspector.journal.open_from(path))
    driver.until(lambda: inspector.journal.is_open)
    watch = driver.asked(lambda stage: inspector._watch)
    for first in range(10**6, 10**6 + 2 * MOST_LIVE, 4000):
        watch._seen.extend(rows(*range(first, first + 4000)))
        driver.until(lambda: not watch._seen)
        driver.settled()
    inspector.journal.leave()
    assert MOST_LIVE // 2 < inspector.table.messages.rowCount() <= MOST_LIVE


def test_values_take_one_short_line():
    """Arrays by type and shape, texts without their line breaks, and not all of a shader."""
    assert value_text({"$array": "ab", "dtype": "<f4", "shape": [25, 3]}) == "<f4 (25, 3)"
    assert value_text((0.1234567890, 2)) == "0.123457, 2"
    assert value_text("a\n  b") == "a b"
    assert len(value_text("x" * 1000)) < 200


def test_a_recorded_journal_reads_as_transactions():
    """In a recorded journal each message's cause is the input of its transaction."""
    from pathlib import Path

    journals = sorted((Path(__file__).parents[2] / "replays").glob("*.mcap"))
    opened = open_journal(journals[0])
    found = opened.rows
    assert [row.number for row in found if row.is_input] == list(opened.inputs)
    assert found[0].is_input
    for row in found:
        assert row.is_input == (row.cause == 0)
        assert row.cause == 0 or found[row.cause - 1].is_input
