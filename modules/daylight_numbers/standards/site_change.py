"""Losses of daylight by a new building: windows, rooms and gardens before and after it.

Littlefair, King, Howlett, Ticleanu and Longfield 2022, "Site layout planning for daylight and
sunlight", BRE 209, third edition: a loss is noticeable where the vertical sky component falls below
27 % and 0.8 times its former value (2.2); where the area of the working plane that sees some sky
falls below 0.8 times the former one (the no-sky line, 2.2); where probable sunlight hours fall
below 25 % in the year or 5 % in winter, and below 0.8 times their former value, by more than 4 % of
the year's (3.2); and in gardens where less than half of the area has two hours of sun on 21 March,
and less than 0.8 times the former area (3.3).

Both scenes have the same axes and hold the existing building; its windows and sensors are found in
the scene after the change and looked at from the same places before it.
"""

from collections.abc import Collection, Mapping
from datetime import date
from typing import NamedTuple

import numpy as np
from light_transport.public import Surfaces, Tree, surfaces_of, tree_of

from daylight_numbers.glazing.glass import glass_of
from daylight_numbers.rooms import DaylitRoom
from daylight_numbers.standards.sun_days import SunSteps, sun_steps
from daylight_numbers.standards.windows import (
    ShutScene,
    SunnyHours,
    WindowLight,
    lit_windows,
    shut_scene,
)
from daylight_numbers.work import DaylightWork
from daylight_numbers.year.year_light import YEAR
from vrut_lite.errors import UserError
from vrut_lite.messages.glazing import Glazing
from vrut_lite.messages.place import SetPlace
from vrut_lite.messages.scene import SceneOpened
from vrut_lite.numeric_types import BoolArray, FloatArray

# BRE 209, 3.3: hours of sun of a garden, on this day of YEAR.
GARDEN_H = 2.0
_GARDEN_DAY = date(YEAR, 3, 21)
_UPWARDS = np.array([[0.0, 1.0, 0.0]])
# Directions in which the sky is looked for: so many around, and so many between horizon and zenith.
_AROUND, _RISING = 72, 180
_SAME_M = 0.05
# Rays start so far off the sensors' plane.
_OFF_M = 1e-4


class SiteScene(NamedTuple):
    """A scene with opaque panes, for windows and gardens, and with panes as openings, for the sky
    that rooms see."""

    shut: ShutScene
    opened: ShutScene


class RoomSky(NamedTuple):
    """Share of a room's working plane that sees some sky, before and after."""

    before: float
    after: float


class GardenSun(NamedTuple):
    """Share of a garden with two hours of sun on 21 March, before and after; before is None where
    no other scene is given."""

    before: float | None
    after: float


class SiteChange(NamedTuple):
    """The state before, by the number of a work plane: windows in the order of `windows_of`, skies
    of rooms, and gardens."""

    windows: Mapping[int, list[WindowLight]]
    skies: Mapping[int, RoomSky]


def scene_of_work(work: DaylightWork) -> SiteScene:
    """The scene that was made ready."""
    shut, clear = shut_scene(work), work.glass.clear
    if work.operator.panes is not None:
        clear = clear | (work.operator.panes.materials.of_triangle >= 0)
    return SiteScene(shut, shut._replace(tree=_with_opacity(work.transport.tree, clear, 0.0)))


def scene_of(
    scene: SceneOpened, glazing: Mapping[str, Glazing], measured: Collection[str] = ()
) -> SiteScene:
    """Another scene, of which no light is computed; `measured` are materials of measured panes.

    Raises:
        UserError: it has no surfaces, or no material of a name of `glazing`.
    """
    if not scene.triangles:
        raise UserError("--before: the scene has no surfaces")
    surfaces: Surfaces = surfaces_of(scene)
    tree, materials = tree_of(surfaces), scene.materials.all()
    is_pane = [
        materials[scene.geometry.mesh(mesh).material].name in measured
        for mesh in scene.geometry.part_mesh.values.tolist()
    ]
    # The last stands for the ground, whose part is -1.
    clear = glass_of(scene, surfaces, glazing).clear | np.array([*is_pane, False])[surfaces.part]
    shut, opened = (
        ShutScene(_with_opacity(tree, clear, share), surfaces.centre_m, surfaces.radius_m)
        for share in (1.0, 0.0)
    )
    return SiteScene(shut, opened)


