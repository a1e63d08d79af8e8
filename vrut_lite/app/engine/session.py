"""The engine for Qt: takes inputs from Qt's thread, and delivers messages and pictures on it.

News from the engine wait in a mailbox, the latest of each key, until Qt's event loop takes them all
at once: a busy thread causes no backlog.
"""

from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import CancelledError, Future
from contextlib import closing, contextmanager
from itertools import count
from typing import TYPE_CHECKING, Any, TypeVar

from PySide6.QtCore import QObject, Qt, Signal

from vrut_lite.app.engine import revision_news
from vrut_lite.app.engine.cpu_sky import best_stage
from vrut_lite.app.engine.engine import Engine, Shown, Watcher
from vrut_lite.app.engine.flight_recorder import FlightRecorder, Recorded
from vrut_lite.app.engine.garbage import GarbageOnQtThread
from vrut_lite.app.engine.history import History
from vrut_lite.app.engine.module_catalogue import ModuleCatalogue, catalogue_of
from vrut_lite.app.engine.preview_kernel import PreviewKernel
from vrut_lite.app.engine.spare_memory import SpareMemory
from vrut_lite.app.engine.stage import Stage
from vrut_lite.errors import UserError
from vrut_lite.foreign_errors import sentence_of
from vrut_lite.kernel.messages import Fault, Input, Message, ReloadModule
from vrut_lite.mailbox import Mailbox
from vrut_lite.messages.camera import MoveCamera
from vrut_lite.messages.picture import SetExposure
from vrut_lite.scene.scene_state import SceneState

if TYPE_CHECKING:
    from vrut_lite.project import Project

M = TypeVar("M", bound=Message)
T = TypeVar("T")
Listener = Callable[[Any], None]
_STEPS = "steps"


