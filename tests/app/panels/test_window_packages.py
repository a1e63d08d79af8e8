"""Packages of modules in the Modules panel: installed, updated and removed by processes."""

import os
import sys
from pathlib import Path

import pytest
from foreign_packages import RAISING, ScratchEnvironment, on_path, put, wheel_of
from PySide6.QtWidgets import QFileDialog
from window_driver import HeadlessStage, WindowDriver

from vrut_lite.package_facts import packages_of_others

pytest.importorskip("pip")


@pytest.fixture
def environment(tmp_path, monkeypatch):
    """The window's processes are of an environment of the test's own, without an index."""
    environment = ScratchEnvironment(tmp_path / "environment")
    monkeypatch.setattr(sys, "executable", str(environment.python))
    monkeypatch.setenv("PIP_NO_INDEX", "1")
    return environment


@pytest.fixture
def bar(shared_headless_window):
    driver = shared_headless_window
    driver.window.docks["modules"].show()
    bar = driver.panel("modules").packages
    bar.choose(None)
    return bar


def done(driver, bar):
    """Wait until the step has ended."""
    driver.until(lambda: not bar.is_busy)


def answer(bar, text):
    """Click a button of the question."""
    question = bar.question
    (button,) = (b for b in question.buttons() if b.text().replace("&", "") == text)
    words = question.informativeText()
    button.click()
    return words


def test_a_wheel_is_installed_updated_and_removed_by_its_buttons(
    shared_headless_window, bar, environment, tmp_path, monkeypatch
):
    """The question shows name, author, licence, hash and rights; a refusal installs nothing."""
    driver = shared_headless_window
    first, second = (wheel_of(tmp_path, "rain", version=version) for version in ("1.0", "1.1"))
    for agree in ("Cancel", "Install"):
        bar.prepare_install(str(first))
        assert not bar.install.isEnabled()
        assert bar.progress.isVisible()
        done(driver, bar)
        words = answer(bar, agree)
        for part in ("rain 1.0", "Ada", "BSD-3-Clause", "runs with your rights", "SHA-256"):
            assert part in words
        assert bar.is_busy == (agree == "Install")
    done(driver, bar)
    assert bar.status.text() == "rain 1.0 is installed and loads: it runs from the next start"
    with on_path(environment.site):
        bar.choose(packages_of_others()["rain"])
    monkeypatch.setattr(QFileDialog, "getOpenFileName", lambda *_: (str(second), ""))
    bar.update_from_wheel.trigger()
    done(driver, bar)
    answer(bar, "Install")
    done(driver, bar)
    assert bar.status.text() == "rain 1.1 is updated and loads: it runs from the next start"
    with on_path(environment.site):
        bar.choose(packages_of_others()["rain"])
    driver.click(bar.remove)
    answer(bar, "Remove")
    done(driver, bar)
    assert bar.status.text() == "rain 1.1 is removed: it runs until the window closes"
    assert not list(environment.site.glob("rain*"))


# The build of a package that never ends; it notes its process.
ENDLESS = """
import os, pathlib, tempfile, time

pathlib.Path({note!r}).write_text(f"{{os.getpid()}}\\n{{tempfile.gettempdir()}}")
time.sleep(3600.0)
"""


def test_a_step_that_only_reads_is_cancelled_with_all_its_processes(
    shared_headless_window, bar, environment, tmp_path, monkeypatch
):
    """A package's build may take for ever; pip and the build end with the step."""
    # pip would look for setuptools on the index; 0 is how this variable says no.
    monkeypatch.setenv("PIP_NO_BUILD_ISOLATION", "0")
    driver, note = shared_headless_window, tmp_path / "note"
    package = tmp_path / "package"
    package.mkdir()
    (package / "setup.py").write_text(ENDLESS.format(note=str(note)))
    bar.prepare_install(str(package))
    driver.until(note.is_file)
    driver.until(bar.cancel.isVisible)
    driver.click(bar.cancel)
    done(driver, bar)
    assert bar.status.text() == "Cancelled: nothing is changed."
    assert not bar.cancel.isVisible()
    process, folder = note.read_text().split("\n")
    driver.until(lambda: not is_running(int(process)))
    # With the window's own folder for the step goes what pip has left.
    assert bar._folder.name in folder
    assert not list(environment.site.glob("*.dist-info"))


def is_running(process):
    """Whether a process of that number runs; one that has ended may wait for its parent."""
    try:
        os.kill(process, 0)
        return Path(f"/proc/{process}/stat").read_text().split()[2] != "Z"
    except (OSError, IndexError):
        return False


def test_a_question_breaks_only_words_that_are_too_long(bar):
    """A hash has places to break, names of modules stay whole."""
    bar._ask("Install?", [("Brings", "modules: glare_watch; panels: glare_watch")], "", "Yes", None)
    assert "panels: glare_watch<" in bar.question.informativeText()
    bar.question.close()


def test_a_refusal_is_a_sentence_in_the_panel(shared_headless_window, bar, environment, tmp_path):
    """A file that is none, a package for another version, one that does not load."""
    driver = shared_headless_window
    later = wheel_of(tmp_path, "later", requires=["vrut-lite>=99"])
    for what, reason in ((tmp_path / "no.whl", "there is no such file"), (later, ">=99")):
        bar.prepare_install(str(what))
        done(driver, bar)
        assert reason in bar.status.text()
    bar.prepare_install(str(wheel_of(tmp_path, "broken", RAISING)))
    done(driver, bar)
    answer(bar, "Install")
    done(driver, bar)
    assert "broken is installed and cannot be loaded" in bar.status.text()
    assert "ZeroDivisionError" in bar.status.text()
    assert bar.install.isEnabled()


def test_a_module_that_is_not_loaded_has_a_row_with_its_package(qtbot, tmp_path):
    """Version, author, licence, reason, and a button that removes it."""
    put(tmp_path / "site", "broken", RAISING)
    put(tmp_path / "site", "sound")
    with on_path(tmp_path / "site"):
        driver = WindowDriver(qtbot, HeadlessStage, tmp_path / "kept")
        driver.window.docks["modules"].show()
        manager = driver.panel("modules")
        driver.until(lambda: manager.list.topLevelItemCount() > 0)
        manager.choose("broken")
        assert manager.chosen == "broken"
        assert manager.list.currentItem().text(1) == "not loaded"
        assert manager.facts.text() == "Package: broken 1.0, by Ada, BSD-3-Clause"
        assert "ZeroDivisionError" in manager.status.text()
        assert manager.failures.text() == ""
        assert manager.packages.remove.isEnabled()
        assert not manager.restart.isEnabled()
        manager.choose("sound")
        assert "Package: sound 1.0, by Ada, BSD-3-Clause" in manager.facts.text()
        assert manager.restart.isEnabled()
        driver.close()


def test_a_module_says_what_it_posts_and_hears(shared_headless_window):
    """Seen in this session; our own packages cannot be removed one by one."""
    driver = shared_headless_window
    driver.window.docks["modules"].show()
    manager = driver.panel("modules")
    driver.until(lambda: manager.list.topLevelItemCount() > 0)
    manager.choose("scene")
    manager.choose("dynamic_skylight")
    driver.until(lambda: "sun moved" in manager.facts.text())
    posts, hears = manager.facts.text().splitlines()
    assert posts.startswith("Posts: ")
    assert "demand" not in posts
    assert "key light changed" in posts
    assert "clock moved" in hears
    # Authors of modules need the names of the types.
    assert "KeyLightChanged" in manager.facts.toolTip()
    assert not manager.packages.remove.isEnabled()
