"""The product needs nothing of Python that only Linux has, nor the encoding that Linux assumes."""

import ast
import json
import os
import re
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path
from shutil import which

import other_system
import pytest

from vrut_lite import file_lock, operating_system
from vrut_lite.compiling import pool
from vrut_lite.render import gl_choice

ROOT = Path(__file__).parents[1]
PACKAGES = ("vrut_lite", *sorted(path.parent.name for path in ROOT.glob("modules/*/__init__.py")))
# Names of packages of others that a module of ours may lack.
OPTIONAL = {"anywidget", "av", "IPython"}
TRACED = other_system.TRACED if find_spec("mitsuba") else ()


def contents(folder):
    """Files by name; of a journal what was heard, since its head names the C library."""
    files = {
        path.relative_to(folder).as_posix(): path.read_bytes()
        for path in folder.rglob("*")
        if path.is_file()
    }
    files.pop("day.mcap", None)
    return files


@pytest.mark.parametrize(
    ("system", "commands"),
    [
        ("win32", other_system.LIGHT),
        pytest.param("win32", other_system.HEAVY + TRACED, marks=pytest.mark.long),
        pytest.param(
            "darwin", other_system.LIGHT + other_system.HEAVY + TRACED, marks=pytest.mark.long
        ),
    ],
)
def test_without_what_only_linux_has_the_same_files_come_out(
    system, commands, tmp_path, monkeypatch
):
    """All of the product is imported; skies, numbers, journals and traced pictures are the same.

    Bytes are compared with those of this process, which lacks nothing.
    """
    for name in ("here", "there"):
        (tmp_path / name).mkdir()
    arguments = system, ",".join(PACKAGES), json.dumps(commands)
    script = str(ROOT / "tests" / "other_system.py")
    other = subprocess.Popen(
        [sys.executable, script, *arguments],
        cwd=tmp_path / "there",
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        encoding="utf-8",
    )
    monkeypatch.chdir(tmp_path / "here")
    monkeypatch.setattr(sys, "argv", [])
    other_system.run(commands)
    said, complaints = other.communicate()
    assert other.returncode == 0, complaints
    lacking = json.loads(said.splitlines()[-1])
    assert {each.partition(": ")[2] for each in lacking} <= OPTIONAL
    assert contents(tmp_path / "there") == contents(tmp_path / "here")
    if other_system.LIGHT[1] in commands:
        assert re.search("day.mcap: 10 inputs and .* are equal, compared by digest", said)


@pytest.mark.long
@pytest.mark.gl
@pytest.mark.skipif(which("xvfb-run") is None, reason="the package xvfb is missing")
def test_a_picture_by_the_librarys_own_way_to_opengl(tmp_path, monkeypatch):
    """GLX stands for WGL and CGL, which choose no device: the pixels are those by EGL."""
    picture = ("render", str(ROOT / "scenes" / "sundial.glb"), "-o", "dial.exr", "--size",
               "160x90", *other_system.DAY)  # fmt: skip
    for name in ("here", "there"):
        (tmp_path / name).mkdir()
    script = str(ROOT / "tests" / "other_system.py")
    subprocess.run(
        ["xvfb-run", "-a", sys.executable, script, "darwin", "", json.dumps([picture])],
        cwd=tmp_path / "there",
        env=os.environ | {"PYOPENGL_PLATFORM": "glx"},
        check=True,
    )
    monkeypatch.chdir(tmp_path / "here")
    monkeypatch.setattr(sys, "argv", [])
    other_system.run([picture])
    assert contents(tmp_path / "there") == contents(tmp_path / "here")


def test_what_is_taken_away_is_there_otherwise():
    """A misspelt name would take nothing away."""
    for system in other_system.LACKING.values():
        for module, names in system.items():
            if module != "modules":
                there = vars(__import__(module))
                missing = [name for name in names.split() if name not in there]
                assert len(missing) <= 3, (module, missing)


def files():
    """Python files of the product."""
    for folder in ("vrut_lite", "modules"):
        yield from sorted((ROOT / folder).rglob("*.py"))


