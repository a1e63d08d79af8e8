"""A bug report's lines: what decides whether something works, and nobody's name."""

import platform
import re
from pathlib import Path

import pytest
from click.testing import CliRunner

from vrut_lite import __version__
from vrut_lite.about import about_text
from vrut_lite.commands.about import about


def test_versions_machine_graphics_and_folders_are_in_it() -> None:
    """Who reads it need not ask back."""
    text = about_text("llvmpipe, OpenGL 4.5")
    for line in (
        rf"vrut_lite {re.escape(__version__)}, a checkout, in ",
        rf"Python {re.escape(platform.python_version())}",
        r"system: .+ \d+ cores",
        "graphics: llvmpipe, OpenGL 4.5",
        r"numpy \d",
        r"numba \d",
        "PySide6-Essentials ",
        "settings: ",
        "cache: ",
        "last session: ",
        "licence: MIT, LICENSE, ",
    ):
        assert re.search(f"^{line}", text, re.MULTILINE), line


def test_the_home_folder_is_not_named(monkeypatch: pytest.MonkeyPatch) -> None:
    """Its name is often a person's."""
    home = Path("/home/jana.novakova")
    monkeypatch.setenv("HOME", str(home))
    for name in ("CACHE", "CONFIG", "STATE"):
        monkeypatch.setenv(f"XDG_{name}_HOME", str(home / name))
    text = about_text("none")
    assert "jana" not in text
    assert "cache: ~/CACHE/vrut_lite" in text


@pytest.mark.gl
def test_the_command_names_the_renderer() -> None:
    """Without a window too: a renderer, and its driver's version."""
    said = CliRunner().invoke(about, []).output
    assert re.search(r"^graphics: .+, OpenGL \d\.\d", said, re.MULTILINE)
