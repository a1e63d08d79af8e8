"""Caches: killed during a write, full disks, sharing, wrong dates. No corrupt data is loaded."""

import io
import logging
import os
import resource
import signal
import subprocess
import sys
import time
import tracemalloc
import zipfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest
from bruneton_sky import Atmosphere, TableSizes, precompute
from fault_stage import ROOT, SMALL_SKY, outcome, start
from long_parameters import mostly_long

from vrut_lite import __version__, array_cache, compiled_code
from vrut_lite.array_cache import ArrayCache
from vrut_lite.numba_compiler import CheckedCacheFile

RECIPE = ("anything", 1)
SIZES = TableSizes(
    transmittance_altitude=4, transmittance_mu=8, irradiance_altitude=2, irradiance_mu_s=4,
    altitude=4, mu=8, nu=2, mu_s=4,
)  # fmt: skip


def arrays(value=1.0):
    """Arrays of 16 MB, so that a write takes a while."""
    return {"scattering": np.full((2_000_000,), value)}


WRITER = """
import sys, numpy as np
from pathlib import Path
from vrut_lite.array_cache import ArrayCache
cache = ArrayCache(Path(sys.argv[1]))
for number in range(1000):
    cache.put(("anything", 1), {"scattering": np.full((2_000_000,), float(number))})
    print(number, flush=True)
"""


def test_kill_9_during_cache_writes(tmp_path):
    """Four writers are killed at random moments: the entry is absent, or whole and of one writer.

    Their leftovers are never read, and are removed after a day.
    """
    for attempt in range(4):
        writer = subprocess.Popen(
            [sys.executable, "-c", WRITER, tmp_path], stdout=subprocess.PIPE, cwd=ROOT
        )
        writer.stdout.readline()
        time.sleep(0.017 * attempt)
        writer.send_signal(signal.SIGKILL)
        writer.communicate()
        found = ArrayCache(tmp_path).get(RECIPE)
        assert found is not None
        assert np.ptp(found["scattering"]) == 0.0
    for part in tmp_path.glob("*.part"):
        os.utime(part, (0, 0))
    ArrayCache(tmp_path).put(RECIPE, arrays())
    assert [path.suffix for path in tmp_path.iterdir()] == [".arrays"]


def test_a_full_disk_keeps_the_older_tables(tmp_path, caplog):
    """A write fails half-way: one line, the older entry is whole, no partial file remains."""
    cache = ArrayCache(tmp_path)
    cache.put(RECIPE, arrays())
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    ignored = signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (1_000_000, before[1]))
    try:
        with caplog.at_level(logging.WARNING):
            cache.put(RECIPE, arrays(2.0))
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
        signal.signal(signal.SIGXFSZ, ignored)
    assert len(caplog.records) == 1
    assert "not kept" in caplog.text
    np.testing.assert_array_equal(cache.get(RECIPE)["scattering"], arrays()["scattering"])
    assert [path.suffix for path in tmp_path.iterdir()] == [".arrays"]


BUILDER = """
import sys
from pathlib import Path
import numpy as np
from bruneton_sky import Atmosphere, TableSizes, precompute
from vrut_lite.array_cache import ArrayCache
sizes = TableSizes(
    transmittance_altitude=4, transmittance_mu=8, irradiance_altitude=2, irradiance_mu_s=4,
    altitude=4, mu=8, nu=2, mu_s=4,
)
tables = precompute(
    Atmosphere.earth(), orders=2, sizes=sizes, cache=ArrayCache(Path(sys.argv[1]))
)
sys.stdout.buffer.write(np.ascontiguousarray(tables.scattering).tobytes())
"""


@pytest.mark.long
def test_two_processes_build_the_same_tables(tmp_path):
    """Two processes that write one cache both get the tables, and so does a later one."""
    line = [sys.executable, "-c", BUILDER, tmp_path]
    builders = [subprocess.Popen(line, stdout=subprocess.PIPE, cwd=ROOT) for _ in range(2)]
    made = [builder.communicate()[0] for builder in builders]
    assert [builder.returncode for builder in builders] == [0, 0]
    assert made[0] == made[1]
    shares = []
    cache = ArrayCache(tmp_path)
    later = precompute(Atmosphere.earth(), 2, sizes=SIZES, cache=cache, progress=shares.append)
    assert shares == [1.0]
    assert np.ascontiguousarray(later.scattering).tobytes() == made[0]
    assert [path.suffix for path in tmp_path.iterdir()] == [".arrays"]


