"""One valley in four aerosols at four hours: hazy horizons, and the glow about the sun.

    python -m vrut_lite_lab.pictures.air_types docs/pictures/air_types.webp

Rows are types of OPAC at their published depths. The camera looks west and up: at 18:00 the sun is
in view. Each picture is exposed by itself.
"""

import sys
from pathlib import Path

from vrut_lite.atmosphere.aerosols import type_optics
from vrut_lite.messages.haze import AerosolType
from vrut_lite.project import CameraView, Haze
from vrut_lite_lab.pictures.drawing import Captioned, scene_project, sheet, shots

_SIZE = (320, 220)
_TYPES: tuple[AerosolType, ...] = ("continental-average", "maritime-clean", "desert", "urban")
_HOURS = ("07:00", "13:25", "18:00", "20:45")
_WESTWARD = CameraView(
    eye_m=(-96.0, 514.0, 4.0), target_m=(-1096.0, 700.0, -50.0), vertical_field_of_view_deg=70.0
)


def pictures() -> list[Captioned]:
    """The hours of each type, a row each."""
    drawn: list[Captioned] = []
    for aerosol in _TYPES:
        depth = type_optics(aerosol).optical_depth_550
        project = scene_project(
            "large/terrain.toml",
            size=_SIZE,
            slots={"sky": "bruneton_sky"},
            # Open land: light between its slopes is not what differs here.
            settings={"light_transport": {"on": False}},
            haze=Haze(depth, aerosol),
            camera=_WESTWARD,
        )
        taken = shots(project, [f"2026-06-28T{hour}" for hour in _HOURS])
        for hour, shot in zip(_HOURS, taken, strict=True):
            drawn.append((f"{aerosol}, depth {depth:.2f}, {hour}", shot.picture.display))
    return drawn


if __name__ == "__main__":
    sheet(pictures(), len(_HOURS)).save(Path(sys.argv[1]), quality=82, method=6)
