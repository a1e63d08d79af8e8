"""The desktop's menu, icon and project type are written and removed whole."""

import configparser
import os
import shutil
import subprocess
import sys
import xml.etree.ElementTree as ElementTree
from importlib.util import find_spec
from pathlib import Path

import pytest
from click.testing import CliRunner

from vrut_lite import desktop_entry
from vrut_lite.commands.desktop import desktop
from vrut_lite.errors import UserError

needs_qt = pytest.mark.skipif(find_spec("PySide6") is None, reason="the package PySide6 is missing")


@pytest.fixture
def data(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The user's data folder; the program lies in a folder whose name needs quotes."""
    program = tmp_path / 'my "100 %" $programs' / "vrut-lite"
    program.parent.mkdir()
    program.write_text("#!/bin/sh\n")
    program.chmod(0o755)
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path / "data"))
    monkeypatch.setattr(sys, "argv", [str(program)])
    return tmp_path / "data"


def entry(data: Path) -> configparser.SectionProxy:
    parser = configparser.RawConfigParser(delimiters=("=",))
    parser.optionxform = str  # type: ignore[assignment, method-assign]
    parser.read(data / "applications" / "vrut-lite.desktop", encoding="utf-8")
    return parser["Desktop Entry"]


@needs_qt
def test_what_is_installed_is_removed(data: Path) -> None:
    """Also the files that the desktop's programs made of them say nothing of it any more."""
    said = CliRunner().invoke(desktop, ["--install"]).output.splitlines()
    assert len(said) == 5
    assert all(Path(line).is_file() for line in said)
    again = CliRunner().invoke(desktop, ["--install"])
    assert again.exit_code == 0
    removed = CliRunner().invoke(desktop, ["--remove"]).output.splitlines()
    assert sorted(removed) == sorted(said)
    left = [path for path in data.rglob("*") if path.is_file()]
    assert not [path for path in left if "vrut" in path.read_text(errors="replace")]
    assert "nothing to remove" in CliRunner().invoke(desktop, ["--remove"]).output


@needs_qt
def test_the_entry_starts_this_program_with_a_file(data: Path) -> None:
    """Quotes, percent signs and dollars of its path are escaped twice, as the format has it."""
    desktop_entry.install_entry()
    read = entry(data)
    program = read["Exec"].removesuffix(" run %f").replace("\\\\", "\\").replace("%%", "%")
    assert program.startswith('"')
    # A shell reads the quotes by the same rule.
    seen = subprocess.run(["sh", "-c", f"printf %s {program}"], capture_output=True, text=True)
    assert seen.stdout == sys.argv[0]
    assert read["Icon"] == "vrut-lite"
    assert "%f" in read["Exec"]


@needs_qt
@pytest.mark.skipif(
    shutil.which("desktop-file-validate") is None,
    reason="the package desktop-file-utils is missing",
)
def test_the_entry_is_valid(data: Path) -> None:
    """freedesktop's own program finds no fault."""
    desktop_entry.install_entry()
    file = data / "applications" / "vrut-lite.desktop"
    done = subprocess.run(["desktop-file-validate", file], capture_output=True, text=True)
    assert (done.returncode, done.stdout) == (0, "")


@needs_qt
def test_the_type_takes_no_other_toml(data: Path) -> None:
    """Other programs' settings are TOML too."""
    desktop_entry.install_entry()
    tree = ElementTree.parse(data / "mime" / "packages" / "vrut-lite.xml")
    space = "{http://www.freedesktop.org/standards/shared-mime-info}"
    assert [glob.get("pattern") for glob in tree.iter(f"{space}glob")] == ["*.vrut.toml"]
    kind = next(tree.iter(f"{space}mime-type")).get("type")
    assert f"{kind};" in entry(data)["MimeType"]


@needs_qt
@pytest.mark.skipif(
    shutil.which("update-mime-database") is None, reason="the package shared-mime-info is missing"
)
def test_the_desktop_knows_a_project_by_its_name(data: Path) -> None:
    """By the database that freedesktop's own program makes."""
    desktop_entry.install_entry()
    globs = (data / "mime" / "globs2").read_text()
    assert f"60:{desktop_entry.PROJECT_TYPE}:*.vrut.toml" in globs


@needs_qt
def test_a_folder_that_takes_no_files_is_named(data: Path) -> None:
    """The sentence names the folder; a relative XDG_DATA_HOME is invalid and not used."""
    data.parent.joinpath("data").write_text("a file")
    with pytest.raises(UserError, match=f"cannot make the folder {data}"):
        desktop_entry.install_entry()


def test_a_relative_data_folder_is_not_used(data: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The Base Directory Specification calls it invalid."""
    monkeypatch.setenv("XDG_DATA_HOME", "data")
    monkeypatch.setenv("HOME", str(data.parent / "home"))
    monkeypatch.chdir(data.parent)
    assert desktop_entry.remove_entry() == []
    assert desktop_entry._data_folder() == data.parent / "home" / ".local" / "share"
    assert os.listdir(data.parent) == [Path(sys.argv[0]).parent.name]


def test_one_of_both_must_be_chosen(data: Path) -> None:
    """The bare command changes nothing."""
    with pytest.raises(UserError, match="choose --install or --remove"):
        CliRunner().invoke(desktop, [], catch_exceptions=False)
    assert not data.exists()
