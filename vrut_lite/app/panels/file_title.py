"""Names for files written from the window."""

import re
from datetime import datetime
from pathlib import Path

from vrut_lite.app.engine.session import Session
from vrut_lite.app.engine.sun_day_finder import place_of
from vrut_lite.app.panels.place_panel import name_of
from vrut_lite.kernel.messages import ClockMoved
from vrut_lite.messages.place import SetPlace
from vrut_lite.messages.scene import SceneOpened
from vrut_lite.place_time import time_zone_at
from vrut_lite.quantities import DEGREE

_NOT_IN_NAMES = re.compile(r'[\\/:*?"<>|\x00-\x1f]+')


def file_title(session: Session) -> str:
    """Scene, place, date and local hour: "street Prague 2026-06-21 18.40.00"."""
    clock = session.last(ClockMoved)
    title = scene_and_place(session)
    return title if clock is None else f"{title} {local_text(session, clock.instant)}"


def scene_and_place(session: Session) -> str:
    """The scene's name and the place's, without what file systems refuse."""
    scene, place = session.last(SceneOpened), session.last(SetPlace)
    parts = [Path(scene.path).stem if scene is not None else "picture"]
    if place is not None:
        # The name alone for a city, the coordinates for other places.
        name = name_of(place)
        parts.append(name if DEGREE in name else name.partition(",")[0])
    return " ".join(_NOT_IN_NAMES.sub(" ", part).strip() for part in parts)


def local_text(session: Session, instant: datetime) -> str:
    """Date and hour at the place, with dots, since not all file systems take colons."""
    place = session.last(SetPlace)
    zone = None if place is None else time_zone_at(place_of(place))
    return f"{instant.astimezone(zone):%Y-%m-%d %H.%M.%S}"
