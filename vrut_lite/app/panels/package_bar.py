"""Installs, updates and removes packages of modules, by processes: the window never waits.

They change what the next start loads, and nothing that runs.
"""

import html
import re
import sys
import tempfile
from collections.abc import Callable, Sequence

from PySide6.QtCore import QCoreApplication, QProcess
from PySide6.QtWidgets import (
    QFileDialog,
    QHBoxLayout,
    QInputDialog,
    QMenu,
    QMessageBox,
    QProgressBar,
    QPushButton,
    QVBoxLayout,
    QWidget,
)

from vrut_lite.app import theme
from vrut_lite.app.widgets import faint_label
from vrut_lite.module_packages.installing import RIGHTS
from vrut_lite.module_packages.remote import answer_of
from vrut_lite.module_packages.wheels import ModuleWheel
from vrut_lite.operating_system import end_group
from vrut_lite.package_facts import PackageFacts

_LONGEST_END_MS = 60_000
# Names and texts of a question.
Rows = Sequence[tuple[str, str]]


class PackageBar(QWidget):
    """Buttons to change packages, the running step, and its outcome in a sentence."""

    def __init__(self) -> None:
        super().__init__()
        self._package: PackageFacts | None = None
        self._folder: tempfile.TemporaryDirectory[str] | None = None
        self._outcome = ""
        self._is_cancelled = False
        self.process = QProcess(self)
        # Its group ends with it: pip, and what a package's build has started.
        if hasattr(self.process, "setUnixProcessParameters"):
            parameters = self.process.unixProcessParameters()
            parameters.flags = QProcess.UnixProcessFlag.CreateNewSession
            self.process.setUnixProcessParameters(parameters)
        self.process.started.connect(self._show_state)
        self.process.finished.connect(self._ended)
        self.process.errorOccurred.connect(self._failed_to_start)
        self.question: QMessageBox | None = None
        self.install = QPushButton("Install...")
        self.install.setToolTip("Install a package of modules. " + RIGHTS)
        menu = QMenu(self.install)
        self.from_wheel = menu.addAction(
            "From a wheel (.whl)...", lambda: self._choose_wheel(self.prepare_install)
        )
        self.from_folder = menu.addAction(
            "From a folder...", lambda: self._choose_folder(self.prepare_install)
        )
        self.by_name = menu.addAction("By its name on the index...", self._choose_name)
        self.install.setMenu(menu)
        self.update_ = QPushButton("Update...")
        self.update_.setToolTip("Put another version of the module's package in its place")
        menu = QMenu(self.update_)
        self.update_from_index = menu.addAction("From the index", lambda: self.prepare_update())
        self.update_from_wheel = menu.addAction(
            "From a wheel (.whl)...", lambda: self._choose_wheel(self.prepare_update)
        )
        self.update_from_folder = menu.addAction(
            "From a folder...", lambda: self._choose_folder(self.prepare_update)
        )
        self.update_.setMenu(menu)
        self.remove = QPushButton("Remove...")
        self.remove.setToolTip("Remove the module's package; what it requires stays")
        self.cancel = QPushButton("Cancel")
        self.cancel.setToolTip("Give up; nothing has been installed so far")
        self.cancel.clicked.connect(lambda _: self._give_up())
        self.remove.clicked.connect(lambda _: self._ask_to_remove())
        self.progress = QProgressBar()
        self.progress.setRange(0, 0)
        self.progress.setTextVisible(False)
        self.progress.setMaximumHeight(6)
        self.status = faint_label(wraps=True)
        buttons = QHBoxLayout()
        for button in (self.install, self.update_, self.remove):
            buttons.addWidget(button)
        buttons.addStretch(1)
        buttons.addWidget(self.cancel)
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)
        column.addLayout(buttons)
        column.addWidget(self.progress)
        column.addWidget(self.status)
        application = QCoreApplication.instance()
        if application is not None:
            application.aboutToQuit.connect(self._end_with_the_window)
        self._show_state()

    def choose(self, package: PackageFacts | None) -> None:
        """Let the buttons be about a package; None: about none of somebody else's."""
        self._package = package
        self._show_state()

    @property
    def is_busy(self) -> bool:
        """Whether a step runs."""
        return self.process.state() != QProcess.ProcessState.NotRunning

    # --- steps ---------------------------------------------------------------------------

    def prepare_install(self, what: str) -> None:
        """Make the wheel of a package, and ask whether to install it."""
        if not self.is_busy:
            folder = self._new_folder()
            self._begin("Reading the package...", "is installed", "install", what, folder)

    def prepare_update(self, what: str = "") -> None:
        """Make the wheel of another version of the chosen package, and ask about it."""
        if self._package is not None and not self.is_busy:
            name, folder = self._package.name, self._new_folder()
            words = f"Looking for another version of {name}..."
            self._begin(words, "is updated", "update", name, what, folder)

    def _apply(self, wheel: ModuleWheel) -> None:
        facts = wheel.facts
        outcome = (
            f"{facts.name} {facts.version} {self._outcome} and loads: it runs from the next start"
        )
        self._begin(f"Installing {facts.name}...", outcome, "apply", wheel.path, facts.sha256)

    def _remove(self, package: PackageFacts) -> None:
        outcome = f"{package.name} {package.version} is removed: it runs until the window closes"
        folder = self._new_folder()
        self._begin(f"Removing {package.name}...", outcome, "remove", package.name, folder)

    def _begin(self, words: str, outcome: str, step: str, *arguments: str) -> None:
        self._outcome, self._is_cancelled = outcome, False
        self._say(words)
        program = ["-m", "vrut_lite.module_packages.remote", step, *arguments]
        # A folder of nobody's: Python looks for modules in the one where it starts.
        self.process.setWorkingDirectory(self._folder.name if self._folder else "")
        self.process.start(sys.executable, program)
        self._show_state()

    def _ended(self, _code: int, _status: QProcess.ExitStatus) -> None:
        answer = answer_of(bytes(self.process.readAllStandardOutput().data()))
        self._show_state()
        if self._is_cancelled:
            self._say("Cancelled: nothing is changed.")
        elif answer.error:
            self._say(answer.error, alarms=True)
        elif answer.wheel is not None:
            self._ask_to_install(answer.wheel)
        else:
            self._say(self._outcome)

    def _failed_to_start(self, error: QProcess.ProcessError) -> None:
        if error == QProcess.ProcessError.FailedToStart:
            self._show_state()
            self._say(f"{sys.executable} could not be started", alarms=True)

    def _end_with_the_window(self) -> None:
        """Let pip finish what it changes; what only reads is ended."""
        if self.is_busy:
            self._give_up()
            self.process.waitForFinished(_LONGEST_END_MS)

    @property
    def _only_reads(self) -> bool:
        """Whether the running step leaves the environment as it is, so that it may be given up."""
        runs = self.process.state() == QProcess.ProcessState.Running
        return runs and not {"apply", "remove"} & {*self.process.arguments()}

    def _give_up(self) -> None:
        if self._only_reads:
            self._is_cancelled = True
            end_group(self.process.processId())

    # --- questions -----------------------------------------------------------------------

    def _ask_to_install(self, wheel: ModuleWheel) -> None:
        facts = wheel.facts
        brought = "; ".join(
            f"{group.removeprefix('vrut_lite.').replace('_', ' ')}: {', '.join(names)}"
            for group, names in facts.brings.items()
        )
        rows = (
            ("Package", f"{facts.name} {facts.version}"),
            ("Author", facts.author or "not named"),
            ("Licence", facts.licence or "not named"),
            ("Brings", brought),
            ("SHA-256", facts.sha256),
        )
        self._say("")
        self._ask(f"Install {facts.name} {facts.version}?", rows, RIGHTS, "Install",
                  lambda: self._apply(wheel))  # fmt: skip

    def _ask_to_remove(self) -> None:
        package = self._package
        if package is not None:
            rows = (("Package", f"{package.name} {package.version}"), ("Author", package.author))
            self._ask(f"Remove {package.name}?", rows, "What it requires stays.", "Remove",
                      lambda: self._remove(package))  # fmt: skip

    def _ask(
        self, title: str, rows: Rows, words: str, agree: str, then: Callable[[], None]
    ) -> None:
        question = QMessageBox(QMessageBox.Icon.Question, title, "", parent=self)
        table = "".join(
            f"<tr><td>{html.escape(name)}&nbsp;&nbsp;</td><td>{_in_pieces(text)}</td></tr>"
            for name, text in rows
        )
        question.setText(f"<b>{html.escape(title)}</b>")
        question.setInformativeText(f"<table>{table}</table><p>{html.escape(words)}</p>")
        yes = question.addButton(agree, QMessageBox.ButtonRole.AcceptRole)
        question.addButton(QMessageBox.StandardButton.Cancel)
        question.setDefaultButton(QMessageBox.StandardButton.Cancel)
        question.buttonClicked.connect(lambda button: then() if button is yes else None)
        question.finished.connect(question.deleteLater)
        self.question = question
        question.open()

    def _choose_wheel(self, prepare: Callable[[str], None]) -> None:
        path, _ = QFileDialog.getOpenFileName(self, "The wheel of a package", "", "Wheels (*.whl)")
        if path:
            prepare(path)

    def _choose_folder(self, prepare: Callable[[str], None]) -> None:
        path = QFileDialog.getExistingDirectory(self, "The folder of a package")
        if path:
            prepare(path)

    def _choose_name(self) -> None:
        name, wanted = QInputDialog.getText(self, "Install a package", "Its name on pip's index:")
        if wanted and name.strip():
            self.prepare_install(name.strip())

    # --- widgets -------------------------------------------------------------------------

    def _new_folder(self) -> str:
        self._folder = tempfile.TemporaryDirectory(prefix="vrut_lite_")
        return self._folder.name

    def _show_state(self) -> None:
        self.progress.setVisible(self.is_busy)
        self.cancel.setVisible(self._only_reads)
        self.install.setEnabled(not self.is_busy)
        for button in (self.update_, self.remove):
            button.setEnabled(self._package is not None and not self.is_busy)

    def _say(self, text: str, alarms: bool = False) -> None:
        self.status.setText(text)
        self.status.setStyleSheet(f"color: {theme.ALARM};" if alarms else "")
        self.status.setVisible(bool(text))


def _in_pieces(text: str) -> str:
    """A text as HTML whose long words, as a hash is, may break every 32 letters."""
    return html.escape(re.sub(r"(\S{32})(?=\S)", "\\1\N{ZERO WIDTH SPACE}", text))
