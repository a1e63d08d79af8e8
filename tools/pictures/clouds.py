"""Clouds of six genera at three hours, on one sheet.

    python -m tools.pictures.clouds SHEET.jpg

From beside the sundial, by bruneton_sky. `vrut-lite bench --only frame` measures what clouds cost.
"""

import sys
from typing import Any

from tools.pictures.drawing import Captioned, scene_project, sheet, shots
from vrut_lite.project import CameraView, Project

SKIES: dict[str, dict[str, Any]] = {
    "cumulus": {"genus": "Cu"},
    "stratocumulus": {"genus": "Sc"},
    "cumulonimbus": {"genus": "Cb", "coverage": 0.35},
    "altocumulus": {"middle_genus": "Ac"},
    "cirrus": {"high_genus": "Ci"},
    "cirrostratus": {"high_genus": "Cs"},
}
TIMES = ("2026-06-21T05:40", "2026-06-21T10:00", "2026-06-21T20:40")
EYE_M, UPWARD_M = (1.5, 1.5, 3.4), (-1.0, 0.55, -1.0)


def project_of(clouds: dict[str, Any]) -> Project:
    """The sundial's lawn, the camera a little above the horizon."""
    x, y, z = (eye + way for eye, way in zip(EYE_M, UPWARD_M, strict=True))
    return scene_project(
        "sundial.toml",
        slots={"sky": "bruneton_sky"},
        settings={"clouds": clouds},
        camera=CameraView(eye_m=EYE_M, target_m=(x, y, z), vertical_field_of_view_deg=65.0),
        size=(240, 150),
        at=TIMES[0],
    )


def captioned() -> list[Captioned]:
    """All pictures, a genus a column."""
    by_genus = [
        [
            (f"{name}, {time[11:]}", shot.picture.display)
            for time, shot in zip(TIMES, shots(project_of(clouds), TIMES), strict=True)
        ]
        for name, clouds in SKIES.items()
    ]
    return [picture for row in zip(*by_genus, strict=True) for picture in row]


if __name__ == "__main__":
    sheet(captioned(), len(SKIES)).save(sys.argv[1], quality=85)
