"""The message of a logged value, and the log as a file."""

import csv
import io
from collections.abc import Iterable
from datetime import datetime

import numpy as np
from vrut_lite import checks
from vrut_lite.geometry.colour import LUMENS_PER_WATT, luminance
from vrut_lite.geometry.spherical_harmonics import evaluate_irradiance
from vrut_lite.kernel.messages import Derived
from vrut_lite.messages.sky_light import SkyLightChanged

_UP = (0.0, 1.0, 0.0)


class LuxLogged(Derived, frozen=True, kw_only=True):
    """Illuminance of open level ground at an instant (UTC): all of it, and the sky's share, lx."""

    instant: datetime
    total_lx: float
    sky_lx: float

    def key(self) -> None:
        """Each value is delivered, also where several wait."""
        return

    def check(self) -> None:
        """A time, and light."""
        checks.instant(self, "instant")
        checks.number(self, "total_lx", 0.0, 1e9)
        checks.number(self, "sky_lx", 0.0, 1e9)


def level_ground_lx(light: SkyLightChanged) -> tuple[float, float]:
    """Illuminance of level ground, lx: by sun or moon and sky together, and by the sky alone."""
    key_light = light.key_light
    direct = np.array(key_light.irradiance_rgb) * max(key_light.direction[1], 0.0)
    sky = np.maximum(evaluate_irradiance(light.ambient.irradiance_sh_rgb.values, _UP), 0.0)
    sky_lx = LUMENS_PER_WATT * float(luminance(sky))
    return sky_lx + LUMENS_PER_WATT * float(luminance(direct)), sky_lx


def as_csv(values: Iterable[LuxLogged]) -> str:
    """The log as a table: time in UTC, lx in all, lx by the sky."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(["time_utc", "total_lx", "sky_lx"])
    for value in values:
        row = value.instant.isoformat(), f"{value.total_lx:.6g}", f"{value.sky_lx:.6g}"
        writer.writerow(row)
    return text.getvalue()
