"""How large the next picture may be, so that pictures keep up with a hand that moves."""

# Nine pictures a second still feel like moving a camera, not like changing slides.
QUICK_S = 0.11
# Few sizes, for each one needs framebuffers of its own.
SCALES = (1.0, 0.7, 0.5, 0.35, 0.25)
# Where nothing has changed for so long the hand rests, and the picture is finished: later where
# that takes long, for it is given up for a hand that moves on, a piece too late.
_SHORTEST_REST_S, _LONGEST_REST_S = 0.15, 0.5
_REST_SHARE = 0.3
_MEMORY = 0.5


class Pacing:
    """Learns from each picture what one of full size takes."""

    def __init__(self) -> None:
        self._full_s = 0.0

    def quick_scale(self) -> float:
        """The largest scale at which a picture is expected in time, or the smallest that is."""
        return next((s for s in SCALES if self._full_s * s * s <= QUICK_S), SCALES[-1])

    def rest_s(self) -> float:
        """How long a hand is to rest before the picture is finished."""
        return min(max(_REST_SHARE * self._full_s, _SHORTEST_REST_S), _LONGEST_REST_S)

    def drew(self, scale: float, seconds: float) -> None:
        """A picture of this scale took so long."""
        full_s = seconds / scale**2
        known = self._full_s > 0.0
        self._full_s = (1.0 - _MEMORY) * self._full_s + _MEMORY * full_s if known else full_s


def scaled(size: tuple[int, int], scale: float) -> tuple[int, int]:
    """Width and height at a scale, never below 16 pixels."""
    width, height = (max(16, round(side * scale)) for side in size)
    return width, height
