"""Faults of the machine: GL, output streams, time zones, signals during the work."""

import os
import signal
import subprocess
import sys
import tempfile
import zoneinfo
from pathlib import Path

import moderngl
import numpy as np
import pytest
from fault_stage import NOON, ROOT, SMALL_SKY, is_one_line, outcome, start, wait_for
from processes_here import processes_or_skip

from vrut_lite import cli
from vrut_lite.environment_checks import leave_out_nonsense
from vrut_lite.errors import UserError
from vrut_lite.interrupts import Terminated, terminations_raised
from vrut_lite.render import frame, gl_environment, gl_owner
from vrut_lite.write_atomic import atomic_output

SCENE = ROOT / "scenes" / "sundial.glb"
RENDER = ["render", SCENE, *NOON, "--size", "32x32"]


@pytest.fixture
def aborting_driver(tmp_path_factory, monkeypatch):
    """The process that tries OpenGL ends as under a broken driver; no earlier one is known."""
    caches = gl_environment.begin_probe.cache_clear, gl_environment.probe_gl.cache_clear
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path_factory.mktemp("cache")))
    monkeypatch.setattr(gl_environment, "_PROBE", "import os; os.abort()")
    for clear in caches:
        clear()
    yield
    for clear in caches:
        clear()


def test_a_driver_that_aborts(refused, tmp_path, aborting_driver):
    """The line says so and names what to install; no picture, and this process goes on."""
    line = refused(*RENDER, "-o", tmp_path / "a.png")
    assert "ended the probe (-6)" in line
    assert "libegl1" in line
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("library", ["moderngl", "PyOpenGL"])
@pytest.mark.gl
def test_gl_lost_during_a_frame(refused, tmp_path, monkeypatch, library):
    """The driver fails whenever a frame is drawn, in each context: one line, no picture."""
    # Imported only after the environment for EGL is prepared.
    from OpenGL.error import GLError

    error = GLError(err=1287) if library == "PyOpenGL" else moderngl.Error("context lost")

    def lost(*_arguments, **_named):
        raise error

    monkeypatch.setattr(frame.Frame, "draw", lost)
    line = refused(*RENDER, "-o", tmp_path / "a.png")
    said = "the graphics driver failed" if library == "PyOpenGL" else "OpenGL failed"
    assert said in line
    assert not list(tmp_path.iterdir())


def test_the_sky_needs_no_gl(done, tmp_path, monkeypatch):
    """`sky` works on a machine without a GL driver."""
    monkeypatch.setattr(gl_owner, "probe_gl", lambda: ("", "none"))
    done(*SMALL_SKY, "-o", tmp_path / "sky.npz")
    assert (tmp_path / "sky.npz").exists()


class NoZones(zoneinfo.ZoneInfo):
    """A machine without time zone data."""

    def __new__(cls, key):
        raise zoneinfo.ZoneInfoNotFoundError(f"No time zone found with key {key}")


def test_without_time_zone_data(refused, tmp_path, monkeypatch):
    """The line names the time zone and the package to install."""
    monkeypatch.setattr("vrut_lite.place_time.ZoneInfo", NoZones)
    at = ["--at", "2026-06-21T12:00", "--place", "50,14"]
    line = refused("sky", *at, "--size", "16", "-o", tmp_path / "sky.npz")
    assert "Europe/Prague" in line
    assert "tzdata" in line


def test_no_folder_for_temporary_files(done, tmp_path, monkeypatch):
    """A missing TMPDIR does not matter."""
    monkeypatch.setenv("TMPDIR", "/nowhere")
    monkeypatch.setattr(tempfile, "tempdir", None)
    done(*SMALL_SKY, "-o", tmp_path / "sky.npz")
    assert (tmp_path / "sky.npz").exists()


def test_no_memory(refused, tmp_path, monkeypatch):
    """Out of memory: the line says what to ask for instead."""

    def exhausted(*_arguments, **_named):
        raise MemoryError

    monkeypatch.setattr("vrut_lite.studio.sky_pictures.open_kernel", exhausted)
    assert "smaller" in refused(*SMALL_SKY, "-o", tmp_path / "sky.npz", code=1)


@pytest.mark.parametrize("stream", ["stdout", "stdin", "stderr"])
def test_a_stream_that_is_closed(tmp_path, stream, monkeypatch):
    """With any of the three standard streams closed the picture is written."""
    monkeypatch.setattr(sys, "argv", ["vrut-lite", *SMALL_SKY, "-o", str(tmp_path / "sky.npz")])
    monkeypatch.setattr(sys, stream, None)
    cli.main()
    assert (tmp_path / "sky.npz").exists()


