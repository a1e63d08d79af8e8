"""News from the engine's thread: told at once, or with the revision that pictures show."""

from collections import deque
from collections.abc import Callable, Hashable
from itertools import count
from typing import Any

from vrut_lite.app.engine.adaptation import LISTENED_TO
from vrut_lite.foreign_errors import sentence_of
from vrut_lite.kernel.messages import KERNEL_MESSAGES, Derived, Message

# Kinds of news: the first parts of the keys that `tell` gets.
READY, HEARD, PICTURE, CAMERA, WAITS, PROBLEM, ENDED = (
    "ready", "heard", "picture", "camera", "waits", "problem", "ended",
)  # fmt: skip
# Messages that wait for the next picture's exposure, as those of a clock that plays.
_MOST_HEARD = 1000


class RevisionNews:
    """Holds back derived messages until their revision is whole; used on one thread.

    `tell(key, value)` must be quick.
    """

    def __init__(self, tell: Callable[[Hashable, Any], None], now_s: Callable[[], float]):
        self.tell = tell
        self._now_s = now_s
        self._numbers = count()
        # By key: the latest message of a revision that is not whole yet, and its sender.
        self._withheld: dict[Hashable, tuple[Message, str]] = {}
        self._heard: deque[tuple[Message, float]] = deque(maxlen=_MOST_HEARD)
        self._published: deque[tuple[Message, float]] = deque(maxlen=_MOST_HEARD)
        # As told last.
        self._waits_for: tuple[str, ...] = ()
        self._camera: Any = None

    def hear(self, message: Message, sender: str) -> None:
        """Receive a message that the kernel delivers."""
        if isinstance(message, LISTENED_TO):
            self._heard.append((message, self._now_s()))
        key = message.key()
        news = (HEARD, type(message), next(self._numbers) if key is None else key)
        if isinstance(message, Derived) and not isinstance(message, KERNEL_MESSAGES):
            self._withheld.pop(news, None)
            self._withheld[news] = message, sender
        else:
            self.tell(news, (message, sender))

    def publish(self) -> None:
        """Tell what belongs to the revision that pictures show from now on."""
        for key, value in self._withheld.items():
            self.tell(key, value)
        self._withheld.clear()
        self._published += self._heard
        self._heard.clear()

    def take_published(self) -> list[tuple[Message, float]]:
        """Messages by which the next picture's exposure is chosen, and when they came."""
        published = list(self._published)
        self._published.clear()
        return published

    def waits_for(self, modules: tuple[str, ...]) -> None:
        """Tell which modules the present revision waits for, if they are others than before."""
        if modules != self._waits_for:
            self._waits_for = modules
            self.tell(WAITS, modules)

    def camera_is(self, camera: Any) -> None:
        """Tell the camera of the state, if it is another than before."""
        if camera is not None and camera is not self._camera:
            self._camera = camera
            self.tell(CAMERA, camera)

    def problem(self, error: BaseException | str) -> None:
        """Tell an error in the host, or a sentence about one."""
        sentence = error if isinstance(error, str) else sentence_of(error)
        self.tell((PROBLEM, next(self._numbers)), sentence)