def in_text_without_encoding(call):
    """Whether a call opens a text in the encoding of the machine, without saying so."""
    named = {keyword.arg: keyword.value for keyword in call.keywords}
    if "encoding" in named:
        return False
    name = call.func.attr if isinstance(call.func, ast.Attribute) else getattr(call.func, "id", "")
    texts = [value.value for value in call.args if isinstance(value, ast.Constant)]
    if name in ("run", "Popen", "check_output"):
        return "text" in named or "universal_newlines" in named
    if name == "read_text":
        return len(call.args) < 1
    if name == "write_text":
        return len(call.args) < 2
    if name == "makefile":
        return "b" not in str(texts)
    if name == "open" and isinstance(call.func, ast.Name):
        return not (len(texts) > 0 and "b" in str(texts[-1]))
    # A path's or a resource's, of which `with PLACE.open()` reads lines.
    if not named.keys() <= {"newline", "buffering"}:
        return False  # An archive's, or a film's.
    return name == "open" and any(re.fullmatch("[rwax+t]+", str(text)) for text in texts)


def test_texts_are_read_and_written_in_a_named_encoding():
    """Windows would take its own code page for them."""
    found = [
        f"{path.relative_to(ROOT)}:{node.lineno}"
        for path in files()
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(node, ast.Call) and in_text_without_encoding(node)
    ]
    assert not found


def test_the_name_of_the_system_is_asked_in_one_place():
    """A test can change it, and a reader finds what depends on it."""
    asked = r"sys\.platform|os\.name\b|platform\.system"
    found = [path.name for path in files() if re.search(asked, path.read_text(encoding="utf-8"))]
    assert found == ["operating_system.py"]


@pytest.mark.parametrize("system", ["win32", "darwin"])
def test_elsewhere_the_library_chooses_the_way_to_opengl(system, monkeypatch):
    """WGL and CGL know no EGL devices: one context is asked for, without a backend."""
    import moderngl

    asked = []

    def none_newer(**named):
        asked.append(named)
        raise ValueError("Requested OpenGL version 430, got version 410")

    monkeypatch.setattr(operating_system, "NAME", system)
    monkeypatch.setattr(moderngl, "create_context", none_newer)
    with pytest.raises(gl_choice.UserError) as refused:
        gl_choice.open_context()
    assert asked == [{"standalone": True, "require": version} for version in (430, 330)]
    said = str(refused.value)
    assert "EGL" not in said
    assert "libegl1" not in said
    assert "skies (`vrut-lite sky`), numbers (`vrut-lite daylight`) and the path tracer" in said
    assert ("macOS has none above 4.1" in said) == (system == "darwin")


class Bytes:
    """Locks as Windows has them: msvcrt's function on a table of its own."""

    LK_LOCK, LK_NBLCK = 1, 2

    def __init__(self):
        self.locked = set()

    def locking(self, handle, mode, count):
        """Lock so many bytes, or refuse."""
        key = os.fstat(handle).st_ino
        if key in self.locked:
            raise PermissionError(13, "Permission denied")
        self.locked.add(key)


def test_locks_by_bytes_and_none_at_all(tmp_path, monkeypatch):
    """Where the lock is taken, one who does not wait learns so; without locks too."""
    monkeypatch.setattr(file_lock, "_fcntl", None)
    with (tmp_path / "lock").open("wb") as file:
        with pytest.raises(OSError, match="no locks"):
            file_lock.lock_file(file.fileno(), wait=False)
        monkeypatch.setattr(file_lock, "_msvcrt", Bytes())
        file_lock.lock_file(file.fileno(), wait=False)
        with pytest.raises(BlockingIOError):
            file_lock.lock_file(file.fileno(), wait=False)


def test_kernels_are_compiled_by_processes_that_are_not_forked(monkeypatch):
    """Each is started by itself, has its orders by a pipe, and is gone at the end."""
    monkeypatch.setattr(operating_system, "NAME", "darwin")
    monkeypatch.delattr(os, "killpg")
    told = []
    kernels = pool.KernelPool(told.append, processes=1)
    gone = [pool.ListedKernel("vrut_lite.gone", f"_{k}", "[]") for k in range(3)]
    kernels.add([pool.KernelGroup("old", tuple(gone))])
    kernels.join()
    assert told[-1].done == told[-1].total == 3
    assert len(kernels._processes) == 1
    kernels.close()
    assert all(process.poll() is not None for process in kernels._processes)
