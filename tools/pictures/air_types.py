"""One valley in four aerosols at four hours: hazy horizons, and the glow about the sun.

    python -m tools.pictures.air_types docs/pictures/air_types.webp

Rows are types of OPAC at their published depths; at 18:00 the camera looks up to the sun. Pictures
of an hour have one exposure, the first row's automatic one.
"""

import sys
from pathlib import Path

import msgspec

from tools.pictures.drawing import Captioned, scene_project, sheet, shots
from vrut_lite.daylight.aerosols import type_optics
from vrut_lite.daylight.haze import AerosolType
from vrut_lite.project import Exposure, Haze, Project

_SIZE = (400, 225)
_TYPES: tuple[AerosolType, ...] = ("continental-average", "maritime-clean", "desert", "urban")
_HOURS = ("07:00", "13:25", "18:00", "20:50")
_TO_THE_SUN = "18:00"
_SUNNY_TARGET_M = (-1096.0, 1130.0, -20.0)


def pictures() -> list[Captioned]:
    """The hours of each type, a row each."""
    exposures: dict[str, Exposure] = {}
    drawn: list[Captioned] = []
    for aerosol in _TYPES:
        depth = type_optics(aerosol).optical_depth_550
        for hour in _HOURS:
            project = _project(Haze(depth, aerosol), hour, exposures.get(hour, Exposure()))
            (taken,) = shots(project, [project.at])
            exposures.setdefault(hour, Exposure(mode="manual", ev100=taken.picture.ev100))
            drawn.append((f"{aerosol}, depth {depth:.2f}, {hour}", taken.picture.display))
    return drawn


def _project(haze: Haze, hour: str, exposure: Exposure) -> Project:
    own = scene_project("large/terrain.toml")
    camera = own.camera
    assert camera is not None
    if hour == _TO_THE_SUN:
        camera = msgspec.structs.replace(camera, target_m=_SUNNY_TARGET_M)
    return msgspec.structs.replace(
        own,
        at=f"2026-06-28T{hour}",
        size=_SIZE,
        slots={"sky": "bruneton_sky"},
        haze=haze,
        exposure=exposure,
        camera=camera,
    )


if __name__ == "__main__":
    sheet(pictures(), len(_HOURS)).save(Path(sys.argv[1]), quality=82, method=6)