def test_a_closed_reader_of_the_output():
    """`vrut-lite modules | head -0`: no traceback, no complaint at the end."""
    read, write = os.pipe()
    process = start("modules", stdout=write)
    os.close(read)
    os.close(write)
    code, _, complaints = outcome(process)
    assert complaints == ""
    assert code == 1


def test_the_output_is_full():
    """Output to a full disk: one line, no traceback at the end."""
    with open("/dev/full", "w") as full:
        process = start("modules", stdout=full)
        code, _, complaints = outcome(process)
    assert code == 1
    assert "no space left" in is_one_line(complaints).lower()


ODD = {
    "LC_ALL": "xx_YY",
    "PYTHONIOENCODING": "ascii",
    "OMP_NUM_THREADS": "many",
    "OPENBLAS_NUM_THREADS": "-3",
    "NUMBA_NUM_THREADS": "0",
    "NUMBA_CPU_FEATURES": "fast",
    "SOURCE_DATE_EPOCH": "today",
    "COLUMNS": "0",
    "TZ": "Nowhere/Nothing",
    "DISPLAY": ":99",
}


@pytest.mark.long
def test_odd_variables(tmp_path):
    """An unknown locale, ASCII output and invalid numbers in the environment do not matter."""
    path = tmp_path / "ráno.npz"
    code, said, complaints = outcome(start(*SMALL_SKY, "-o", path, environment=ODD))
    assert code == 0, complaints
    assert "Traceback" not in complaints
    assert "sun 61" in said
    assert np.load(path)[np.load(path).files[0]].size > 0


@pytest.mark.parametrize(
    ("name", "nonsense", "sound"),
    [
        ("NUMBA_NUM_THREADS", ["0", "-1", "abc", "1e3", "1.5", "", "10" * 9, "٣", "1_0"], "3"),
        ("NUMBA_CPU_FEATURES", ["fast", "avx2", "+avx2,", ",", "+", "\n"], "+avx2,-fma"),
        ("NUMBA_COLOR_SCHEME", ["pink", "0"], "no_color"),
        ("SOURCE_DATE_EPOCH", ["today", "", "-", "1e9", "9" * 5000], "1700000000"),
    ],
)
def test_invalid_environment_variables_are_removed(monkeypatch, name, nonsense, sound):
    """Invalid values, which end in tracebacks or an abort, are removed; valid ones are kept."""
    for value in nonsense:
        monkeypatch.setenv(name, value)
        leave_out_nonsense()
        assert name not in os.environ, value
    monkeypatch.setenv(name, sound)
    leave_out_nonsense()
    assert os.environ[name] == sound
    monkeypatch.delenv(name)
    leave_out_nonsense()
    assert name not in os.environ


@pytest.mark.parametrize("kind", ["missing", "file", "long", "loop"])
@pytest.mark.parametrize("command", ["sky", "modules"])
def test_mistyped_folders_of_modules(refused, monkeypatch, tmp_path, kind, command):
    """Every command ends with one sentence that names the folder and the variable."""
    (tmp_path / "file").write_text("")
    (tmp_path / "loop").symlink_to(tmp_path / "loop")
    folder = tmp_path / ("x" * 300 if kind == "long" else kind)
    monkeypatch.setenv("VRUT_LITE_MODULES", str(folder))
    line = refused(command, *(["-o", tmp_path / "a.exr"] if command == "sky" else []))
    assert f"no folder of modules {folder}" in line
    assert "VRUT_LITE_MODULES" in line


# Delays the renaming of pictures only, because numba renames files too.
SLOW_WRITE = """
import os, time
def slow(beside, target, replace=os.replace):
    if ".unfinished-" in str(beside):
        time.sleep(300)
    replace(beside, target)
os.replace = slow
"""


def partial_files(folder):
    """Those that hold something: an empty one stands there while the folder is tried."""

    def size(file):
        try:
            return file.stat().st_size
        except FileNotFoundError:
            return 0

    return [file for file in folder.glob(".unfinished-*") if size(file)]


@pytest.mark.parametrize(
    ("number", "code"),
    [(signal.SIGTERM, 143), pytest.param(signal.SIGINT, 130, marks=pytest.mark.long)],
)
def test_a_signal_during_a_write_keeps_the_older_picture(tmp_path, number, code):
    """After SIGTERM or Ctrl-C during a write the older picture stays, and no partial file."""
    path = tmp_path / "sky.npz"
    path.write_bytes(b"older")
    process = start(*SMALL_SKY, "-o", path, setting=SLOW_WRITE)
    wait_for(lambda: partial_files(tmp_path), process)
    process.send_signal(number)
    ended, _, complaints = outcome(process)
    assert ended == code, complaints
    is_one_line(complaints)
    assert path.read_bytes() == b"older"
    assert list(tmp_path.iterdir()) == [path]


