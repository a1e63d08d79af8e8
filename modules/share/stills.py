"""Pictures of four hours, for browsers that cannot draw the living scene."""

from datetime import timedelta

import msgspec
import numpy as np

from share.shared_page import webp
from vrut_lite.headless import Project, ScenePlan
from vrut_lite.place_time import time_zone_at

SIZE_PX = (640, 360)
# Times of the project's day: of its clock.
HOURS = (7.0, 12.5, 17.0, 20.0)


def stills_of(project: Project) -> list[tuple[str, bytes]]:
    """Captions and WebP pictures of the project's day."""
    midnight = project.instant().astimezone(time_zone_at(project.where()))
    plan = ScenePlan(msgspec.structs.replace(project, size=SIZE_PX, shows="picture"))
    studio = plan.open()
    try:
        found = []
        for hour in HOURS:
            at = midnight.replace(hour=0, minute=0, second=0) + timedelta(hours=hour)
            shot = studio.shoot(at)
            found.append((f"{at:%d %B, %H:%M}", webp(np.asarray(shot.picture.display))))
        return found
    finally:
        studio.close()
