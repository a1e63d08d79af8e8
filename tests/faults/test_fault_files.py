"""Pipes, devices, damaged and vanishing files: one line each."""

import os
import subprocess
import sys
import zipfile
from pathlib import Path

import numpy as np
import pytest
from dynamic_skylight import data_files
from dynamic_skylight.hosek_wilkie import coefficients
from dynamic_skylight.twilight_table import twilight_table
from fault_stage import NOON, ROOT, SMALL_SKY

from vrut_lite.errors import UserError
from vrut_lite.interrupts import Terminated
from vrut_lite.pictures.write_exr import write_exr
from vrut_lite.pictures.write_hdr import write_hdr
from vrut_lite.pictures.write_json import write_json
from vrut_lite.pictures.write_npz import write_npz

SCENE = ROOT / "scenes" / "sundial.glb"


def make(kind, path):
    """Put something other than a regular file at a path."""
    if kind == "pipe":
        os.mkfifo(path)
    elif kind == "folder":
        path.mkdir()
    elif kind == "endless":
        path.symlink_to("/dev/zero")
    elif kind == "loop":
        path.symlink_to(path)


KINDS = ["pipe", "folder", "endless", "loop", "missing"]


@pytest.mark.parametrize("kind", KINDS)
def test_a_project_that_is_not_a_file(refused, tmp_path, kind):
    """Pipes, devices and folders are refused without waiting."""
    make(kind, tmp_path / "day.toml")
    line = refused("render", tmp_path / "day.toml", "-o", tmp_path / "a.png", *NOON)
    assert "cannot open the project" in line


@pytest.mark.parametrize("kind", KINDS)
def test_a_journal_that_is_not_a_file(refused, tmp_path, kind):
    """Likewise."""
    make(kind, tmp_path / "day.mcap")
    assert "cannot open the journal" in refused("replay", tmp_path / "day.mcap")


@pytest.mark.parametrize("kind", KINDS)
def test_a_scene_that_is_not_a_file(refused, tmp_path, kind):
    """Likewise."""
    make(kind, tmp_path / "scene.glb")
    line = refused("render", tmp_path / "scene.glb", "-o", tmp_path / "a.png", *NOON)
    assert "cannot open the scene" in line


@pytest.mark.parametrize(
    "content",
    [
        b"",
        b"\x00" * 100,
        b"\xff\xfe" + os.urandom(200),
        b"x = " + b"[" * 50_000,
        b'scene = "a.glb"\n' * 2,
        b'scene = "' + b"a" * 100_000 + b'.glb"',
        b'scene = "\\u0000.glb"',
        b"scene = 3",
        b'scene = "a.glb"\nsize = [1e400, 5]',
    ],
    ids=["empty", "zeros", "noise", "deep", "twice", "long", "nul", "number", "infinite"],
)
def test_a_project_of_garbage(refused, tmp_path, content):
    """Files that are not TOML, or not a project, are refused."""
    path = tmp_path / "day.toml"
    path.write_bytes(content)
    refused("render", path, "-o", tmp_path / "a.png", *NOON)
    assert [file.name for file in tmp_path.iterdir()] == ["day.toml"]


DAMAGE = {
    "nothing": b"",
    "cut": (ROOT / "modules/dynamic_skylight/data/hosek_wilkie.npz").read_bytes()[:5000],
    "noise": b"PK\x03\x04" + bytes(300),
    "text": b"no arrays here",
}


@pytest.mark.parametrize("damage", [*DAMAGE, "missing"])
def test_damaged_coefficients(refused, tmp_path, monkeypatch, damage):
    """Damaged package data end in a sentence that says what to do."""
    (tmp_path / "data").mkdir()
    if damage != "missing":
        for name in ("hosek_wilkie.npz", "twilight.npz"):
            (tmp_path / "data" / name).write_bytes(DAMAGE[damage])
    monkeypatch.setattr(data_files, "files", lambda package: tmp_path)
    tables = (coefficients.tables, twilight_table)
    for table in tables:
        table.cache_clear()
    try:
        line = refused(*SMALL_SKY, "-o", tmp_path / "sky.exr", code=1)
        assert "hosek_wilkie.npz is missing or damaged" in line
        with pytest.raises(RuntimeError, match=r"twilight\.npz is missing or damaged"):
            twilight_table()
    finally:
        for table in tables:
            table.cache_clear()
    assert not (tmp_path / "sky.exr").exists()


