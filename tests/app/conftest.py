"""Windows that nobody sees, on Qt's platform `offscreen`: no display is needed."""

import gc
import os

import pytest
from open_sky import lit_by_the_open_sky  # noqa: F401

os.environ.setdefault("QT_QPA_PLATFORM", "offscreen")

try:
    import PySide6.QtWidgets  # noqa: F401
except ImportError:
    # tests/conftest.py says why in the report's header.
    collect_ignore_glob = ["*/test_*.py", "test_*.py"]


@pytest.fixture(scope="session", autouse=True)
def days_found_once():
    """Windows of one process share the sun's days, each of which takes 400 places of the sun."""
    from vrut_lite.app.engine import sun_day_finder
    from vrut_lite.messages.place import SetPlace

    found, day_of = {}, sun_day_finder.day_of

    def day_of_once(second, day, zone):
        kernel = second.kernel
        holder = kernel.slots.holder("sun")
        settings = kernel.seats[holder].settings if holder else None
        key = (repr(kernel.last(SetPlace)), holder, repr(settings), day, str(zone))
        if key not in found:
            found[key] = day_of(second, day, zone)
        return found[key]

    sun_day_finder.day_of = day_of_once
    yield
    sun_day_finder.day_of = day_of


@pytest.fixture(scope="module", autouse=True)
def _frees_qt_objects_here():
    """Garbage of a file is freed on Qt's thread: tests of other files collect on any."""
    yield
    gc.collect()


@pytest.fixture
def headless_window(qtbot, tmp_path):
    """A window on a kernel with every module, whose pictures are black; closed at the end."""
    from window_driver import HeadlessStage, WindowDriver

    driver = WindowDriver(qtbot, HeadlessStage, tmp_path)
    yield driver
    driver.close()


@pytest.fixture
def drawn_window(qtbot, tmp_path):
    """The same with real pictures, of the sundial; needs OpenGL."""
    from window_driver import SMALL, WindowDriver

    from vrut_lite.app.engine.stage import GlStage

    driver = WindowDriver(qtbot, GlStage, tmp_path, SMALL)
    yield driver
    driver.close()


@pytest.fixture(scope="module")
def _open_window(request, qapp, tmp_path_factory):
    """A function that opens one window a stage for all tests of a file."""
    from pytestqt.qtbot import QtBot
    from window_driver import WindowDriver

    drivers = {}

    def window_on(open_stage, *size):
        if open_stage in drivers:
            drivers[open_stage].renew()
        else:
            folder = tmp_path_factory.mktemp("window")
            drivers[open_stage] = WindowDriver(QtBot(request), open_stage, folder, *size)
        return drivers[open_stage]

    yield window_on
    for driver in drivers.values():
        driver.close()


@pytest.fixture
def shared_headless_window(_open_window):
    """A headless window that the tests of a file share, with its project opened again.

    Docks, texts and tools stay as the test before left them.
    """
    from window_driver import HeadlessStage

    return _open_window(HeadlessStage)


@pytest.fixture
def shared_drawn_window(_open_window):
    """The same with real pictures."""
    from window_driver import SMALL

    from vrut_lite.app.engine.stage import GlStage

    return _open_window(GlStage, SMALL)
