"""The moon's part of a civil day: its path, and when it is up."""

from dataclasses import dataclass
from datetime import datetime

import numpy as np
from numpy.typing import NDArray

from vrut_lite.app.engine.day import Day
from vrut_lite.messages.moon_path import MoonPathChanged


@dataclass(frozen=True)
class MoonDay:
    """The moon of one day.

    Attributes:
        direction: (n, 3) apparent, world axes, at the instants of the day's samples.
        marks: instants of `moonrise` and `moonset` within the day.
        up: shares of the day from and to which the moon is up.
    """

    direction: NDArray[np.float64]
    marks: dict[str, datetime]
    up: list[tuple[float, float]]


def moon_of(day: Day, path: MoonPathChanged) -> MoonDay | None:
    """The moon of a day; None where the path does not reach over it."""
    offset_s = (day.start - path.start).total_seconds()
    length_s = (path.direction.shape[0] - 1) * path.step_s
    if offset_s < 0.0 or offset_s + day.length_s > length_s:
        return None
    seconds = np.arange(path.direction.shape[0]) * path.step_s
    direction = np.stack(
        [np.interp(day.seconds + offset_s, seconds, axis) for axis in path.direction.values.T],
        axis=-1,
    )
    marks = {
        name: instant
        for name, instants in (("moonrise", path.rises_s), ("moonset", path.sets_s))
        for instant in path.instants(instants)
        if day.start <= instant < day.end
    }
    return MoonDay(direction, marks, _up(day, marks, bool(direction[0, 1] > 0.0)))


def _up(day: Day, marks: dict[str, datetime], is_up: bool) -> list[tuple[float, float]]:
    up, since = [], 0.0
    for name, instant in sorted(marks.items(), key=lambda mark: mark[1]):
        share = day.share_of(instant)
        if name == "moonset":
            up.append((since, share))
        is_up, since = name == "moonrise", share
    if is_up:
        up.append((since, 1.0))
    return up