RADIANCE = np.ones((4, 4, 3), np.float32)
WRITERS = {
    ".exr": lambda path: write_exr(path, RADIANCE, {}),
    ".hdr": lambda path: write_hdr(path, RADIANCE, {}),
    ".json": lambda path: write_json(path, {}),
}


@pytest.mark.parametrize("suffix", WRITERS)
@pytest.mark.parametrize("place", ["folder that is gone", "/proc", "/dev/full/x"])
def test_an_unusable_output_folder_is_named(tmp_path, suffix, place):
    """A folder that has vanished or takes no files: a sentence with its name."""
    folder = tmp_path / place
    with pytest.raises(UserError, match="cannot write") as refusal:
        WRITERS[suffix](folder / f"sky{suffix}")
    assert "\n" not in str(refusal.value)
    assert not list(tmp_path.rglob("*"))


ODD_NAMES = ["two words", "Šumava – ráno ☀", "line\nbreak", "-o", "%d", "'\""]


@pytest.mark.parametrize("name", [f"{name}.npz" for name in ODD_NAMES])
def test_odd_names(done, tmp_path, name):
    """Names with spaces, other scripts, quotes and line breaks are used exactly."""
    folder = tmp_path / "á b"
    folder.mkdir()
    done(*SMALL_SKY, "-o", folder / name)
    assert [file.name for file in folder.iterdir()] == [name]


def test_a_name_with_undecodable_bytes(done, tmp_path):
    """A file name that is not UTF-8 is used as it is."""
    name = os.fsdecode(b"sky-\xff\xfe.npz")
    done(*SMALL_SKY, "-o", tmp_path / name)
    assert [os.fsencode(file.name) for file in tmp_path.iterdir()] == [b"sky-\xff\xfe.npz"]


def test_a_removed_working_folder_is_named(refused, tmp_path, monkeypatch):
    """The working folder was removed: a relative output is refused."""
    gone = tmp_path / "gone"
    gone.mkdir()
    before = Path.cwd()
    os.chdir(gone)
    try:
        gone.rmdir()
        line = refused(*SMALL_SKY, "-o", "sky.exr")
    finally:
        os.chdir(before)
    assert "cannot write sky.exr" in line


def test_an_unwritable_working_folder_is_named_before_the_work(refused, monkeypatch):
    """In /proc a relative output is refused; an absolute one elsewhere is written."""
    monkeypatch.chdir("/proc")
    assert "cannot write sky.exr" in refused(*SMALL_SKY, "-o", "sky.exr")


def test_commands_run_in_a_folder_without_write_access(done, tmp_path, monkeypatch):
    """Commands need no write access to the working folder."""
    monkeypatch.chdir("/proc")
    done(*SMALL_SKY, "-o", tmp_path / "sky.exr")
    assert (tmp_path / "sky.exr").exists()


@pytest.mark.parametrize("full_at_bytes", [50, 8192])
def test_an_npz_on_a_full_disk_ends_in_one_sentence(full_at_bytes):
    """The disk may be full when the file is closed, and no archive may complain when collected."""
    done = subprocess.run(
        [sys.executable, "-c", _WRITES_NPZ, str(full_at_bytes)], capture_output=True, text=True
    )
    assert done.stdout.strip().startswith("UserError: cannot write")
    assert done.stderr == ""


# A limit of a file's size stands for the disk: it too refuses what a buffer holds.
_WRITES_NPZ = """
import resource, signal, sys, tempfile
import numpy as np
from vrut_lite.pictures.write_npz import write_npz
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
resource.setrlimit(resource.RLIMIT_FSIZE, (int(sys.argv[1]), resource.RLIM_INFINITY))
with tempfile.TemporaryDirectory() as folder:
    try:
        write_npz(f"{folder}/sky.npz", {"sky": np.random.default_rng(1).random(1_500)})
    except Exception as error:
        print(f"{type(error).__name__}: {error}")
"""


def test_an_interrupt_between_members_of_an_npz_is_not_replaced(tmp_path, monkeypatch):
    """zipfile refuses to close an archive with a member half begun: the interrupt must get out."""

    def interrupted(*_arguments):
        raise Terminated

    path = tmp_path / "sky.npz"
    path.write_bytes(b"older")
    monkeypatch.setattr(zipfile, "_ZipWriteFile", interrupted)
    with pytest.raises(Terminated):
        write_npz(path, {"sky": np.ones(3)})
    assert path.read_bytes() == b"older"
    assert list(tmp_path.iterdir()) == [path]
