"""The size of the next picture, so that pictures keep up while something moves."""

from typing import Literal

# At twenty pictures a second motion is smooth; the window's own work goes on beside.
QUICK_S = 0.05
# Shares of the window's size at which moving pictures are drawn; each needs its framebuffers.
SCALES = (1.0, 0.85, 0.7, 0.6, 0.5, 0.35, 0.25)
# Seconds without a change before the finished picture begins: an interruption costs the piece that
# is being drawn, which takes about as long.
REST_S = 0.15
_MEMORY = 0.5
_SLOWER = 2.0
# Share of the time that a larger size may take: its first picture takes longer than estimated.
_ROOM = 0.9
# Where no size is quick enough, the largest serves that takes so many times as long as the
# smallest: what a picture takes whatever its size is not saved by a coarse one.
_WORTH = 1.15

# A finished picture; one that is drawn whole; one that reuses pixels of the one before, under the
# same light or another.
Kind = Literal["still", "anew", "taken over", "taken over, relit"]
# Share of the time that triangles and calls take, whatever the size, and the power of the scale
# that the rest grows by: pixels, or where all but edges is taken over the length of edges. Without
# the former a small picture would count as slow, and stay small.
_TIME: dict[Kind, tuple[float, int]] = {
    "still": (0.2, 2),
    "anew": (0.2, 2),
    "taken over": (0.1, 1),
    "taken over, relit": (0.55, 1),
}


class Pacing:
    """Estimates from each picture the time of one of its kind and full size."""

    def __init__(self) -> None:
        self._full_s: dict[Kind, float] = {}
        self._expected_s = 0.0
        # Scale of the last picture of each kind.
        self._scale: dict[Kind, float] = {}

    def expect(self, seconds: float) -> None:
        """Guess the time of a full picture of a kind that was not drawn yet."""
        self._expected_s = seconds

    def quick_scale(self, kind: Kind = "anew") -> float:
        """The largest scale at which a picture is expected in time, or hardly later than any."""
        now = self._scale.get(kind, 1.0)
        limit_s = max(QUICK_S, _WORTH * self.expected_s(SCALES[-1], kind))

        def in_time(scale: float) -> bool:
            return self.expected_s(scale, kind) <= limit_s * (_ROOM if scale > now else 1.0)

        return next(filter(in_time, SCALES), SCALES[-1])

    def expected_s(self, scale: float, kind: Kind) -> float:
        """How long a picture of this scale is expected to take."""
        return self._full_s.get(kind, self._expected_s) * _share_of_time(scale, kind)

    def drew(self, scale: float, seconds: float, kind: Kind = "anew") -> None:
        """Learn from the time of a picture of this scale."""
        before, self._scale[kind] = self._scale.get(kind, scale), scale
        # The first one of another size takes less over than the next will.
        if kind.startswith("taken over") and scale != before:
            return
        full_s = seconds / _share_of_time(scale, kind)
        # A far quicker picture is believed: the one before compiled shaders.
        known_s = min(self._full_s.get(kind, full_s), _SLOWER * full_s)
        self._full_s[kind] = (1.0 - _MEMORY) * known_s + _MEMORY * full_s


def _share_of_time(scale: float, kind: Kind) -> float:
    """The time of a picture of this scale, of one of full size."""
    fixed, power = _TIME[kind]
    return float(fixed + (1.0 - fixed) * scale**power)


def scaled(size: tuple[int, int], scale: float) -> tuple[int, int]:
    """Width and height at a scale, never below 16 pixels."""
    width, height = (max(16, round(side * scale)) for side in size)
    return width, height
