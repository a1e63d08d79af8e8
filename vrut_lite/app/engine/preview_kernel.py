"""A second kernel for other hours and other skies, beside the window's own."""

from collections.abc import Callable, Mapping
from concurrent.futures import CancelledError, Future, ThreadPoolExecutor
from datetime import datetime
from functools import cached_property
from typing import TypeVar

from vrut_lite.daylight_kernel import FaultCollector
from vrut_lite.discovery import discover
from vrut_lite.kernel.bus import Kernel
from vrut_lite.kernel.messages import ChooseSlot, SetClock, SetSetting
from vrut_lite.messages.place import SetPlace
from vrut_lite.messages.sun import SunMoved

T = TypeVar("T")
_SLOTS = {"sun", "sky"}


class PreviewKernel:
    """Holds the modules that can provide the sun or the sky, and nothing that draws.

    Questions are answered one at a time on its own thread. Only questions may use `kernel`, which
    the first one makes, and the methods below `close`.
    """

    def __init__(self) -> None:
        self._thread = ThreadPoolExecutor(1, "vrut-lite second kernel")
        self._closed = False

    def ask(self, question: Callable[["PreviewKernel"], T]) -> "Future[T]":
        """Answer a question in the background; from any thread, before `close`."""
        return self._thread.submit(self._answer, question)

    def close(self) -> None:
        """Cancel all questions, the running one included."""
        if not self._closed:
            self._closed = True
            self._thread.submit(self._close_kernel)
            self._thread.shutdown(wait=False)

    def _answer(self, question: Callable[["PreviewKernel"], T]) -> T:
        if self._closed:
            raise CancelledError
        try:
            return question(self)
        finally:
            # Replaces the answer or the error of the question.
            if self._closed:
                raise CancelledError

    def _close_kernel(self) -> None:
        if "kernel" in self.__dict__:
            self.kernel.close()

    @cached_property
    def kernel(self) -> Kernel:
        """The kernel with its modules."""
        kernel = Kernel()
        for module in discover()[0]:
            if _SLOTS & set(module.manifest.provides) and not module.injects:
                kernel.add_module(module)
        return kernel

    @cached_property
    def faults(self) -> FaultCollector:
        """Faults since it was first asked for."""
        return FaultCollector(self.kernel)

    def set_up(
        self, place: SetPlace, sun_holder: str, settings: Mapping[tuple[str, str], object]
    ) -> None:
        """Set the place, the holder of the sun, and settings by module and name."""
        seats = self.kernel.seats
        if sun_holder in seats:
            self.kernel.inject(ChooseSlot(slot="sun", module=sun_holder))
        self.kernel.inject(place)
        for (module, name), value in settings.items():
            if module in seats and getattr(seats[module].settings, name, value) != value:
                self.kernel.inject(SetSetting(module=module, name=name, value=value))
        self.kernel.pump()

    def sun_at(self, instant: datetime) -> SunMoved | None:
        """The sun at an instant; None if no module holds the slot."""
        self.kernel.inject(SetClock(instant=instant))
        self.kernel.pump()
        return self.kernel.last(SunMoved)