@pytest.mark.parametrize("used_s", [-3.0 * 365 * 86_400, 0.0, 10.0 * 365 * 86_400])
def test_a_clock_jump_does_not_evict_the_newest_entry(tmp_path, used_s):
    """With entries dated far in the past or future the newest entry is kept."""
    small = {"a": np.zeros(1000)}
    cache = ArrayCache(tmp_path, limit_bytes=12_000)
    cache.put("older", small)
    for path in tmp_path.iterdir():
        os.utime(path, (time.time() + used_s,) * 2)
    part = tmp_path / "other.part"
    part.write_bytes(b"half")
    os.utime(part, (time.time() + used_s,) * 2)
    cache.put("newer", small)
    assert cache.get("newer") is not None
    assert cache.get("older") is None
    assert part.exists() == (used_s >= 0.0)


def test_a_file_removed_by_another_process_is_ignored(tmp_path, monkeypatch, caplog):
    """A file that vanishes after the folder was listed is ignored silently."""
    gone = tmp_path / "gone.arrays"
    listed = Path.glob

    def listing(folder, pattern):
        return [*listed(folder, pattern), gone]

    monkeypatch.setattr(Path, "glob", listing)
    cache = ArrayCache(tmp_path)
    with caplog.at_level(logging.WARNING):
        cache.put(RECIPE, {"a": np.zeros(3)})
    assert not caplog.records
    assert cache.get(RECIPE) is not None


@pytest.mark.parametrize("blocked", mostly_long(["a file", "no folder"], "a file".__eq__))
def test_the_sky_needs_no_home_folder(tmp_path, blocked):
    """If HOME is a file or missing, the sky is computed without a complaint."""
    home = tmp_path / "home"
    if blocked == "a file":
        home.write_text("not a folder")
    places = {"HOME": str(home), "XDG_CACHE_HOME": str(home / "c"), "XDG_CONFIG_HOME": str(home)}
    picture = tmp_path / "sky.npz"
    process = start(*SMALL_SKY, "--sky", "bruneton_sky", "-o", picture, environment=places)
    code, _, complaints = outcome(process)
    assert (code, complaints) == (0, "")
    assert picture.exists()


def test_numbas_cache_cannot_be_written(tmp_path, monkeypatch):
    """Without a temporary folder numba would refuse to compile. The folder is removed at the end.

    A small sky is enough, since it needs only a few of the eleven kernels.
    """
    monkeypatch.setattr(os, "access", lambda path, mode: False)
    monkeypatch.setattr(compiled_code.tempfile, "tempdir", str(tmp_path))
    monkeypatch.delenv("NUMBA_CACHE_DIR", raising=False)
    ends = []
    monkeypatch.setattr(compiled_code.atexit, "register", lambda *a, **k: ends.append((a, k)))
    compiled_code.find_room(__version__)
    folder = Path(os.environ["NUMBA_CACHE_DIR"])
    assert folder.is_dir()
    assert folder.parent == tmp_path
    ((remove, *arguments), named) = ends[0]
    remove(*arguments, **named)
    assert not folder.exists()


def test_a_folder_that_takes_files_is_used(tmp_path, monkeypatch):
    """The variable is not changed if the user's cache folder, or the named one, is writable."""
    monkeypatch.delenv("NUMBA_CACHE_DIR", raising=False)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    compiled_code.find_room(__version__)
    assert "NUMBA_CACHE_DIR" not in os.environ
    monkeypatch.setenv("XDG_CACHE_HOME", "/proc/none")
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path / "new" / "folder"))
    compiled_code.find_room(__version__)
    assert os.environ["NUMBA_CACHE_DIR"] == str(tmp_path / "new" / "folder")


NPY = b"\x93NUMPY\x01\x00"


def npz_of(header, content=b"", packed=zipfile.ZIP_STORED):
    """An archive of one array with this header."""
    body = (header + "\n").encode()
    archive = io.BytesIO()
    with zipfile.ZipFile(archive, "w", packed) as file:
        file.writestr("scattering.npy", NPY + len(body).to_bytes(2, "little") + body + content)
    return archive.getvalue()


HEADER = "{{'descr': '{}', 'fortran_order': False, 'shape': {}}}"
FORGED = {
    "a terabyte": npz_of(HEADER.format("<f8", "(1000000000000,)"), bytes(8)),
    "less than nothing": npz_of(HEADER.format("<f8", "(-1,)"), bytes(8)),
    "a bomb": npz_of(HEADER.format("<f8", "(4000000,)"), bytes(32_000_000), zipfile.ZIP_DEFLATED),
    "objects": npz_of(HEADER.format("|O", "(1,)"), bytes(8)),
    "texts": npz_of(HEADER.format("<U2", "(1,)"), bytes(8)),
    "no number": npz_of(HEADER.format("<f8", "(1,)"), np.array([np.nan]).tobytes()),
    "nested": npz_of("(" * 9000),
    "nothing": b"",
    "no archive": b"PK\x05\x06" + bytes(18),
    "noise": bytes(range(256)) * 8,
}


