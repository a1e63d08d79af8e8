"""Windows that nobody sees, on Qt's platform `offscreen`: no display is needed."""

import os
from pathlib import Path

import pytest

os.environ.setdefault("QT_QPA_PLATFORM", "offscreen")

try:
    import PySide6.QtWidgets  # noqa: F401
except ImportError:
    # tests/conftest.py says why in the report's header.
    collect_ignore_glob = ["*/test_*.py", "test_*.py"]

SCENES = Path(__file__).parents[2] / "scenes"


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
    from window_driver import WindowDriver

    from vrut_lite.app.engine.stage import GlStage

    driver = WindowDriver(qtbot, GlStage, tmp_path)
    yield driver
    driver.close()
