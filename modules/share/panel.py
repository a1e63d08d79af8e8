"""The panel of a shared page: the window's scene as one file, made in another process.

The window imports it by the entry point `vrut_lite.panels`; File has its entry.
"""

from multiprocessing.connection import Connection
from multiprocessing.context import SpawnProcess
from pathlib import Path

from PySide6.QtCore import QUrl
from PySide6.QtGui import QDesktopServices
from PySide6.QtWidgets import (
    QFileDialog,
    QHBoxLayout,
    QLineEdit,
    QProgressBar,
    QPushButton,
    QWidget,
)

from share.page_file import SUFFIX, check_built, check_name
from vrut_lite.errors import UserError
from vrut_lite.lazy import lazy
from vrut_lite.messages.scene import SceneOpened
from vrut_lite.panel_kit import (
    Session,
    faint_label,
    file_title,
    folder_of,
    make_timer,
    panel_column,
    spawn_context,
)
from vrut_lite.write_atomic import atomic_output, check_writable

# It imports the command's whole work, which the window need not wait for.
_page_process = lazy("share.page_process")
_numbers = lazy("share.numbers")
_LOOK_MS = 200
_IDLE = (
    "One HTML file that any browser opens, from disk and without a network: the scene at any hour "
    "of the year, with the views that were kept by name. It takes some minutes, beside the window."
)
_NUMBERS = "What `vrut-lite daylight SCENE -o FOLDER` wrote: tiles in the page show it."
_ELLIPSIS = "\N{HORIZONTAL ELLIPSIS}"


class SharePanel(QWidget):
    """A button, the folder of daylight's numbers, the progress with *Cancel*, and where the page
    lies, with *Open*."""

    title = "Share"
    file_entry = f"Share in one file{_ELLIPSIS}"

    def __init__(self, session: Session):
        super().__init__()
        self._session = session
        self._process: SpawnProcess | None = None
        self._pipe: Connection
        self._target = Path()
        self.share = QPushButton(self.file_entry)
        self.numbers, self.choose = QLineEdit(), QPushButton(f"Choose{_ELLIPSIS}")
        self.numbers.setPlaceholderText("none")
        self.numbers.setClearButtonEnabled(True)
        self.numbers.setToolTip(_NUMBERS)
        self.numbers.setAccessibleName("folder of daylight's numbers")
        self.progress, self.work = QProgressBar(), faint_label(wraps=True)
        self.cancel = QPushButton("Cancel")
        self.result = faint_label(_IDLE, wraps=True)
        self.open = QPushButton("Open in the browser")
        self.open.hide()
        row = QHBoxLayout()
        row.addWidget(self.progress, 1)
        row.addWidget(self.cancel)
        column = panel_column(self)
        column.addWidget(self.share)
        column.addWidget(faint_label("with daylight's numbers of the folder"))
        folder = QHBoxLayout()
        folder.addWidget(self.numbers, 1)
        folder.addWidget(self.choose)
        column.addLayout(folder)
        column.addWidget(self.work)
        column.addLayout(row)
        column.addWidget(self.result)
        column.addWidget(self.open)
        column.addStretch(1)
        self._show_running(False)
        self._looks = make_timer(self, _LOOK_MS, self._look)
        self.share.clicked.connect(self.ask_for_file)
        self.choose.clicked.connect(self.ask_for_numbers)
        self.cancel.clicked.connect(self.stop)
        self.open.clicked.connect(self._open)
        session.closing.connect(self._end)

    @property
    def is_running(self) -> bool:
        """Whether a page is being made."""
        return self._process is not None

    def ask_for_file(self) -> None:
        """Let a name be chosen, and share the window's scene."""
        if self.is_running:
            return
        try:
            check_built()
            if self._session.last(SceneOpened) is None:
                raise UserError("no scene is open: there is nothing to share")
        except UserError as error:
            self._session.refused.emit(str(error))
            return
        name = str(Path(folder_of(self._session), f"{file_title(self._session)}{SUFFIX}"))
        path, _ = QFileDialog.getSaveFileName(self, "Share in one file", name, f"Pages (*{SUFFIX})")
        if path:
            self.start(Path(path if Path(path).suffix else f"{path}{SUFFIX}"))

    def ask_for_numbers(self) -> None:
        """Let the folder of daylight's numbers be chosen."""
        begins = self.numbers.text().strip() or str(folder_of(self._session))
        folder = QFileDialog.getExistingDirectory(self, "Daylight's numbers", begins)
        if folder:
            self.numbers.setText(folder)

    def start(self, path: Path) -> None:
        """Share the window's scene as it is now."""
        folder = self.numbers.text().strip()
        numbers = Path(folder) if folder else None
        scene = self._session.last(SceneOpened)
        try:
            check_name(path)
            check_writable(path)
            if numbers is not None and scene is not None:
                _numbers.load().numbers_of(numbers, scene)
            context = spawn_context()
        except UserError as error:
            self._session.refused.emit(str(error))
            return
        project = self._session.present_project()
        self._target = path
        self._pipe, child = context.Pipe(duplex=False)
        work = _page_process.load().make_page
        args = child, project, Path(project.scene).stem, numbers
        self._process = context.Process(target=work, args=args, daemon=True)
        self._process.start()
        child.close()
        self.result.setText("")
        self.open.hide()
        self._show_progress("starting", 0, 0)
        self._show_running(True)
        self._looks.start()

    def stop(self) -> None:
        """Give the page up: no file is written."""
        if self.is_running:
            self._end()
            self.result.setText(f"Stopped: {self._target.name} was not written.")

    def _look(self) -> None:
        """Take what the process has sent."""
        page_process = _page_process.load()
        try:
            while self.is_running and self._pipe.poll():
                match self._pipe.recv():
                    case page_process.PageProgress(work, done, total):
                        self._show_progress(work, done, total)
                    case page_process.PageRefused(sentence):
                        self._refuse(sentence)
                    case page_process.PageMade(text, left_out):
                        self._write(text, left_out)
        except EOFError:
            self._refuse(
                "the process that makes the page was ended from outside, perhaps for want of "
                "memory: close other programs, and share again"
            )

    def _write(self, text: str, left_out: tuple[str, ...]) -> None:
        self._end()
        try:
            with atomic_output(self._target) as beside:
                beside.write_text(text, encoding="utf-8")
        except UserError as error:
            self._refuse(str(error))
            return
        size = self._target.stat().st_size
        without = f" Left out of its sky: {', '.join(left_out)}." if left_out else ""
        self.result.setText(f"{self._target}: {size / 1e6:.1f} MB.{without}")
        self.open.show()

    def _refuse(self, sentence: str) -> None:
        self._end()
        self.result.setText("No page was written.")
        self._session.refused.emit(sentence)

    def _end(self) -> None:
        """End the process, if it still runs."""
        self._looks.stop()
        self._show_running(False)
        if self._process is not None:
            self._process.terminate()
            self._process.join()
            self._process = None
            self._pipe.close()

    def _open(self) -> None:
        QDesktopServices.openUrl(QUrl.fromLocalFile(str(self._target)))

    def _show_progress(self, work: str, done: int, total: int) -> None:
        self.work.setText(f"{work} {_ELLIPSIS}")
        # Without a total the bar moves to and fro.
        self.progress.setRange(0, total)
        self.progress.setValue(done)

    def _show_running(self, running: bool) -> None:
        for field in (self.share, self.numbers, self.choose):
            field.setEnabled(not running)
        for part in (self.work, self.progress, self.cancel):
            part.setVisible(running)
