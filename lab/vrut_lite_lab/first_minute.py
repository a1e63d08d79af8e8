"""The first minute of a new user, timed: the real window is opened, turned, and made to export.

    xvfb-run -a -s "-screen 0 1920x1200x24" python -m vrut_lite_lab.first_minute [SCENE]

Prints seconds since the process began, of the wall's clock and of the processor's, when each step
was done, and what it took. Nothing is kept from earlier sessions but compiled kernels.
"""

import sys
import tempfile
from collections.abc import Callable
from pathlib import Path
from time import perf_counter, process_time

from vrut_lite.lazy import lazy
from vrut_lite_lab.checkout import ROOT

_BEGAN_S = perf_counter(), process_time()
# Imported while the clock runs.
begin_probe = lazy("vrut_lite.render.gl_environment:begin_probe")
_numba, _host = lazy("vrut_lite.numba_compiler"), lazy("vrut_lite.host")
_OF_WINDOW = (
    QtCore := lazy("PySide6.QtCore"),
    QTest := lazy("PySide6.QtTest:QTest"),
    QApplication := lazy("PySide6.QtWidgets:QApplication"),
    Session := lazy("vrut_lite.app.engine.session:Session"),
    apply_theme := lazy("vrut_lite.app.theme:apply_theme"),
    CompileNews := lazy("vrut_lite.app.window.compile_news:CompileNews"),
    first_place := lazy("vrut_lite.app.window.first_size:first_place"),
    Kept := lazy("vrut_lite.app.window.kept:Kept"),
    MainWindow := lazy("vrut_lite.app.window.main_window:MainWindow"),
    SurfaceLightChanged := lazy("vrut_lite.messages.light_map:SurfaceLightChanged"),
    SceneOpened := lazy("vrut_lite.messages.scene:SceneOpened"),
    project_of_path := lazy("vrut_lite.project:project_of_path"),
)


class StepPrinter:
    """Prints a line for each step."""

    def __init__(self) -> None:
        self._last_s = _BEGAN_S
        print(f"{'':34}{'at':>8}{'took':>8}{'CPU':>8}   s")

    def step(self, title: str) -> None:
        """A step is done."""
        now_s = perf_counter(), process_time()
        wall_s, took_s, cpu_s = (
            now_s[0] - _BEGAN_S[0],
            now_s[0] - self._last_s[0],
            now_s[1] - self._last_s[1],
        )
        print(f"{title:34}{wall_s:8.2f}{took_s:8.2f}{cpu_s:8.2f}", flush=True)
        self._last_s = now_s


def main() -> None:
    """Open, look around, type an hour, export."""
    watch = StepPrinter()
    # As `vrut-lite run` does it.
    begin_probe()
    _numba.load()
    _host.load()
    watch.step("the host's code is imported")
    for late in _OF_WINDOW:
        late.load()
    scenes = ROOT / "scenes"
    project = project_of_path(sys.argv[1] if len(sys.argv) > 1 else str(scenes / "street.toml"))
    watch.step("the window's code is imported")
    app = QApplication([])
    apply_theme(app)
    # A first start compiles its kernels in further processes, whose CPU time is not in the columns.
    compiling = CompileNews(app)
    session = Session()
    session.start()
    with tempfile.TemporaryDirectory() as folder:
        window = MainWindow(session, kept=Kept(Path(folder)))
        compiling.show_in(window.statusBar())
        watch.step("the window is made")
        window.setGeometry(first_place(app.primaryScreen().availableGeometry()))
        window.show()
        window.files.open_project(project)

        def until(is_so: Callable[[], object]) -> None:
            # As `app.exec()` does, and unlike QTest.qWait, this waits without Python's lock.
            loop = QtCore.QEventLoop()
            watch_on = QtCore.QTimer(interval=2)
            watch_on.timeout.connect(lambda: loop.quit() if is_so() else None)
            watch_on.start()
            loop.exec()

        pictures: list[bool] = []
        session.picture_shown.connect(lambda shown: pictures.append(shown.still))

        def shown(title: str) -> None:
            """A first picture after something, and a finished one."""
            pictures.clear()
            until(lambda: pictures)
            watch.step(f"{title}: a picture")
            until(lambda: pictures[-1])
            watch.step(f"{title}: a finished one")

        until(lambda: window.isVisible())
        watch.step("the window is seen")
        until(lambda: session.catalogue.modules)
        watch.step("the host is ready")
        until(lambda: session.last(SceneOpened.load()))
        watch.step("the scene is opened")
        until(lambda: pictures)
        watch.step("the first picture")
        until(lambda: session.last(SurfaceLightChanged.load()))
        watch.step("the first light of surfaces")
        until(lambda: pictures[-1])
        watch.step("a finished picture")

        # Without a window manager nobody else does: keys go to what is active.
        window.activateWindow()
        until(window.isActiveWindow)
        view = window.desk.viewport
        middle = view.rect().center()
        QTest.mousePress(view, QtCore.Qt.MouseButton.LeftButton, pos=middle)
        for way in range(0, 250, 25):
            QTest.mouseMove(view, middle + QtCore.QPoint(way, 0))
        QTest.mouseRelease(
            view, QtCore.Qt.MouseButton.LeftButton, pos=middle + QtCore.QPoint(250, 0)
        )
        shown("a drag of 250 px")

        clock = window.time.clock
        window.type_time("clock")
        QTest.keyClicks(clock, "8:30")
        QTest.keyClick(clock, QtCore.Qt.Key.Key_Return)
        shown("8:30 is typed")

        export = window.panels["export"]
        export.export(str(Path(folder, "picture.png")))
        until(lambda: "EV100" in export.status.text())
        watch.step("the picture is exported")
        window.close()
        until(lambda: session.has_ended)
        watch.step("the window is closed")
        compiling.close()
        session.join()


if __name__ == "__main__":
    main()