def site_change(
    work: DaylightWork,
    rooms: Mapping[int, DaylitRoom],
    place: SetPlace,
    sunny: SunnyHours | None,
    before: SiteScene,
) -> SiteChange:
    """Windows and skies of rooms before the change.

    Raises:
        UserError: a room of the scene is not in the other one.
    """
    after = scene_of_work(work)
    for plane in rooms:
        _refuse_missing_room(work, plane, after, before)
    skies = {}
    for plane in rooms:
        places = work.sensors.places_m[work.sensors.plane == plane]
        skies[plane] = RoomSky(*(_sky_share(one.opened, places) for one in (before, after)))
    return SiteChange(
        {
            plane: lit_windows(before.shut, after.shut, room, place, sunny)
            for plane, room in rooms.items()
        },
        skies,
    )


def garden_sun(
    work: DaylightWork,
    planes: list[int],
    place: SetPlace,
    offset_h: float,
    before: SiteScene | None,
) -> dict[str, GardenSun]:
    """Sun of some work planes by their names; those under a roof, as closed rooms, are left out."""
    steps = sun_steps(place, offset_h, _GARDEN_DAY, _GARDEN_DAY)
    after = shut_scene(work)
    found = {}
    for plane in planes:
        places = work.sensors.places_m[work.sensors.plane == plane]
        if not any(after.reaches(_above(at), _UPWARDS).all() for at in places):
            continue
        former = None if before is None else _sunny_share(before.shut, places, steps)
        found[work.sensors.names[plane]] = GardenSun(former, _sunny_share(after, places, steps))
    return found


def _sunny_share(scene: ShutScene, places_m: FloatArray, steps: SunSteps) -> float:
    shines = np.array([scene.reaches(_above(at), steps.towards) for at in places_m])
    return float(np.mean(steps.hours(shines)[:, 0] >= GARDEN_H - 1e-6))


def _sky_share(scene: ShutScene, places_m: FloatArray) -> float:
    """Share of places (P, 3) that see some sky."""
    azimuth = 2.0 * np.pi * (np.arange(_AROUND) + 0.5) / _AROUND
    rise = 0.5 * np.pi * (np.arange(_RISING) + 0.5) / _RISING
    turn, rise = np.meshgrid(azimuth, rise, indexing="ij")
    level = np.cos(rise)
    towards = np.stack([level * np.sin(turn), np.sin(rise), level * np.cos(turn)], axis=-1)
    towards = towards.reshape(-1, 3)
    return float(np.mean([scene.reaches(_above(at), towards).any() for at in places_m]))


def _above(place_m: FloatArray) -> FloatArray:
    return np.asarray(place_m + np.array([0.0, _OFF_M, 0.0]))


def _with_opacity(tree: Tree, clear: BoolArray, opacity: float) -> Tree:
    """A tree whose glass, `clear` (F,), has an opacity."""
    found = np.where(clear[tree.order], np.float32(opacity), tree.opacity)
    return tree._replace(opacity=found.astype(np.float32))


def _refuse_missing_room(
    work: DaylightWork, plane: int, after: SiteScene, before: SiteScene
) -> None:
    """A room is known by the ceiling above its sensors."""
    places = work.sensors.places_m[work.sensors.plane == plane]
    up = np.tile([0.0, 1.0, 0.0], (len(places), 1))
    here, there = (one.shut.distances_m(places, up) for one in (after, before))
    with np.errstate(invalid="ignore"):
        same = (here == there) | (np.abs(here - there) < _SAME_M)
    if np.mean(same) < 0.5:
        raise UserError(
            f"--before: {work.sensors.names[plane]} is not in that scene: both scenes hold the "
            "existing building at the same place"
        )
