"""Where no window can be opened: one line, which names the way that is left."""

import ctypes
import os
import subprocess
import sys

import pytest
from click.testing import CliRunner
from system_libraries import LIBRARIES

from vrut_lite.app import desktop
from vrut_lite.app.desktop import PACKAGES, objection, require_desktop
from vrut_lite.commands.run import run
from vrut_lite.errors import UserError


def test_without_a_display_the_headless_way_is_named(monkeypatch):
    """Qt would abort the process: it is never asked."""
    for name in ("DISPLAY", "WAYLAND_DISPLAY", "QT_QPA_PLATFORM"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setattr(subprocess, "Popen", None)
    result = CliRunner().invoke(run, [])
    assert isinstance(result.exception, UserError)
    assert "no display" in str(result.exception)
    assert "vrut-lite render" in str(result.exception)


def test_a_display_that_does_not_answer_is_told_by_name(monkeypatch):
    """Qt itself is asked, in a process that it may abort."""
    for library in LIBRARIES["x11"]:
        try:
            ctypes.CDLL(library)
        except OSError:
            pytest.skip(f"{library} is missing: install the system's packages {PACKAGES}")
    monkeypatch.setenv("DISPLAY", ":987")
    monkeypatch.delenv("WAYLAND_DISPLAY", raising=False)
    monkeypatch.delenv("QT_QPA_PLATFORM", raising=False)
    with pytest.raises(UserError, match="display :987 does not answer") as raised:
        require_desktop()
    assert "\n" not in str(raised.value)


def test_a_missing_library_is_named_with_the_packages_and_the_sky_without_it():
    """The loader's own words are read; `sky` needs no OpenGL (test_sky_without_opengl)."""
    with pytest.raises(OSError, match="cannot open") as raised:
        ctypes.CDLL("libEGL_that_is_not_there.so.1")
    line = objection(f"Traceback ...\nImportError: {raised.value}\n")
    assert line.startswith("Qt lacks libEGL_that_is_not_there.so.1: install the packages libegl1")
    assert "`vrut-lite sky -o PICTURE`" in line


def test_sky_without_opengl(tmp_path):
    """The picture that the line promises is drawn where no GL library can be loaded."""
    refuse = (
        "import ctypes.util, sys; ctypes.util.find_library = lambda name: None\n"
        "sys.modules['OpenGL'] = sys.modules['moderngl'] = sys.modules['PySide6'] = None\n"
        "from vrut_lite.cli import main; main()"
    )
    picture = tmp_path / "sky.png"
    options = ["sky", "-o", str(picture), "--size", "64"]
    done = subprocess.run(
        [sys.executable, "-c", refuse, *options], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    assert picture.stat().st_size > 1000


def test_without_qt_the_extra_is_named():
    """Who installed the plain package learns which extra brings the window."""
    line = objection("ModuleNotFoundError: No module named 'PySide6'")
    assert "pip install 'vrut-lite[app]'" in line


def test_what_qt_says_besides_is_passed_on():
    """The last line that it printed, or that it said nothing."""
    assert "(no luck today)" in objection("something\nno luck today\n")
    assert "it was ended" in objection("")


def test_where_windows_can_be_opened_nothing_is_said(monkeypatch):
    """Qt's platform without a screen needs no display."""
    monkeypatch.setenv("QT_QPA_PLATFORM", "offscreen")
    monkeypatch.setattr(desktop, "prepare_environment", lambda: None)
    called = []
    require_desktop(meanwhile=lambda: called.append("while Qt is tried"))
    assert called
    assert os.environ["QT_QPA_PLATFORM"] == "offscreen"
