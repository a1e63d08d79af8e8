"""The status line's progress of kernels that are compiled."""

from PySide6.QtCore import QObject, Signal
from PySide6.QtWidgets import QStatusBar

from vrut_lite.app.window.status_line import StatusLine
from vrut_lite.compiling.ahead import compile_ahead
from vrut_lite.compiling.pool import Progress


class CompileNews(QObject):
    """Compiles ahead while a window is open and shows the progress; the last line is empty."""

    told = Signal(str)

    def __init__(self, parent: QObject | None = None):
        super().__init__(parent)
        self._ahead = compile_ahead(self, scene=True, window=True)

    def begin(self) -> None:
        """The first kernel is compiled."""
        self.told.emit("Compiling the numerical kernels, once")

    def __call__(self, progress: Progress) -> None:
        """Tell how far it is; on any thread."""
        if progress.done == progress.total:
            self.told.emit("")
            return
        self.told.emit(
            f"Preparing {progress.title.partition(':')[0] or 'kernels'}, once: "
            f"{progress.done} of {progress.total}, {progress.left_s:.0f} s to go"
        )

    def close(self) -> None:
        """End the processes that compile, and let go what waits for them."""
        self._ahead.pool.close()

    def show_in(self, line: QStatusBar) -> None:
        """Show it in the window's status line from now on."""
        assert isinstance(line, StatusLine)
        self.told.connect(line.show_work)
