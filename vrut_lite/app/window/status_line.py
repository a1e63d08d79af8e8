"""The status line: the latest message, and facts of the picture."""

from collections.abc import Callable, Sequence

from PySide6.QtCore import Qt
from PySide6.QtWidgets import QLabel, QPushButton, QSizePolicy, QStatusBar

from vrut_lite.app import theme
from vrut_lite.app.engine.engine import Shown
from vrut_lite.app.widgets import faint_label, make_timer

_NEWS_MS = 12_000
_APART_PX = 12


class StatusLine(QStatusBar):
    """A message disappears after 12 s."""

    def __init__(self) -> None:
        super().__init__()
        self.news = QLabel()
        self.news.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
        # A long line is cut off: it must not widen the window.
        self.news.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Preferred)
        self.facts = faint_label()
        # Progress of work beside the picture.
        self.work = faint_label()
        self.work.setContentsMargins(0, 0, _APART_PX, 0)
        self.work.hide()
        # Action that the latest message offers.
        self.remedy = QPushButton()
        self.remedy.hide()
        self.remedy.clicked.connect(self._take_remedy)
        self._remedy: Callable[[], None] | None = None
        self.addWidget(self.remedy)
        self.addWidget(self.news, 1)
        self.addPermanentWidget(self.work)
        self.addPermanentWidget(self.facts)
        self.setSizeGripEnabled(False)
        self._fades = make_timer(self, _NEWS_MS, self.news.clear, once=True)

    def show_problem(self, line: str) -> None:
        """Show an error."""
        self._tell(line, theme.ALARM)

    def show_warning(self, line: str) -> None:
        """Show a warning until the next line."""
        self._tell(line, theme.TEXT)
        self._fades.stop()

    def show_news(self, line: str) -> None:
        """Show a result."""
        self._tell(line, theme.TEXT)

    def show_notices(self, line: str, notices: Sequence[str]) -> None:
        """Show a result and its warnings, which stay until the next line."""
        self._tell("; ".join((line, *notices)), theme.TEXT)
        self.news.setToolTip("\n".join((line, *notices)))
        if notices:
            self._fades.stop()

    def offer(self, title: str, tip: str, remedy: Callable[[], None]) -> None:
        """Offer a remedy beside the latest message; the next one takes it away."""
        self._remedy = remedy
        self.remedy.setText(title)
        self.remedy.setToolTip(tip)
        self.remedy.setAccessibleName(tip)
        self.remedy.show()

    def _take_remedy(self) -> None:
        if self._remedy is not None:
            self._remedy()
        self.remedy.hide()

    def show_work(self, line: str) -> None:
        """Show what goes on beside the picture; nothing does if the line is empty."""
        self.work.setText(line)
        self.work.setVisible(bool(line))

    def show_facts(self, shown: Shown, renderer: str) -> None:
        """Size and time of a picture and the renderer's name, in full as a tooltip."""
        height, width = shown.picture.display.shape[:2]
        self.facts.setText(
            f"{width} \N{MULTIPLICATION SIGN} {height} in {_duration(shown.seconds)}, "
            f"{renderer.partition(' (')[0]}   "
        )
        self.facts.setToolTip(renderer)

    def _tell(self, line: str, colour: str) -> None:
        self.remedy.hide()
        self.news.setText(line)
        self.news.setToolTip(line)
        self.news.setStyleSheet(f"color: {colour}; padding-left: 6px;")
        self._fades.start()


def _duration(seconds: float) -> str:
    return f"{seconds:.1f} s" if seconds >= 1.0 else f"{1e3 * seconds:.0f} ms"
