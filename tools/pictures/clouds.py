"""Clouds of three coverages at noon and at dusk, on one sheet.

    python -m tools.pictures.clouds SHEET.jpg

A valley of the Alps from the ground, bruneton_sky at turbidity 3, a west wind.
`vrut-lite bench --only frame` measures what their passes cost.
"""

import sys

from tools.pictures.drawing import Captioned, scene_project, sheet, shots
from vrut_lite.project import CameraView, Project

COVERAGES = (0.25, 0.5, 0.8)
TIMES = {"noon": "2026-06-28T13:00", "dusk": "2026-06-28T20:40"}
_SKY = "bruneton_sky"


def project_of(coverage: float) -> Project:
    """The valley, the camera a little above the horizon."""
    valley = scene_project("large/terrain.toml").camera
    assert valley is not None
    eye = valley.eye_m
    target = (eye[0] - 1000.0, eye[1] + 130.0, eye[2] - 50.0)
    return scene_project(
        "large/terrain.toml",
        slots={"sky": _SKY},
        settings={_SKY: {"turbidity": 3.0}, "clouds": {"base_m": 2300.0, "coverage": coverage}},
        camera=CameraView(eye_m=eye, target_m=target, vertical_field_of_view_deg=50.0),
        size=(480, 300),
        at=TIMES["noon"],
    )


def captioned() -> list[Captioned]:
    """All pictures, a time of day a row."""
    by_coverage = [
        [
            (f"{name}, {time[11:]}, coverage {coverage:g}", shot.picture.display)
            for (name, time), shot in zip(
                TIMES.items(), shots(project_of(coverage), list(TIMES.values())), strict=True
            )
        ]
        for coverage in COVERAGES
    ]
    return [picture for row in zip(*by_coverage, strict=True) for picture in row]


if __name__ == "__main__":
    sheet(captioned(), len(COVERAGES)).save(sys.argv[1], quality=85)