class Session(QObject):
    """One host behind a window.

    Signals, all on Qt's thread: `ready` (a `ModuleCatalogue`) once the host is open,
    `catalogue_renewed` when a reload may have changed a module's settings, `sent` (an input)
    whenever something was sent,
    `heard` (message, sender), `picture_shown` (a `Shown`), `waits_changed` (names of the modules
    that the next state of the scene waits for), `camera_moved` (the `MoveCamera` of the
    view), `steps_changed` (`Steps` to undo and to redo), `problem` (a sentence), `refused` (a
    sentence on a file that cannot be read or written), `closing` when closing starts, `ended` when
    all threads have ended.

    `catalogue` follows every change of a setting or a slot; listeners find the new value in it.
    `present_project` is the window's state as a project; the window sets it.
    """

    ready = Signal(object)
    catalogue_renewed = Signal()
    sent = Signal(object)
    heard = Signal(object, str)
    picture_shown = Signal(object)
    waits_changed = Signal(object)
    camera_moved = Signal(object)
    steps_changed = Signal(object)
    problem = Signal(str)
    refused = Signal(str)
    closing = Signal()
    ended = Signal()
    _mail_came = Signal()
    present_project: "Callable[[], Project]"

    def __init__(self, open_stage: Callable[[], Stage] = best_stage, parent: QObject | None = None):
        super().__init__(parent)
        self.catalogue = ModuleCatalogue({}, {}, "")
        self.shown: Shown | None = None
        self.camera: MoveCamera | None = None
        self.waits_for: tuple[str, ...] = ()
        self._last: dict[type[Message], Message] = {}
        self._listeners: defaultdict[type[Message], list[Listener]] = defaultdict(list)
        self._numbers = count()
        self._has_ended = self._is_closing = False
        self._mailbox = Mailbox(self._mail_came.emit)
        self._second = PreviewKernel()
        self._mail_came.connect(self._deliver, Qt.ConnectionType.QueuedConnection)
        self.history = History(lambda steps: self._mailbox.put(_STEPS, steps))
        self._recorder: FlightRecorder | None = None
        self._engine = Engine(open_stage, self._mailbox.put, self._attend)
        self._garbage = GarbageOnQtThread(self)
        self._spare = SpareMemory(self)

    def start(self) -> None:
        """Open the host, in the background."""
        self._garbage.start()
        self._engine.start()

    def send(self, *inputs: Input) -> None:
        """Send inputs to the kernel; of waiting ones the latest of each key counts.

        They are undone as one step.
        """
        self.history.expect(inputs)
        self._bring(inputs)

    def begin_with(self, *inputs: Input) -> None:
        """Send inputs that cannot be undone, nor anything before them."""
        self.history.expect(inputs, beginning=True)
        self._bring(inputs)

    def begin_by(self, inputs_of: Callable[[Stage], Iterable[Input]]) -> None:
        """The same with inputs that are found on the engine's thread, and go in from there.

        At the start Qt's thread fills panels for half a second: the scene opens meanwhile.
        """

        def begin(stage: Stage) -> tuple[Input, ...]:
            inputs = tuple(inputs_of(stage))
            self.history.expect(inputs, beginning=True)
            self._engine.send(*inputs)
            return inputs

        self.ask(begin, self._tell_sent)

    def _bring(self, inputs: tuple[Input, ...]) -> None:
        self._engine.send(*inputs)
        self._tell_sent(inputs)

    def _tell_sent(self, inputs: tuple[Input, ...]) -> None:
        for message in inputs:
            self.sent.emit(message)

    def undo(self, then: Callable[[str], None] | None = None) -> None:
        """Undo the last step; `then` gets its title, empty if there was none."""
        self.follow(self._engine.ask(lambda stage: self.history.undo(), changes=True), then)

    def redo(self, then: Callable[[str], None] | None = None) -> None:
        """Redo the step that was undone last; `then` gets its title, empty if there was none."""
        self.follow(self._engine.ask(lambda stage: self.history.redo(), changes=True), then)

    @property
    def recorded(self) -> Recorded:
        """The extent of the session's recording."""
        return Recorded() if self._recorder is None else self._recorder.recorded

    def save_journal(
        self,
        path: str,
        then: Callable[[Recorded], None],
        failed: Callable[[str], None] | None = None,
    ) -> None:
        """Write the session's journal; the window goes on meanwhile."""

        def save(stage: Stage) -> "Future[Recorded]":
            if self._recorder is None:
                raise UserError("this session is not recorded")
            return self._recorder.save(path)

        self.ask(save, lambda answer: self.follow(answer, then, failed), failed)

    def listen(self, kind: type[M], listener: Callable[[M], None]) -> None:
        """Call `listener` with each message of a type, and at once with the latest if any."""
        self._listeners[kind].append(listener)
        last = self.last(kind)
        if last is not None:
            listener(last)

    def foretell(self, *messages: Message) -> None:
        """Let listeners hear what will hold once the host is open; does nothing thereafter."""
        if self.catalogue.modules:
            return
        for message in messages:
            self._last[type(message)] = message
            for listener in tuple(self._listeners[type(message)]):
                listener(message)

    def last(self, kind: type[M]) -> M | None:
        """The latest message of a type that was delivered on Qt's thread."""
        return self._last.get(kind)  # type: ignore[return-value]

    def meter_exposure(self) -> None:
        """Meter automatic exposure by a new picture."""
        self._engine.meter_exposure()

    def watch(self, watcher: Watcher | None) -> None:
        """Show the states of the scene to somebody else too, or to nobody."""
        self._engine.watch(watcher)

    def exposure_of(self, state: SceneState) -> SetExposure:
        """The exposure of the finished picture of a state; on the engine's thread."""
        return self._engine.exposure_of(state)

    def ask(
        self,
        question: Callable[[Stage], T],
        then: Callable[[T], None] | None = None,
        failed: Callable[[str], None] | None = None,
    ) -> None:
        """Call `question` on the engine's thread and `then` with the answer on Qt's.

        An error becomes a `problem`, or goes to `failed`, as a sentence.
        """
        self.follow(self._engine.ask(question), then, failed)

    def look_up(
        self,
        question: Callable[[PreviewKernel], T],
        then: Callable[[T], None],
        failed: Callable[[str], None] | None = None,
    ) -> None:
        """Like `ask`, but of the second kernel; does nothing after `close`."""
        if not self._is_closing:
            self.follow(self._second.ask(question), then, failed)

    def follow(
        self,
        answer: "Future[T]",
        then: Callable[[T], None] | None = None,
        failed: Callable[[str], None] | None = None,
    ) -> None:
        """Like `ask`, with a future that another thread completes."""

        def done(answer: "Future[T]") -> None:
            self._mailbox.put(("answer", next(self._numbers)), (answer, then, failed))

        answer.add_done_callback(done)

    def close(self) -> None:
        """Start to close; `ended` is emitted when all threads have ended."""
        self._engine.stop()
        self._begin_to_end()

    def join(self, timeout_s: float | None = None) -> bool:
        """Wait for the engine's end; False after the timeout. No signal comes after it."""
        came = self._engine.join(timeout_s)
        if came:
            self._mailbox.close()
            self._garbage.stop()
            self._spare.stop()
        return came

    @property
    def has_ended(self) -> bool:
        """Whether `ended` was emitted."""
        return self._has_ended

    @contextmanager
    def _attend(self, stage: Stage) -> Iterator[None]:
        """Write the session's history and its journal, on the engine's thread."""
        self.history.attach(stage.kernel)
        try:
            recorder = self._recorder = FlightRecorder(stage.kernel)
        except (UserError, OSError) as error:
            line = f"this session is not recorded: {error}"
            self._mailbox.put((revision_news.PROBLEM, "not recorded"), line)
            yield
            return
        with closing(recorder):
            yield

    def _deliver(self) -> None:
        for key, value in self._mailbox.take_all().items():
            kind = key[0] if isinstance(key, tuple) else key
            self._deliver_one(str(kind), value)

    def _deliver_one(self, kind: str, value: Any) -> None:
        if kind == revision_news.HEARD:
            self._hear(*value)
        elif kind == revision_news.PICTURE:
            self.shown = value
            self._spare.picture_shown()
            self.picture_shown.emit(value)
        elif kind == revision_news.WAITS:
            self.waits_for = value
            self.waits_changed.emit(value)
        elif kind == revision_news.CAMERA:
            self.camera = value
            self.camera_moved.emit(value)
        elif kind == _STEPS:
            self.steps_changed.emit(value)
        elif kind == revision_news.PROBLEM:
            self.problem.emit(one_line(value))
        elif kind == revision_news.READY:
            self.catalogue = value
            self.ready.emit(value)
        elif kind == revision_news.ENDED:
            self._has_ended = True
            self._begin_to_end()
            # Also of a session that nobody joins, as one whose host could not be opened.
            self._garbage.stop()
            self._spare.stop()
            self.ended.emit()
        else:
            self._take_answer(*value)

    def _hear(self, message: Message, sender: str) -> None:
        self._last[type(message)] = message
        self.catalogue.note(message)
        for listener in tuple(self._listeners[type(message)]):
            listener(message)
        self.heard.emit(message, sender)
        if isinstance(message, Fault):
            self.problem.emit(fault_line(message, self.title_of(message.module)))
        elif isinstance(message, ReloadModule):
            self.renew_roster()

    def title_of(self, module: str) -> str:
        """A module's title as people read it; its name if it is not loaded."""
        known = self.catalogue.modules.get(module)
        return f"module {module}" if known is None else known.title

    def renew_roster(self) -> None:
        """Ask the kernel for its modules again."""
        self.ask(catalogue_of, self._take_roster)

    def _take_roster(self, catalogue: ModuleCatalogue) -> None:
        self.catalogue = catalogue
        self.catalogue_renewed.emit()

    def _begin_to_end(self) -> None:
        self._is_closing = True
        self._second.close()
        self.closing.emit()

    def _take_answer(
        self,
        answer: "Future[Any]",
        then: Callable[[Any], None] | None,
        failed: Callable[[str], None] | None,
    ) -> None:
        try:
            result = answer.result()
        except CancelledError:
            return
        except BaseException as error:
            (failed or self.problem.emit)(one_line(sentence_of(error)))
            return
        if then is not None:
            then(result)


def fault_line(fault: Fault, title: str) -> str:
    """A fault in one line: the user's mistake, or the title of what failed and where."""
    if fault.for_user:
        return one_line(fault.error)
    fate = "; it is suspended: restart it, or go on without" if fault.suspended else ""
    return one_line(f"{title} failed in {fault.where}: {fault.error}{fate}")


def one_line(text: str) -> str:
    """The text without line breaks."""
    return " ".join(str(text).split())
