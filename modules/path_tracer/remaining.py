"""How long a picture will still take, by the paths that have come so far."""

from collections import deque

# Number of latest pictures that count: other work on the machine changes its speed.
_KEPT = 8
_SECONDS_A_MINUTE, _COARSE_FROM_S = 60.0, 10.0


class Remaining:
    """Estimates the remaining time from the arrival of pictures and their samples."""

    def __init__(self) -> None:
        self._seen: deque[tuple[float, int]] = deque(maxlen=_KEPT)

    def came(self, now_s: float, samples: int) -> None:
        """Count a picture; one with fewer samples than the last is a restart."""
        if self._seen and samples <= self._seen[-1][1]:
            self._seen.clear()
        self._seen.append((now_s, samples))

    def seconds(self, samples_wanted: int) -> float | None:
        """Seconds until the picture is finished; None before two pictures have come."""
        if len(self._seen) < 2:
            return None
        (first_s, first), (last_s, last) = self._seen[0], self._seen[-1]
        return max(0, samples_wanted - last) * (last_s - first_s) / (last - first)


def remaining_text(seconds: float | None) -> str:
    """A length of time as people say it; empty if it is unknown or over."""
    if seconds is None or seconds <= 0.0:
        return ""
    if seconds >= 2.0 * _SECONDS_A_MINUTE:
        return f"about {seconds / _SECONDS_A_MINUTE:.0f} min to go"
    if seconds >= _COARSE_FROM_S:
        return f"about {10.0 * round(seconds / 10.0):.0f} s to go"
    return "a few seconds to go"
