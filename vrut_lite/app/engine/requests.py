"""Inputs, questions and the end: what other threads want of the engine, and what wakes it."""

import threading
from collections import deque
from collections.abc import Callable
from concurrent.futures import Future
from typing import TypeVar

from vrut_lite.app.engine.stage import Stage
from vrut_lite.kernel.bus import Kernel
from vrut_lite.kernel.messages import Input

T = TypeVar("T")


class Requests:
    """Requests of other threads; only `send`, `ask` and `end` are called there.

    Attributes:
        awake: set by whatever the engine must look at.
        moved_on: set by a new input, an undo or the end: a finished picture is given up.
        sent: set by a new input alone.
        ending: set by the end.
    """

    def __init__(self) -> None:
        self.awake = threading.Event()
        self.moved_on = threading.Event()
        self.sent = threading.Event()
        self.ending = threading.Event()
        self._lock = threading.Lock()
        # Inputs that were sent before there was a kernel.
        self._early: list[Input] = []
        self._inject: Callable[..., None] = lambda *inputs: self._early.extend(inputs)
        self._questions: deque[tuple[Callable[[Stage], object], Future[object]]] = deque()

    def send(self, *inputs: Input) -> None:
        """Send inputs to the kernel, also before there is one."""
        with self._lock:
            self._inject(*inputs)
        if inputs:
            self.sent.set()
        self._move_on()

    def ask(self, question: Callable[[Stage], T], changes: bool) -> "Future[T]":
        """Queue a question; one that `changes` something ends a finished picture."""
        answer: Future[T] = Future()
        self._questions.append((question, answer))  # type: ignore[arg-type]
        if changes:
            self.moved_on.set()
        self.awake.set()
        if self.ending.is_set():
            answer.cancel()
        return answer

    def end(self) -> None:
        """Let the engine end soon."""
        self.ending.set()
        self._move_on()

    def connect(self, kernel: Kernel) -> None:
        """Send inputs to this kernel from now on, first those that were sent before."""
        kernel.on_inject(self.awake.set)
        with self._lock:
            self._inject = kernel.inject
            self._inject(*self._early)
        self.awake.set()

    @property
    def questions(self) -> int:
        """Number of questions without an answer."""
        return len(self._questions)

    def answer(self, stage: Stage, count: int) -> None:
        """Answer the first questions."""
        for _ in range(count):
            question, answer = self._questions.popleft()
            if not answer.set_running_or_notify_cancel():
                continue
            try:
                answer.set_result(question(stage))
            except BaseException as error:
                answer.set_exception(error)

    def cancel(self) -> None:
        """End: no question gets an answer any more."""
        self.ending.set()
        for _, answer in self._questions:
            answer.cancel()

    def _move_on(self) -> None:
        self.moved_on.set()
        self.awake.set()
