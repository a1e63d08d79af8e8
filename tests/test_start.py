"""What a start imports: only what it needs, so that it is quick."""

import subprocess
import sys
from importlib.metadata import EntryPoint
from pathlib import Path

import pytest

from vrut_lite import cli

STREET = Path(__file__).parents[1] / "scenes" / "street.toml"
HEAVY = ("numba", "OpenGL", "pyrender", "PySide6", "scipy", "trimesh", "networkx", "rich")


def imported_by(*arguments):
    """The full names of all that a command imports."""
    code = (
        "import atexit, sys\n"
        "from vrut_lite.cli import main\n"
        "atexit.register(lambda: print('\\n', *sys.modules))\n"
        f"sys.argv = ['vrut-lite', *{arguments!r}]\n"
        "main()"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    return set(done.stdout.splitlines()[-1].split())


@pytest.mark.parametrize("arguments", [("--help",), ("--version",)])
def test_help_imports_no_library_of_pictures(arguments):
    """The list of commands is read from their sources: neither they nor numpy are imported."""
    assert not imported_by(*arguments) & {*HEAVY, "numpy", "bruneton_sky"}


def test_modules_are_listed_without_their_libraries():
    """A module's file imports no library that only its work needs."""
    assert not imported_by("modules") & {*HEAVY, "mitsuba", "zenoh"}


def test_the_day_sky_imports_no_compiler():
    """numba costs a third of a second that only the fast cube map has use for."""
    code = "import dynamic_skylight, sys; sys.exit('numba' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


@pytest.mark.long
@pytest.mark.gl
def test_a_picture_needs_neither_scipy_nor_trimesh(tmp_path, monkeypatch):
    """They take most of a second to import; drawn again it needs no numba either."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    render = ("render", str(STREET), "-o", str(tmp_path / "street.png"), "--size", "64x36")
    found = imported_by(*render)
    assert {"numba", "OpenGL", "pyrender"} <= found
    assert not found & {"PySide6", "scipy.linalg", "scipy.sparse", "trimesh", "networkx", "rich"}
    assert "numba" not in imported_by(*render)


def test_help_of_a_damaged_command_still_lists_the_others(tmp_path, monkeypatch):
    """A command whose file cannot be read is listed by its name alone."""
    (tmp_path / "damaged.py").write_text("def (")
    monkeypatch.syspath_prepend(tmp_path)
    point = EntryPoint("damaged", "damaged:damaged", cli.GROUP)
    assert cli._described(point).help is None
