"""Pictures of the air: a valley with and without it, fog, light shafts, the planet.

    python -m vrut_lite_lab.pictures.air FOLDER

Writes air_terrain.jpg (four hours, both skies, without air and with it), air_fog.jpg,
air_shafts.jpg and air_planet.jpg. The climb is drawn by lab/vrut_lite_lab/pictures/climb.py.
"""

import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from types import MappingProxyType
from typing import Any, NamedTuple

from vrut_lite.project import Project
from vrut_lite_lab.pictures.drawing import SKIES, Captioned, scene_project, sheet, shots

SIZE, LARGE = (480, 270), (720, 405)
HOURS = ("06:30", "13:00", "19:00", "20:45")
_BRUNETON = "bruneton_sky"
_DAWN_FOG = {"fog_visibility_m": 800.0, "fog_height_m": 120.0}


class Shot(NamedTuple):
    """A project file's scene at a time, and what differs from that file."""

    caption: str
    scene: str
    at: str | None = None
    settings: Mapping[str, Any] = MappingProxyType({})
    changes: Mapping[str, Any] = MappingProxyType({})


def draw(wanted: Sequence[Shot], size: tuple[int, int], sky: str = _BRUNETON) -> list[Captioned]:
    """The pictures, captioned with the sun's height."""
    drawn: list[Captioned] = []
    for shot in wanted:
        project = project_of(shot, size, sky)
        (taken,) = shots(project, [project.at])
        sun = f", sun {taken.metadata['sunElevationDeg']:.1f} deg"
        drawn.append((shot.caption + sun, taken.picture.display))
    return drawn


def project_of(shot: Shot, size: tuple[int, int], sky: str) -> Project:
    """The project of a shot under a sky."""
    own = scene_project(shot.scene)
    settings = {**own.settings, sky: {**own.settings.get(sky, {}), **shot.settings}}
    changes = {"at": shot.at or own.at, "settings": settings, **shot.changes}
    return scene_project(shot.scene, size=size, slots={"sky": sky}, **changes)


def terrain() -> list[Captioned]:
    """Each sky without and with air, a row each, at four hours."""
    pictures = []
    for sky, name in SKIES.items():
        for air in (False, True):
            told = "through air" if air else "no air"
            wanted = [
                Shot(f"{name}, {hour}, {told}", "large/terrain.toml", f"2026-06-28T{hour}",
                     changes={"air": air})
                for hour in HOURS
            ]  # fmt: skip
            pictures += draw(wanted, SIZE, sky)
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
    """A hall in mist and a valley in haze, without and with light shafts."""
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
    wanted = [Shot(name, "large/planet.toml", at) for name, at in hours.items()]
    return draw(wanted, LARGE)


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