def test_kill_9_during_a_write_keeps_the_older_picture(tmp_path):
    """After kill -9 the older picture is whole; the partial file's name shows what it is."""
    path = tmp_path / "sky.npz"
    path.write_bytes(b"older")
    process = start(*SMALL_SKY, "-o", path, setting=SLOW_WRITE)
    wait_for(lambda: partial_files(tmp_path), process)
    process.kill()
    process.communicate()
    assert path.read_bytes() == b"older"
    (beside,) = (other for other in tmp_path.iterdir() if other != path)
    assert beside.name.startswith(".unfinished-")


WORKERS = """
import os, sys, time
from pathlib import Path
from vrut_lite.studio.workers import workers_of

def work(folder, number):
    (Path(folder) / str(os.getpid())).touch()
    time.sleep(600)

if __name__ == "__main__":
    with workers_of(2, None, 2) as workers:
        list(workers.map(work, [sys.argv[1]] * 2, range(2)))
"""


def test_workers_end_with_their_parent_process(tmp_path):
    """After kill -9 of the command its worker processes end too."""
    processes_or_skip()
    script, folder = tmp_path / "script.py", tmp_path / "pids"
    script.write_text(WORKERS)
    folder.mkdir()
    process = subprocess.Popen([sys.executable, script, folder], cwd=ROOT)
    wait_for(lambda: len(list(folder.iterdir())) == 2, process)
    workers = [int(path.name) for path in folder.iterdir()]
    process.kill()
    process.communicate()
    wait_for(lambda: not any(map(is_running, workers)))


def is_running(pid):
    """Whether a process is running, neither ended nor a zombie."""
    try:
        state = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0]
    except FileNotFoundError:
        return False
    return state != "Z"


def test_a_request_to_end_is_an_exception(tmp_path):
    """It is raised once, the unfinished file is removed, and the old handler is restored."""
    before = signal.getsignal(signal.SIGTERM)
    path = tmp_path / "a.bin"

    def work():
        with terminations_raised(), atomic_output(path) as beside:
            beside.write_bytes(b"half")
            os.kill(os.getpid(), signal.SIGTERM)

    with pytest.raises(Terminated):
        work()
    assert not list(tmp_path.iterdir())
    assert signal.getsignal(signal.SIGTERM) == before


def test_a_folder_removed_during_the_work_is_named(tmp_path):
    """If the output folder is removed during the work, one sentence names it."""
    folder = tmp_path / "out"
    folder.mkdir()

    def work():
        with atomic_output(folder / "a.bin") as beside:
            folder.rmdir()
            beside.write_bytes(b"half")

    with pytest.raises(UserError, match="cannot write"):
        work()


@pytest.mark.gl
@pytest.mark.parametrize(
    ("environment", "words"),
    [
        ({"MESA_GL_VERSION_OVERRIDE": "4.1"}, ("has OpenGL 4.1", "vrut-lite sky")),
        (
            {"MESA_GL_VERSION_OVERRIDE": "4.3", "MESA_EXTENSION_OVERRIDE": "-GL_ARB_clip_control"},
            ("has no clip control", "vrut-lite sky"),
        ),
        ({"VRUT_LITE_GPU": "no such card"}, ("VRUT_LITE_GPU", "'no such card'", "there are 0: ")),
        ({"VRUT_LITE_GPU": "99"}, ("VRUT_LITE_GPU", "'99'", "there are 0: ")),
        ({"__EGL_VENDOR_LIBRARY_FILENAMES": "/none"}, ("no device answers", "libegl1")),
    ],
)
def test_an_old_driver_and_a_card_that_is_not_there(tmp_path, environment, words):
    """One line says what is missing and what works without; Mesa itself plays the driver."""
    path = tmp_path / "a.png"
    code, said, complaints = outcome(start(*RENDER, "-o", path, environment=environment))
    assert (code, said, complaints.count("\n")) == (2, "", 1)
    assert all(each in complaints for each in words), complaints
    assert not path.exists()


@pytest.mark.gl
def test_a_picture_without_graphics_memory(refused, tmp_path):
    """The line names the size, and no picture is written."""
    if not gl_environment.probe_gl()[0].startswith("llvmpipe"):
        pytest.skip("a card may have room for it")
    line = refused(*RENDER, "--size", "16384x16384", "-o", tmp_path / "a.png")
    assert "no graphics memory for a picture of 16384 x 16384" in line
    assert not list(tmp_path.iterdir())


@pytest.mark.gl
def test_a_card_is_chosen_by_a_part_of_its_name(tmp_path):
    """Here the software renderer, the one device that every Mesa has."""
    environment = {"VRUT_LITE_GPU": "LLVMpipe"}
    path = tmp_path / "a.png"
    code, _, complaints = outcome(start(*RENDER, "-o", path, environment=environment))
    assert (code, complaints) == (0, "")
    assert path.exists()
