"""The command `cache` lists the files on disk, and removes cached ones alone."""

import os
from pathlib import Path

import pytest
from click.testing import CliRunner

from vrut_lite.commands.cache import cache
from vrut_lite.errors import UserError
from vrut_lite.user_files import cached_kinds, clear_cache, size_text, tilde


@pytest.fixture
def folders(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A user's folders with a file of each kind, and one of somebody else's module."""
    for name in ("CACHE", "CONFIG", "STATE"):
        monkeypatch.setenv(f"XDG_{name}_HOME", str(tmp_path / name.lower()))
    cached = {
        "kernels/0.1.0/there_1/moving.moved-3.py311.nbi": 10,
        "kernels/0.0.9/there_1/moving.moved-3.py311.1.nbc": 2_000_000,
        "compiling.lock": 0,
        "first_skies/a.arrays": 30_000,
        "light_maps/b.arrays": 40,
        "still_light/c.arrays": 2,
        "layouts/d.arrays": 5,
        "time_zones/e.arrays": 6,
        "rain_radar/f.arrays": 7,
        "devices.json": 8,
    }
    for name, size in cached.items():
        file = tmp_path / "cache" / "vrut_lite" / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_bytes(bytes(size))
    session = tmp_path / "state" / "vrut_lite" / "session.toml"
    session.parent.mkdir(parents=True)
    session.write_bytes(bytes(3000))
    return tmp_path


def test_the_bare_command_lists_kinds_with_their_sizes(folders: Path) -> None:
    """The largest first; settings and session are named, since they are no cache."""
    said = CliRunner().invoke(cache, []).output
    lines = said.splitlines()
    assert lines[0].endswith(f"{folders / 'cache' / 'vrut_lite'}, 2.0 MB")
    assert lines[1].startswith("  kernels 2.0 MB, 3 files: compiled numerical code")
    assert lines[2].startswith("  skies 30 kB, 1 files")
    names = [line.split()[0] for line in lines[1:-2]]
    assert set(names) == {"kernels", "skies", "light", "layouts", "tables", "rain_radar", "machine"}
    assert lines[-1].startswith("last session:")
    assert lines[-1].endswith("1 files, 3 kB")


def test_a_kind_is_cleared_after_a_question(folders: Path) -> None:
    """Kernels of all versions go; a no keeps everything, and the session is never touched."""
    runner = CliRunner()
    refused = runner.invoke(cache, ["clear", "kernels"], input="n\n")
    assert refused.exit_code == 1
    assert "Remove kernels (2.0 MB)" in refused.output
    assert {kind.name for kind in cached_kinds()} >= {"kernels", "light"}
    agreed = runner.invoke(cache, ["clear", "kernels"], input="y\n")
    assert "2.0 MB are free" in agreed.output
    left = {kind.name for kind in cached_kinds()}
    assert left == {"skies", "light", "layouts", "tables", "rain_radar", "machine"}


def test_all_is_cleared_without_a_question_if_the_caller_agrees(folders: Path) -> None:
    """Scripts cannot answer."""
    CliRunner().invoke(cache, ["clear", "--yes"])
    assert cached_kinds() == []
    assert (folders / "state" / "vrut_lite" / "session.toml").is_file()
    assert "is empty" in CliRunner().invoke(cache, ["clear", "--yes"]).output


def test_a_kind_that_is_not_there_is_named_with_those_that_are(folders: Path) -> None:
    """A misspelt kind must not clear anything."""
    with pytest.raises(UserError, match="holds no 'kernel': it holds kernels, skies"):
        CliRunner().invoke(cache, ["clear", "kernel"], catch_exceptions=False)


def test_a_link_in_the_cache_is_removed_and_its_target_is_not(folders: Path) -> None:
    """A user may have moved a large folder to another disk."""
    elsewhere = folders / "other_disk"
    elsewhere.mkdir()
    (elsewhere / "kept").write_bytes(bytes(10))
    os.symlink(elsewhere, folders / "cache" / "vrut_lite" / "moved")
    clear_cache(cached_kinds())
    assert (elsewhere / "kept").is_file()


def test_sizes_and_paths_are_short(monkeypatch: pytest.MonkeyPatch) -> None:
    """A bug report names no home folder."""
    assert [size_text(size) for size in (0, 1500, 2_340_000, 5.1e9)] == [
        "0 kB", "2 kB", "2.3 MB", "5.1 GB",
    ]  # fmt: skip
    monkeypatch.setenv("HOME", "/home/visitor")
    assert tilde(Path("/home/visitor/.cache/vrut_lite")) == "~/.cache/vrut_lite"
    assert tilde(Path("/home/visitors")) == "/home/visitors"
