"""Fixtures that several test folders share; skips GL tests where there is no GL."""

import gc
import math
import os
import signal
import sys
from collections import OrderedDict
from types import SimpleNamespace

import hypothesis
import pytest
from stateful_backend import StatefulBackend

from vrut_lite import compiled_code
from vrut_lite.render.gl_environment import probe_gl

# Tests set empty cache folders, in which each process would compile all its kernels.
compiled_code.share_kernels()

# pytest-qt ends the whole run where Qt cannot be loaded: pyproject.toml keeps it from loading
# itself, and it is loaded here where it can be.
try:
    import PySide6.QtWidgets  # noqa: F401

    pytest_plugins = ["pytestqt.plugin"]
    NO_QT = ""
except ImportError as error:
    NO_QT = str(error)


# Modules and collected tests stay to the end: the collector of garbage need not visit half a
# million objects again and again.
gc.disable()


def pytest_collection_finish():
    """From here on garbage is collected, among what the tests make."""
    gc.freeze()
    gc.enable()


def pytest_addoption(parser):
    """The long versions of tests that CI runs short."""
    parser.addoption("--long", action="store_true", help="run the tests marked long too")
    parser.addoption("--live-runs", type=int, default=15, help="random sessions to replay")
    parser.addoption("--scene-cycles", type=int, default=8, help="scenes to load and unload")
    parser.addoption("--soak-minutes", type=float, default=0.05, help="minutes of play at 60 Hz")
    parser.addoption("--stress-scale", type=float, default=0.08, help="times more inputs")


_SOLVED = OrderedDict()
# One of three colours takes 8 MB, one of all wavelengths a hundred.
_KEPT_BYTES = 1.5e8


def _nbytes(field):
    return sum(getattr(values, "nbytes", 0) for values in vars(field).values())


def pytest_runtest_setup():
    """Tests of a process share solved atmospheres, as soon as something has loaded the solver.

    That the solver finds the same digits again is held by the journals in tests/replays, each of
    another process, and by tests/test_sums_in_order.py.
    """
    job = sys.modules.get("bruneton_sky.solver_job")
    if job is None or hasattr(job.solve, "solves"):
        return
    solve = job.solve

    def solve_once(*arguments, progress=None, **named):
        key = (arguments, tuple(sorted(named.items())))
        if key in _SOLVED:
            _SOLVED.move_to_end(key)
            if progress is not None:
                progress(1.0)
        else:
            _SOLVED[key] = solve(*arguments, progress=progress, **named)
        field = _SOLVED[key]
        while len(_SOLVED) > 1 and sum(map(_nbytes, _SOLVED.values())) > _KEPT_BYTES:
            _SOLVED.popitem(last=False)
        return field

    solve_once.solves = solve
    job.solve = solve_once


def pytest_configure(config):
    """How many examples a property is tried with, unless its test says; only long runs try new."""
    hypothesis.settings.register_profile("short", deadline=None, max_examples=10, derandomize=True)
    hypothesis.settings.register_profile("long", deadline=None, max_examples=200)
    hypothesis.settings.load_profile("long" if config.getoption("--long") else "short")


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_auto_num_workers():
    """Three workers on two cores: a third of the time tests wait for windows and processes."""
    return math.ceil(1.5 * (os.cpu_count() or 1))


def pytest_collection_modifyitems(config, items):
    """Leave out what takes long; skip what needs OpenGL where there is none, and say why."""
    if not config.getoption("--long"):
        config.hook.pytest_deselected(items=[i for i in items if i.get_closest_marker("long")])
        items[:] = [item for item in items if not item.get_closest_marker("long")]
    needing = [item for item in items if "gl" in item.keywords]
    if needing and not probe_gl()[0]:
        skip = pytest.mark.skip(reason=f"no OpenGL 4.3 through EGL: {probe_gl()[1]}")
        for item in needing:
            item.add_marker(skip)


def pytest_report_header(config):
    """Name the GL and the Qt that the tests run on."""
    renderer, reason = probe_gl()
    qt = f"none, tests/app is skipped: {NO_QT}" if NO_QT else "found"
    return [f"OpenGL: {renderer or 'none, GL tests are skipped: ' + reason}", f"Qt: {qt}"]


# Trial times (ns a pixel) that select the two rows of the table of renderers.
CARD_NS, PROCESSOR_NS = 0.1, 100.0


@pytest.fixture(scope="session")
def gl_owner():
    """One GL thread for all tests of a process, which draws as a processor does, also on a card."""
    from vrut_lite.render.gl_owner import GlOwner

    owner = GlOwner(PROCESSOR_NS)
    yield owner
    owner.close()


def filter_rounding(owner):
    """Largest error of a place between texels in a linear look-up, in texels, per axis.

    Cards keep 8 bits of it, as OpenGL allows; llvmpipe keeps all.
    """
    return 0.0 if owner.opened.renderer.startswith("llvmpipe") else 0.5 / 256


@pytest.fixture
def gl_backend(gl_owner):
    """Makes a `StatefulBackend` on OpenGL with parts of its state."""
    from vrut_lite.render.pyrender_backend import PyrenderBackend

    backend = PyrenderBackend(gl_owner)
    yield lambda **parts: StatefulBackend(backend, **parts)
    backend.close()


@pytest.fixture(scope="module")
def _backend_of_file(gl_owner):
    from vrut_lite.render.pyrender_backend import PyrenderBackend

    backend = PyrenderBackend(gl_owner)
    yield backend
    backend.close()


@pytest.fixture
def shared_gl_backend(_backend_of_file):
    """The same on a backend that the tests of a file share: its frames remember the ones before."""
    return lambda **parts: StatefulBackend(_backend_of_file, **parts)


@pytest.fixture(scope="module")
def compute(gl_owner):
    """Runs a job on the GL thread as the host does, and reads its texels back."""
    from vrut_lite.render.gl_jobs import GlJobs

    results = []
    jobs = GlJobs(SimpleNamespace(), None, owner=gl_owner, inject=results.append)

    def run(job):
        jobs.on_job(job)
        jobs.pending[-1].result()
        assert results[-1].error == ""
        return results[-1].value.values[..., :3].astype(float)

    return run


@pytest.fixture(autouse=True, scope="module")
def _forgets_what_a_file_computed(request):
    """What a file's own caches hold, such as solved atmospheres, takes memory to the end."""
    yield
    for cached in vars(request.module).values():
        if hasattr(cached, "cache_clear") and cached.__module__ == request.module.__name__:
            cached.cache_clear()


@pytest.fixture
def no_hang():
    """Ends a test that would wait for ever; it does not measure speed."""

    def give_up(number, frame):
        raise AssertionError("a broken file keeps the loader busy for ever")

    before = signal.signal(signal.SIGALRM, give_up)
    yield lambda: signal.alarm(60)
    signal.alarm(0)
    signal.signal(signal.SIGALRM, before)
