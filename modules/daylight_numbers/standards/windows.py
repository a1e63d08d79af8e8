"""Windows from outside: vertical sky component and probable sunlight hours.

Littlefair, King, Howlett, Ticleanu and Longfield 2022, "Site layout planning for daylight and
sunlight", BRE 209, third edition: the vertical sky component is the illuminance of an upright plane
by CIE's overcast sky, without reflected light, over that of open level ground; probable sunlight
hours are the sunny hours in which the sun reaches a window, over all sunny hours of the place. Both
are measured on the outer face of the wall, in front of the window; here at places spread over the
openings of a room's side, whose mean is given.

Sunny hours are those of a year of weather, in which the direct beam exceeds 120 W/m^2 (WMO-No. 8).
Panes are opaque here: glass of other buildings is an obstruction.
"""

from typing import NamedTuple

import numpy as np
from light_transport.public import MISS, Tree, first_hits

from daylight_numbers.now import relative_luminance
from daylight_numbers.rooms import BELOW, ROOF, DaylitRoom, Opening
from daylight_numbers.sky_cells import CELLS, EDGE, cell_solid_angles, directions_at
from daylight_numbers.work import DaylightWork
from vrut_lite.geometry.frames import enu_from_world, world_from_enu
from vrut_lite.messages.place import SetPlace
from vrut_lite.messages.weather import SetWeather
from vrut_lite.numeric_types import BoolArray, FloatArray
from vrut_lite.sky.suns import hour_edges_s, suns_at

# Reveals: places move outwards in these steps while three of the four ways along the wall end
# within a distance, for the depth of a thick wall at most.
_STEP_M, _THICKEST_M, _REVEAL_M = 0.02, 0.7, 6.0
_OFF_M = 0.01
# Direct beam (W/m^2) above which the sun is said to shine.
_SUNNY_W_M2 = 120.0
# Days of the year from the 21st of March to the 20th of September, the first being 0.
_SUMMER = (79, 263)
_HOURS = 24
_ROUNDING_DEG = 1e-6


class SunnyHours(NamedTuple):
    """A year's sunny hours: directions (S, 3) of the sun in world axes, and which are in winter,
    from 21 September to 20 March north of the equator, (S,)."""

    towards: FloatArray
    in_winter: BoolArray


class WindowLight(NamedTuple):
    """Light on the openings of a room's side, outside.

    Attributes:
        side: of `rooms.SIDES`.
        azimuth_deg: of the outward normal, from true north clockwise.
        vsc_percent: vertical sky component, mean over the openings; 39.6 without obstructions.
        vsc_range_percent: its least and largest value.
        annual_share, winter_share: of all sunny hours of the year: those that reach the window, in
            all and in winter; None without a year of weather.
        faces_sun: whether it faces within 90 degrees of the equator's side, where BRE 209 asks for
            sunlight.
    """

    side: int
    azimuth_deg: float
    vsc_percent: float
    vsc_range_percent: tuple[float, float]
    annual_share: float | None
    winter_share: float | None
    faces_sun: bool


def sunny_hours(weather: SetWeather, north_offset_rad: float) -> SunnyHours:
    """The sunny hours of a year of weather, by the sun in their middle."""
    direct = np.array(weather.direct_normal_w_m2)
    middle_s = hour_edges_s(len(direct), weather.utc_offset_h)[:-1] + 1800.0
    suns = suns_at(middle_s, weather.latitude_deg, weather.longitude_deg, weather.altitude_m)
    sunny = (direct > _SUNNY_W_M2) & (suns.apparent_elevation_rad > 0.0)
    day = np.flatnonzero(sunny) // _HOURS
    summer = (day >= _SUMMER[0]) & (day < _SUMMER[1])
    in_winter = ~summer if weather.latitude_deg >= 0.0 else summer
    return SunnyHours(world_from_enu(suns.east_north_up[sunny], north_offset_rad), in_winter)


class ShutScene(NamedTuple):
    """A scene with opaque panes: the tree of its triangles in radii around its middle (3,)."""

    tree: Tree
    centre_m: FloatArray
    radius_m: float

    def distances_m(self, places_m: FloatArray, towards: FloatArray) -> FloatArray:
        """Free ways (R,) from places (R, 3) along unit vectors (R, 3); inf where nothing is met."""
        places = (places_m - self.centre_m) / self.radius_m
        hit, distance = first_hits(self.tree, places, towards)
        return np.where(hit == MISS, np.inf, distance.astype(float) * self.radius_m)

    def reaches(self, place_m: FloatArray, towards: FloatArray) -> BoolArray:
        """Which light from unit vectors (R, 3) reaches a place (3,)."""
        places_m = np.broadcast_to(place_m, towards.shape)
        return np.asarray(np.isinf(self.distances_m(places_m, towards)))


