"""Where a pointing hand would teleport to."""

from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor

from vrut_lite.app.headset.standing import FirstHit, RoomPose, teleport_target
from vrut_lite.numeric_types import FloatArray


class Aim:
    """Finds the target of a hand beside the frames: rays in a large scene take longer than one.

    `target_m` is the latest target (3,), None where the hand points at no place to stand on.
    """

    def __init__(self) -> None:
        self._worker = ThreadPoolExecutor(1, "vrut-lite aim")
        self._found: Future[FloatArray | None] | None = None
        self.target_m: FloatArray | None = None

    def point(self, hand: RoomPose, first_hit: Callable[[], FirstHit]) -> None:
        """Aim by a hand (in world axes); `first_hit` gives the scene's rays, on another thread."""
        if self._found is not None and self._found.done():
            self._take()
        if self._found is None:
            self._found = self._worker.submit(lambda: teleport_target(hand, first_hit()))

    def release(self) -> FloatArray | None:
        """The target at last; nothing is aimed at thereafter."""
        if self._found is not None:
            self._take()
        target_m, self.target_m = self.target_m, None
        return target_m

    def close(self) -> None:
        """End the thread, without waiting for it."""
        self._worker.shutdown(wait=False, cancel_futures=True)

    def _take(self) -> None:
        assert self._found is not None
        self.target_m, self._found = self._found.result(), None
