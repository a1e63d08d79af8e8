"""Opens the window and runs Qt until it is closed."""

import gc
import signal
import sys
from pathlib import Path

from PySide6.QtCore import QTimer
from PySide6.QtGui import QIcon
from PySide6.QtWidgets import QApplication

from vrut_lite.app.engine.module_states import into_safe_mode, states_of
from vrut_lite.app.engine.session import Session
from vrut_lite.app.fonts import ensure_font
from vrut_lite.app.theme import apply_theme
from vrut_lite.app.window.compile_news import CompileNews
from vrut_lite.app.window.first_size import first_place
from vrut_lite.app.window.kept import Kept, NamedProject
from vrut_lite.app.window.main_window import MainWindow
from vrut_lite.project import Project

_SIGNAL_MS = 200
_ICON = Path(__file__).parent / "data" / "vrut-lite_256.png"


def run_app(
    project: Project, kept: Kept, safe_mode: bool = False, named: NamedProject | None = None
) -> int:
    """Show a project in a window, `named` if it has a file; the exit code.

    In safe mode nothing but the host and the default sun and sky runs.
    """
    app = QApplication(sys.argv[:1])
    app.setApplicationName("vrut_lite")
    # The name of the desktop's entry, by which it shows the icon.
    app.setDesktopFileName("vrut-lite")
    app.setWindowIcon(QIcon(str(_ICON)))
    app.setQuitOnLastWindowClosed(False)
    ensure_font(app)
    apply_theme(app)
    # Before the engine calls a kernel.
    compiling = CompileNews(app)
    session = Session()
    session.ended.connect(app.quit)
    # Its news come when the event loop runs: the window is there by then.
    session.start()
    window = MainWindow(session, kept=kept)
    compiling.show_in(window.statusBar())
    # Otherwise garbage collection scans all these objects and stops the window for 0.1 s.
    session.ready.connect(lambda catalogue: gc.freeze())
    window.setGeometry(first_place(app.primaryScreen().availableGeometry()))
    window.show()
    if safe_mode:
        session.ask(states_of, lambda states: session.begin_with(*into_safe_mode(states)))
    if named is None:
        window.files.open_project(project)
    else:
        window.files.open_named(project, named)
    listening = _hear_interrupts(window)
    code = app.exec()
    listening.stop()
    compiling.close()
    session.close()
    session.join()
    return code


def _hear_interrupts(window: MainWindow) -> QTimer:
    """Let Ctrl-C in the terminal close the window: signals are handled only while Python runs."""
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda *_: QTimer.singleShot(0, window.close_now))
    timer = QTimer(window)
    timer.timeout.connect(lambda: None)
    timer.start(_SIGNAL_MS)
    return timer