def shut_scene(work: DaylightWork) -> ShutScene:
    """The scene of a work, its panes shut."""
    tree, surfaces = work.transport.tree, work.transport.surfaces
    opacity = np.where(work.glass.clear[tree.order], np.float32(1.0), tree.opacity)
    shut = tree._replace(opacity=opacity.astype(np.float32))
    return ShutScene(shut, surfaces.centre_m, surfaces.radius_m)


def windows_of(
    work: DaylightWork, room: DaylitRoom, place: SetPlace, sunny: SunnyHours | None
) -> list[WindowLight]:
    """The upright sides of a room that have openings."""
    scene = shut_scene(work)
    return lit_windows(scene, scene, room, place, sunny)


def lit_windows(
    scene: ShutScene,
    own: ShutScene,
    room: DaylitRoom,
    place: SetPlace,
    sunny: SunnyHours | None,
) -> list[WindowLight]:
    """The same in `scene`, at the outer faces of the walls of the room's `own` scene."""
    return [
        _window(scene, opening, outer_places(own, opening), place, sunny)
        for opening in room.openings
        if opening.side not in (ROOF, BELOW)
    ]


def _window(
    scene: ShutScene,
    opening: Opening,
    places_m: FloatArray,
    place: SetPlace,
    sunny: SunnyHours | None,
) -> WindowLight:
    east, north, _ = enu_from_world(opening.outwards, place.north_offset_rad)
    azimuth = np.degrees(np.arctan2(east, north)) % 360.0
    sky = 100.0 * np.array([sky_component(scene, at, opening.outwards) for at in places_m])
    annual = winter = None
    if sunny is not None and len(sunny.towards):
        ahead = np.flatnonzero(sunny.towards @ opening.outwards > 0.0)
        shines = np.array([scene.reaches(at, sunny.towards[ahead]) for at in places_m])
        hours = len(places_m) * len(sunny.towards)
        annual = float(shines.sum() / hours)
        winter = float(shines[:, sunny.in_winter[ahead]].sum() / hours)
    equator = 180.0 if place.latitude_deg >= 0.0 else 0.0
    return WindowLight(
        side=opening.side,
        azimuth_deg=float(azimuth),
        vsc_percent=float(sky.mean()),
        vsc_range_percent=(float(sky.min()), float(sky.max())),
        annual_share=annual,
        winter_share=winter,
        faces_sun=bool(abs((azimuth - equator + 180.0) % 360.0 - 180.0) <= 90.0 + _ROUNDING_DEG),
    )


def sky_component(scene: ShutScene, place_m: FloatArray, outwards: FloatArray) -> float:
    """Share of the overcast sky's illuminance on open level ground that a plane (3,), which faces
    `outwards` (3,), gets straight from the sky: a ray in each cell of the sky."""
    random = np.random.Generator(np.random.Philox(key=0))
    row, column = np.divmod(np.arange(CELLS), EDGE)
    at = (np.stack([row, column]) + random.random((2, CELLS))) * (2.0 / EDGE) - 1.0
    towards = directions_at(*at)
    light = cell_solid_angles() * relative_luminance("16", towards[:, 1])
    ahead = np.flatnonzero(towards @ outwards > 0.0)
    free = scene.reaches(place_m, towards[ahead])
    got = (light * (towards @ outwards))[ahead] @ free
    return float(got / (light @ towards[:, 1]))


def outer_places(scene: ShutScene, opening: Opening) -> FloatArray:
    """Places (N, 3) of an opening moved outwards, just before the outer face of its wall."""
    outwards = opening.outwards
    aside = np.cross(outwards, [0.0, 1.0, 0.0])
    ways = np.array([aside, -aside, [0.0, 1.0, 0.0], [0.0, -1.0, 0.0]])
    depth = np.full(len(opening.places_m), np.inf)
    for step in range(int(_THICKEST_M / _STEP_M) + 1):
        behind = np.flatnonzero(np.isinf(depth))
        if not len(behind):
            break
        at = opening.places_m[behind] + (step * _STEP_M + _OFF_M) * outwards
        free = scene.distances_m(np.repeat(at, len(ways), axis=0), np.tile(ways, (len(at), 1)))
        near = (free.reshape(-1, len(ways)) < _REVEAL_M).sum(axis=1)
        depth[behind[near < len(ways) - 1]] = step * _STEP_M
    depth[np.isinf(depth)] = 0.0
    return np.asarray(opening.places_m + (depth + _OFF_M)[:, None] * outwards)
