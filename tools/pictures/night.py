"""Pictures of the night: a night over a street, Orion, the moon's phases, the eclipse of 2026.

    python -m tools.pictures.night FOLDER

Writes night.webp.
"""

import sys
from pathlib import Path

import numpy as np
from night_sky.moon import moon_at
from night_sky.sky_axes import watch
from PIL import Image

from tools.pictures.drawing import Captioned, scene_project, sheet, shots
from vrut_lite.project import CameraView, Exposure, Project, parse_place

WIDTH_PX = 1400
PRAGUE, BURGOS = "50.0755,14.4378,200", "42.34,-3.70,850"
# The moon rises two hours after sunset.
NIGHT = {
    "sunset": "2026-04-04T19:30",
    "nautical twilight": "2026-04-04T20:25",
    "moonrise": "2026-04-04T23:15",
    "deep night": "2026-04-12T01:00",
    "dawn": "2026-04-05T05:30",
}
# One lunation, and the exposure of each.
PHASES = {
    "2026-01-22T18:30": 9.0,
    "2026-01-26T20:00": 11.0,
    "2026-01-29T21:00": 12.0,
    "2026-02-01T23:00": 13.0,
    "2026-02-05T03:00": 12.0,
    "2026-02-09T05:00": 11.0,
    "2026-02-12T06:15": 9.0,
}
# Light between surfaces adds little by night, and takes long.
OPEN_SKY = {"light_transport": {"on": False}}
_EYE_M = (0.0, 60.0, 0.0)


def street() -> list[Captioned]:
    """One night, exposed automatically."""
    camera = CameraView(
        eye_m=(-1.2, 1.7, 16.0), target_m=(0.2, 6.2, -2.0), vertical_field_of_view_deg=64.0
    )
    project = scene_project(
        "street.toml", size=(280, 210), camera=camera, place=PRAGUE, settings=OPEN_SKY
    )
    taken = shots(project, list(NIGHT.values()))
    return [
        (f"{name}, EV {shot.picture.ev100:.1f}", shot.picture.display)
        for name, shot in zip(NIGHT, taken, strict=True)
    ]


def orion_and_eclipse() -> list[Captioned]:
    """Orion over the pavilion by starlight; the sun minutes before totality, and in it."""
    beside = CameraView(
        eye_m=(-1.0, 1.6, -15.0), target_m=(3.0, 8.6, 15.0), vertical_field_of_view_deg=66.0
    )
    stars = scene_project(
        "pavilion.gltf", size=(700, 460), camera=beside, place=PRAGUE, at="2026-01-15T22:00",
        exposure=Exposure(mode="manual", ev100=-7.5), settings=OPEN_SKY,
    )  # fmt: skip
    (taken,) = shots(stars, [stars.at])
    west = CameraView(
        eye_m=(14.0, 1.6, 2.0), target_m=(-15.0, 6.0, -3.6), vertical_field_of_view_deg=60.0
    )
    total = scene_project(
        "pavilion.gltf",
        size=(700, 460),
        camera=west,
        place=BURGOS,
        at="2026-08-12T20:29:10",
        settings=OPEN_SKY,
    )
    (dark,) = shots(total, [total.at])
    return [
        ("Orion over the pavilion, starlight, EV -7.5", taken.picture.display),
        (f"12 August 2026, Burgos, totality, EV {dark.picture.ev100:.1f}", dark.picture.display),
    ]


def moons() -> list[Captioned]:
    """The moon through a long lens, the right way up for Prague, and the eclipsed sun."""
    pictures = [_aimed(PRAGUE, at, Exposure(mode="manual", ev100=ev)) for at, ev in PHASES.items()]
    return [*pictures, _aimed(BURGOS, "2026-08-12T20:21", Exposure(mode="manual", ev100=22.0))]


def _aimed(place: str, at: str, exposure: Exposure) -> Captioned:
    """A picture of 0.8 deg around the moon."""
    project = Project(place=place, at=at)
    where = parse_place(place)
    moon = moon_at(watch(project.instant(), *where))
    target = tuple((np.add(_EYE_M, 1000.0 * moon.direction)).tolist())
    camera = CameraView(eye_m=_EYE_M, target_m=target, vertical_field_of_view_deg=1.0)
    project = scene_project(
        "pavilion.gltf",
        size=(175, 175),
        camera=camera,
        place=place,
        at=at,
        exposure=exposure,
        settings=OPEN_SKY,
    )
    (taken,) = shots(project, [at])
    return f"{at[5:10]}, {moon.lit_fraction:.0%} lit", taken.picture.display


def main(folder: str) -> None:
    """Draw the sheet."""
    rows = [sheet(street(), 5), sheet(orion_and_eclipse(), 2), sheet(moons(), 8)]
    paper = Image.new("RGB", (WIDTH_PX, sum(row.height for row in rows)))
    top = 0
    for row in rows:
        paper.paste(row, (0, top))
        top += row.height
    paper.save(Path(folder) / "night.webp", quality=82, method=6)


if __name__ == "__main__":
    main(sys.argv[1])
