"""Hours of sun of a day at sensors, by rays towards the sun."""

from datetime import datetime, timedelta

import numpy as np

from light_transport.daylight_numbers.now import sun_shares
from light_transport.daylight_numbers.opened_scene import OpenedScene
from light_transport.daylight_numbers.work import Work
from vrut_lite.numeric_types import FloatArray

STEP_MINUTES = 10


def sun_hours(work: Work, opened: OpenedScene, midnight: datetime) -> FloatArray:
    """Hours (P,) of the day from midnight in which the sun shines on the side that a sensor faces.

    Whatever passes of it through glass counts in full.
    """
    opened.coarser()
    towards = []
    for step in range(24 * 60 // STEP_MINUTES):
        opened.go_to(midnight + timedelta(minutes=(step + 0.5) * STEP_MINUTES))
        if opened.sun.elevation_rad > 0.0:
            towards.append(opened.sun.direction)
    if not towards:
        return np.zeros(len(work.sensors))
    directions = np.array(towards, float)
    seen = sun_shares(work.bake, work.glass, work.sensors, directions).any(axis=2)
    return np.asarray(seen.sum(axis=1) * (STEP_MINUTES / 60.0))
