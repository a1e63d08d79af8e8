"""Whether the project differs from its state when it was last opened or saved."""

from collections.abc import Callable

import msgspec
from PySide6.QtCore import QObject, Signal

from vrut_lite.app.engine.session import Session
from vrut_lite.app.widgets import make_timer
from vrut_lite.messages.scene import LoadScene, SceneOpened
from vrut_lite.project import PROJECT_PARTS, Project

_LOOK_MS = 300
# Who looks around, or makes the window larger, changes no work: undo leaves both out too.
_VIEW = {"camera", "size"}
_OF_SCENE = set(PROJECT_PARTS[LoadScene].fields_of(LoadScene(path="")))
Fields = dict[str, object]


class Unsaved(QObject):
    """`changed` emits whether there is something to save; `present` makes the present project.

    An opened project counts as saved once the kernel has acted on it, its scene once that is open.
    """

    changed = Signal(bool)

    def __init__(self, session: Session, present: Callable[[], Project], parent: QObject):
        super().__init__(parent)
        self._session, self._present = session, present
        self._saved: Fields = {}
        self._openings = 0
        self._was_changed = False
        self._was = False
        self._looking = make_timer(self, _LOOK_MS, self.look, once=True)
        session.heard.connect(self._note_message)
        session.steps_changed.connect(lambda _: self._look_soon())
        session.closing.connect(self._looking.stop)

    def begin(self) -> None:
        """Something else is being opened."""
        self._openings += 1
        self._saved, self._was_changed = {}, False
        self.look()
        number = self._openings
        # Inputs are sent in the first answer, and acted on before the second.
        self._session.ask(
            _nothing, lambda _: self._session.ask(_nothing, lambda _: self._begun(number))
        )

    def mark_changed(self) -> None:
        """The project that is being opened differs from its file: of a session with changes."""
        self._was_changed = True
        self.look()

    def saved(self) -> None:
        """The present project was saved."""
        self._saved, self._was_changed = self._fields(), False
        self.look()

    def look(self) -> None:
        """Compare now."""
        now = self.is_changed
        if now != self._was:
            self._was = now
            self.changed.emit(now)

    @property
    def is_changed(self) -> bool:
        """Whether a field that is known as saved differs."""
        fields = self._fields() if self._saved else {}
        differ = (fields[name] != value for name, value in self._saved.items())
        return self._was_changed or any(differ)

    def _begun(self, number: int) -> None:
        """The inputs have been acted on; a scene that is still on its way follows."""
        if number != self._openings:
            return
        fields = self._fields()
        self._saved = {name: fields[name] for name in fields.keys() - _OF_SCENE} | self._saved
        self.look()

    def _note_message(self, message: object, _sender: str) -> None:
        if isinstance(message, SceneOpened) and not _OF_SCENE & self._saved.keys():
            fields = self._fields()
            self._saved |= {name: fields[name] for name in _OF_SCENE}
        self._look_soon()

    def _look_soon(self) -> None:
        """Time that plays sends many messages: the first one starts the wait."""
        if not self._looking.isActive():
            self._looking.start()

    def _fields(self) -> Fields:
        every = msgspec.structs.asdict(self._present())
        return {name: value for name, value in every.items() if name not in _VIEW}


def _nothing(_stage: object) -> None:
    """A question without an answer: it waits its turn."""
