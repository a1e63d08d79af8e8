"""A line in the picture: names of the parts that are waited for, drafted, or being refined."""

from PySide6.QtCore import QObject, Signal

from vrut_lite.app.engine.session import Session
from vrut_lite.app.widgets import make_timer

# Shorter waits are not announced: text that flashes disturbs more than it says.
_DELAY_MS = 300


class PictureSign(QObject):
    """`text` is empty while the picture is finished; `changed` is emitted when it changes."""

    changed = Signal()

    def __init__(self, session: Session, parent: QObject | None = None):
        super().__init__(parent)
        self._session = session
        self.text = ""
        self._delay = make_timer(self, _DELAY_MS, self._show, once=True)
        session.picture_shown.connect(self._note)
        session.waits_changed.connect(self._note)
        session.closing.connect(self._delay.stop)

    def _note(self, _news: object) -> None:
        text = self._present_text()
        if not text or self.text:
            self._delay.stop()
            self._set(text)
        elif not self._delay.isActive():
            self._delay.start()

    def _show(self) -> None:
        self._set(self._present_text())

    def _set(self, text: str) -> None:
        if text != self.text:
            self.text = text
            self.changed.emit()

    def _present_text(self) -> str:
        shown = self._session.shown
        if shown is None:
            return ""
        if waits_for := self._titles(self._session.waits_for):
            return f"waiting for: {waits_for}"
        if drafts := self._titles(shown.drafts):
            return f"draft, still to come: {drafts}"
        if not shown.still:
            return "refining: picture"
        refining = self._titles(shown.refining)
        return f"refining: {refining}" if refining else ""

    def _titles(self, names: tuple[str, ...]) -> str:
        modules = self._session.catalogue.modules
        return ", ".join(modules[name].title if name in modules else name for name in names)