@pytest.mark.parametrize("forged", FORGED)
def test_forged_cache_entries_are_ignored(tmp_path, caplog, forged):
    """Entries with a correct digest and forged headers are refused before memory is taken."""
    cache = ArrayCache(tmp_path)
    cache.put(RECIPE, {"a": np.zeros(3)})
    (path,) = tmp_path.iterdir()
    content = FORGED[forged]
    path.write_bytes(array_cache._MAGIC + array_cache._digest(content) + content)
    tracemalloc.start()
    with caplog.at_level(logging.WARNING):
        found = cache.get(RECIPE)
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert found is None if forged != "no archive" else not found
    assert peak < 10_000_000
    cache.put(RECIPE, {"a": np.zeros(3)})
    assert cache.get(RECIPE) is not None


@pytest.mark.parametrize("kind", ["pipe", "folder", "endless", "loop", "large"])
def test_foreign_cache_entries_are_ignored(tmp_path, kind):
    """Pipes, devices and sparse files of a terabyte are not read."""
    cache = ArrayCache(tmp_path)
    cache.put(RECIPE, {"a": np.zeros(3)})
    (path,) = tmp_path.iterdir()
    path.unlink()
    if kind == "pipe":
        os.mkfifo(path)
    elif kind == "folder":
        path.mkdir()
    elif kind == "large":
        path.touch()
        os.truncate(path, 1 << 40)
    else:
        path.symlink_to({"endless": "/dev/zero", "loop": path}[kind])
    assert cache.get(RECIPE) is None


@pytest.mark.parametrize("suffix", ["nbi", "nbc"])
@pytest.mark.parametrize("damage", ["empty", "cut", "noise", "flipped", "a folder", "unpickled"])
def test_damaged_machine_code_is_compiled_again(tmp_path, suffix, damage):
    """numba alone would end in a traceback, or run code with flipped bits."""
    kernels = CheckedCacheFile(str(tmp_path), "kernels", (1.0, 10))
    kernels.save("float64", ("name", b"machine code" * 100))
    assert kernels.load("float64") == ("name", b"machine code" * 100)
    (path,) = tmp_path.glob(f"*.{suffix}")
    whole = path.read_bytes()
    flipped = bytearray(whole)
    flipped[len(whole) // 2] ^= 4
    contents = {
        "empty": b"", "cut": whole[: len(whole) // 2], "noise": bytes(range(256)),
        "flipped": bytes(flipped), "unpickled": whole[:-32],
    }  # fmt: skip
    if damage == "a folder":
        path.unlink()
        path.mkdir()
    else:
        path.write_bytes(contents[damage])
    assert kernels.load("float64") is None
    if damage != "a folder":
        kernels.save("float64", "compiled anew")
        assert kernels.load("float64") == "compiled anew"


def test_machine_code_that_is_saved_at_once_is_all_there(tmp_path):
    """Processes that save at the same time keep each other's entries of the index."""
    names = [f"float{number}" for number in range(96)]

    def save(part):
        for name in part:
            CheckedCacheFile(str(tmp_path), "kernels", (1.0, 10)).save(name, f"code of {name}")

    with ThreadPoolExecutor(8) as threads:
        list(threads.map(save, [names[i::8] for i in range(8)]))
    kernels = CheckedCacheFile(str(tmp_path), "kernels", (1.0, 10))
    assert [kernels.load(name) for name in names] == [f"code of {name}" for name in names]


CALLER = """
from kernels_here.{callee} import shift
from vrut_lite.njit import njit
@njit(cache=True)
def moved(value):
    return value + shift
"""


@pytest.mark.long
def test_a_kernel_is_compiled_again_when_what_it_is_made_of_changes(tmp_path):
    """A change in an imported file of constants compiles the kernel again."""
    package = tmp_path / "kernels_here"
    package.mkdir()
    (package / "__init__.py").touch()
    (package / "caller.py").write_text(CALLER.format(callee="between"))
    (package / "between.py").write_text("from kernels_here.source import shift\n")
    found = []
    for shift in (1, 2):
        (package / "source.py").write_text(f"shift = {shift}\n")
        code = "from kernels_here.caller import moved; print(moved(40))"
        own = {"PYTHONPATH": f"{tmp_path}:{ROOT}", "NUMBA_CACHE_DIR": str(tmp_path / "kernels")}
        environment = os.environ | own
        command = [sys.executable, "-B", "-c", code]
        made = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
        found.append(made.stdout.strip())
    assert found == ["41", "42"]
