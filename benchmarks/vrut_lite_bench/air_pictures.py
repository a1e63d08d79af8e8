"""Pictures of the air to look at: a land with and without it, fog, light shafts, the planet.

    python -m vrut_lite_bench.air_pictures FOLDER

Writes air_terrain.jpg (four hours, both skies, without air and with it), air_fog.jpg,
air_shafts.jpg and air_planet.jpg. The climb is drawn by `vrut_lite_bench.climb`.
"""

import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from types import MappingProxyType
from typing import Any, NamedTuple

import msgspec
import numpy as np
from numpy.typing import NDArray

from vrut_lite.commands.scene_pictures import ScenePlan
from vrut_lite.project import Project, load_project
from vrut_lite_bench.bruneton_pictures import sheet

SCENES = Path(__file__).resolve().parents[2] / "scenes"
SIZE, LARGE = (480, 270), (720, 405)
SKIES = {"dynamic_skylight": "Hosek-Wilkie", "bruneton_sky": "Bruneton"}
HOURS = ("06:30", "13:00", "19:00", "20:45")
_BRUNETON = "bruneton_sky"
_DAWN_FOG = {"fog_visibility_m": 800.0, "fog_height_m": 120.0}

Captioned = tuple[str, NDArray[np.uint8]]


class Shot(NamedTuple):
    """A project file's scene at an hour, and what is otherwise than the file has it."""

    caption: str
    scene: str
    at: str | None = None
    settings: Mapping[str, Any] = MappingProxyType({})
    changes: Mapping[str, Any] = MappingProxyType({})


def draw(shots: Sequence[Shot], size: tuple[int, int], sky: str = _BRUNETON) -> list[Captioned]:
    """The pictures, captioned with the sun's height."""
    drawn = []
    for shot in shots:
        project = project_of(shot, size, sky)
        studio = ScenePlan(project).open()
        try:
            taken = studio.shoot(project.instant())
        finally:
            studio.close()
        sun = f", sun {taken.metadata['sunElevationDeg']:.1f} deg"
        drawn.append((shot.caption + sun, taken.picture.display))
    return drawn


def project_of(shot: Shot, size: tuple[int, int], sky: str) -> Project:
    """What a shot draws under a sky."""
    project = load_project(SCENES / shot.scene)
    settings = dict(project.settings)
    settings[sky] = {**settings.get(sky, {}), **shot.settings}
    project = msgspec.structs.replace(
        project, size=size, slots={"sky": sky}, settings=settings, **shot.changes
    )
    return project if shot.at is None else msgspec.structs.replace(project, at=shot.at)


def terrain() -> list[Captioned]:
    """A row for each sky without and with air; four hours across."""
    pictures = []
    for sky, name in SKIES.items():
        for air in (False, True):
            told = "through air" if air else "no air"
            shots = [
                Shot(f"{name}, {hour}, {told}", "large/terrain.toml", f"2026-06-28T{hour}",
                     changes={"air": air})
                for hour in HOURS
            ]  # fmt: skip
            pictures += draw(shots, SIZE, sky)
    return pictures


def fog() -> list[Captioned]:
    """A street and the land at dawn, clear and in fog."""
    street, land = "2026-06-21T05:40", "2026-06-28T06:40"
    thick = {"fog_visibility_m": 150.0, "fog_height_m": 30.0}
    return draw(
        [
            Shot("street, clear", "street.toml", street),
            Shot("street, 150 m of fog, 30 m high", "street.toml", street, thick),
            Shot("land, clear", "large/terrain.toml", land),
            Shot("land, 800 m of fog, 120 m high", "large/terrain.toml", land, _DAWN_FOG),
        ],
        LARGE,
    )


def shafts() -> list[Captioned]:
    """A hall in mist and a valley in haze, without and with the shadows in their air."""
    hall, land = "large/hall.toml", "large/terrain.toml"
    dusk, haze = "2026-06-28T20:40", {"turbidity": 6.0}
    shown = {"light_shafts": True}
    return draw(
        [
            Shot("hall, no shafts", hall),
            Shot("hall, shafts", hall, changes=shown),
            Shot("land, turbidity 6, no shafts", land, dusk, haze),
            Shot("land, turbidity 6, shafts", land, dusk, haze, shown),
        ],
        LARGE,
    )


def planet() -> list[Captioned]:
    """400 km up, by day, and where the sun sets below."""
    hours = {"day": "2026-06-21T08:00", "low sun": "2026-06-21T05:10", "dusk": "2026-06-21T04:35"}
    shots = [Shot(name, "large/planet.toml", at) for name, at in hours.items()]
    return draw(shots, LARGE)


def main(folder: Path) -> None:
    """Write all sheets."""
    folder.mkdir(parents=True, exist_ok=True)
    sheets = {
        "terrain": (terrain, 4),
        "fog": (fog, 2),
        "shafts": (shafts, 2),
        "planet": (planet, 3),
    }
    for name, (pictures, columns) in sheets.items():
        sheet(pictures(), columns).save(folder / f"air_{name}.jpg", quality=85)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
