"""Every scene under both skies at the same haze, morning, noon and dusk, on one sheet.

    python -m vrut_lite_bench.scene_pictures SHEET.jpg [FOLDER]

Prague, 21 June, turbidity 3 and ground of albedo 0.1 for both. Each picture is what `vrut-lite
render SCENE --at HOUR --sky MODULE --turbidity 3 --albedo 0.1 --size 480x300` writes; with a
FOLDER they are kept there at that size.
"""

import sys
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

from vrut_lite.commands.scene_pictures import ScenePlan
from vrut_lite.project import Project, load_project

SCENES = Path(__file__).resolve().parents[2] / "scenes"
DRAWN = (
    "sundial.toml",
    "street.toml",
    "spheres.glb",
    "pavilion.gltf",
    "work/room.glb",
    "work/indoor.glb",
    "work/ground.glb",
    "work/planet.glb",
)
SKIES = {"dynamic_skylight": "Hosek-Wilkie", "bruneton_sky": "Bruneton"}
HOURS = ("07:00", "12:30", "21:10")
_DAY, _PLACE = "2026-06-21", "50.0755,14.4378,200"
_TURBIDITY, _ALBEDO = 3.0, 0.1
_SIZE, _THUMBNAIL, _CAPTION_PX = (480, 300), (320, 200), 18


class Drawn(NamedTuple):
    """A picture (300, 480, 3) of 8 bits, and what is written above it."""

    name: str
    caption: str
    display: NDArray[np.uint8]


def project_of(scene: str, sky: str) -> Project:
    """The scene under a sky, at the first hour."""
    path = SCENES / scene
    project = load_project(path) if path.suffix == ".toml" else Project(scene=str(path))
    return Project(
        scene=project.scene,
        camera=project.camera,
        place=_PLACE,
        at=f"{_DAY}T{HOURS[0]}",
        slots={"sky": sky},
        settings={sky: {"turbidity": _TURBIDITY, "albedo": _ALBEDO}},
        size=_SIZE,
    )


def draw(scene: str, sky: str) -> Iterator[Drawn]:
    """The scene's pictures at all hours."""
    project = project_of(scene, sky)
    studio = ScenePlan(project).open()
    try:
        for hour in HOURS:
            at = Project(place=_PLACE, at=f"{_DAY}T{hour}").instant()
            shot = studio.shoot(at)
            sun, name = shot.metadata["sunElevationDeg"], Path(scene).stem
            ev100 = shot.picture.ev100
            caption = f"{name} {hour}, sun {sun:.1f}°, {SKIES[sky]}, EV {ev100:.1f}"
            file_name = f"{name}_{hour.replace(':', '')}_{sky}"
            yield Drawn(file_name, caption, shot.picture.display)
    finally:
        studio.close()


def pairs(scene: str) -> list[Drawn]:
    """One row of the sheet: for each hour the one sky, then the other."""
    by_sky = [list(draw(scene, sky)) for sky in SKIES]
    return [drawn for hour in zip(*by_sky, strict=True) for drawn in hour]


def sheet(rows: list[list[Drawn]]) -> Image.Image:
    """All pictures, captioned, a scene a row."""
    width, height = _THUMBNAIL
    pitch = height + _CAPTION_PX
    paper = Image.new("RGB", (width * len(rows[0]), pitch * len(rows)), (24, 24, 24))
    pen, font = ImageDraw.Draw(paper), ImageFont.load_default(12)
    for i, row in enumerate(rows):
        for j, drawn in enumerate(row):
            small = Image.fromarray(drawn.display).resize(_THUMBNAIL, Image.Resampling.LANCZOS)
            paper.paste(small, (j * width, i * pitch + _CAPTION_PX))
            pen.text((j * width + 4, i * pitch + 2), drawn.caption, (230, 230, 230), font=font)
    return paper


def main(path: Path, folder: Path | None) -> None:
    """Draw all, and write the sheet."""
    rows = []
    for scene in DRAWN:
        rows.append(pairs(scene))
        for drawn in rows[-1] if folder else []:
            Image.fromarray(drawn.display).save(folder / f"{drawn.name}.png")
        print(scene, flush=True)
    sheet(rows).save(path, quality=80)


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]) if len(sys.argv) > 2 else None)
