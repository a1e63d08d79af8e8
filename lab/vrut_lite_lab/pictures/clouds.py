"""Clouds of six genera at four hours, from the ground, from 10 km and from space, on one sheet.

    python -m vrut_lite_lab.pictures.clouds SHEET.jpg [HEIGHT ...]

Over the sundial, by bruneton_sky. `vrut-lite bench --only frame` measures what clouds cost.
"""

import sys
from collections.abc import Sequence
from typing import Any

from vrut_lite.project import CameraView, Project
from vrut_lite_lab.pictures.drawing import Captioned, scene_project, sheet, shots

SKIES: dict[str, dict[str, Any]] = {
    "cumulus": {"genus": "Cu"},
    "stratocumulus": {"genus": "Sc"},
    "cumulonimbus": {"genus": "Cb", "coverage": 0.35},
    "altocumulus": {"middle_genus": "Ac"},
    "cirrus": {"high_genus": "Ci"},
    "cirrostratus": {"high_genus": "Cs"},
}
TIMES = ("2026-06-21T05:40", "2026-06-21T10:00", "2026-06-21T20:40", "2026-06-21T21:30")
# Where the eye is and which way it looks, by height.
VIEWS = {
    "ground": ((1.5, 1.5, 3.4), (-1.0, 0.55, -1.0)),
    "10 km": ((1.5, 10_500.0, 3.4), (-1.0, -0.35, -1.0)),
    "400 km": ((1.5, 400_000.0, 3.4), (-1.0, -0.95, -1.0)),
}


def project_of(clouds: dict[str, Any], height: str) -> Project:
    """The sundial's lawn, the horizon or the limb in the picture."""
    eye_m, way = VIEWS[height]
    x, y, z = (eye + part for eye, part in zip(eye_m, way, strict=True))
    return scene_project(
        "sundial.toml",
        slots={"sky": "bruneton_sky"},
        settings={"clouds": clouds},
        camera=CameraView(eye_m=eye_m, target_m=(x, y, z), vertical_field_of_view_deg=65.0),
        size=(240, 150),
        at=TIMES[0],
    )


def captioned(heights: Sequence[str]) -> list[Captioned]:
    """All pictures, a genus a column."""
    by_genus = [
        [
            (f"{name}, {time[11:]}, {height}", shot.picture.display)
            for height in heights
            for time, shot in zip(TIMES, shots(project_of(clouds, height), TIMES), strict=True)
        ]
        for name, clouds in SKIES.items()
    ]
    return [picture for row in zip(*by_genus, strict=True) for picture in row]


if __name__ == "__main__":
    sheet(captioned(sys.argv[2:] or [*VIEWS]), len(SKIES)).save(sys.argv[1], quality=85)
