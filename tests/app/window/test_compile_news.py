"""The window says that kernels are compiled while it draws by the open sky."""

import threading

import pytest
from PySide6.QtWidgets import QApplication

from vrut_lite import compiled_code
from vrut_lite.app.window.compile_news import CompileNews
from vrut_lite.app.window.status_line import StatusLine
from vrut_lite.compiling.pool import Progress


@pytest.fixture
def news():
    """A status line with news of compilations; nothing follows compilations before and after."""
    app = QApplication.instance() or QApplication([])
    line = StatusLine()
    made = CompileNews(line)
    made.show_in(line)
    yield app, line, made
    made.close()
    compiled_code.ahead = None
    line.deleteLater()


def test_the_line_says_what_is_prepared_and_goes(news) -> None:
    """Steps come on the threads of the pool; the last one leaves no sign behind."""
    app, line, made = news

    def tell(progress: Progress) -> None:
        thread = threading.Thread(target=made, args=(progress,))
        thread.start()
        thread.join()
        app.processEvents()

    assert line.work.isHidden()
    made.begin()
    assert not line.work.isHidden()
    tell(Progress("light between surfaces: ray table", 7, 66, 12.3))
    assert line.work.text() == "Preparing light between surfaces, once: 7 of 66, 12 s to go"
    tell(Progress("", 66, 66, 0.0))
    assert line.work.isHidden()


def test_the_window_compiles_its_own_kernels_before_the_light_s(news) -> None:
    """The first picture is the open sky's: light between surfaces takes ten times as long."""
    groups = compiled_code.ahead.groups("dynamic_skylight")
    packages = [group.kernels[0].module.partition(".")[0] for group in groups]
    assert packages.index("vrut_lite") < packages.index("light_transport")
    assert packages[-1] == "light_transport"
