"""Luminances over an eye's hemisphere in an hour or a year, and the sun and its images as discs.

In a year the rays of the eye are cast once. Patches have the light of the year's product; texels
that the sun may reach have a ray towards it in each hour, so that sunlit spots have exact edges.
"""

from functools import lru_cache
from typing import NamedTuple

import numpy as np
from light_transport.public import GROUND, GROUND_NODE, NODES, Illumination, SceneTransport
from numpy.typing import NDArray

from daylight_numbers.glass import Glass
from daylight_numbers.mirrored_sun import Flats, mirrored_suns
from daylight_numbers.sensor_rays import OPEN_GROUND, SKY, GlazedScene, ends_of, glazed
from daylight_numbers.sky_cells import cell_of, node_of_cell
from daylight_numbers.work import DaylightWork
from daylight_numbers.year import LUMENS_RGB, SolvedYear, suns_of_hours
from daylight_numbers.year_light import YearLight
from vrut_lite.geometry.colour import LUMENS_PER_WATT, luminance
from vrut_lite.geometry.cube_map import sample_cube
from vrut_lite.numeric_types import Float32Array, FloatArray, IntArray

EDGE_PX = 320
# Solid angle of the sun's disc, sr; its mean radius is 0.2666 degrees.
SUN_SR = 6.8e-5
_OFF = 1e-5
_UP = np.array([0.0, 1.0, 0.0])
# Edge of the fisheye of a year, in pixels 2.2 degrees wide.
_YEAR_EDGE_PX = 80
_GREY = LUMENS_RGB / LUMENS_RGB.sum()


class Eye(NamedTuple):
    """Where an eye is (3,), in metres, and where it looks, a unit vector (3,); world axes."""

    place_m: FloatArray
    towards: FloatArray

    @property
    def axes(self) -> FloatArray:
        """Unit vectors (3, 3): to the right, up and ahead."""
        along = _UP if abs(self.towards[1]) < 0.999 else np.array([0.0, 0.0, 1.0])
        right = np.cross(self.towards, along)
        right /= np.linalg.norm(right)
        return np.stack([right, np.cross(right, self.towards), self.towards])


class EyeView(NamedTuple):
    """View of an eye, a row a direction (N), in the eye's axes: right, up, ahead.

    Attributes:
        directions: (N, 3) unit vectors; solid_angle_sr: (N,).
        radiance_rgb: (N, 3), W m^-2 sr^-1, without discs of the sun.
        pixel: (N, 2) row and column of each in an angular fisheye of EDGE_PX.
        sun_directions: (K, 3) of discs of the sun, straight and mirrored; sun_irradiance: (K, 3)
            W m^-2 that each sends on a plane that faces it.
    """

    directions: FloatArray
    solid_angle_sr: FloatArray
    radiance_rgb: FloatArray
    pixel: NDArray[np.integer]
    sun_directions: FloatArray
    sun_irradiance: FloatArray

    @property
    def luminance(self) -> FloatArray:
        """Luminance (N,) of each direction, cd m^-2."""
        return np.asarray(luminance(self.radiance_rgb) * LUMENS_PER_WATT)

    @property
    def sun_illuminance(self) -> FloatArray:
        """Illuminance (K,) by each disc, lux on a plane that faces it."""
        return np.asarray(luminance(self.sun_irradiance) * LUMENS_PER_WATT)


def eye_view(
    transport: SceneTransport, glass: Glass, flats: Flats, eye: Eye, hour: Illumination
) -> EyeView:
    """Computes an eye's view in an hour: diffuse surfaces, and the sun in mirrors."""
    directions, solid_angle, pixel, _ = hemisphere()
    where = glazed(transport, glass)
    place = transport.in_radii(eye.place_m)
    towards = directions @ eye.axes
    origin = np.broadcast_to(place, towards.shape)
    target, share = ends_of(where, origin, towards)
    rows = row_radiances(transport, where, hour, np.unique(target[target >= 0]))
    radiance = np.zeros(towards.shape)
    sky = sample_cube(hour.sky, towards)
    for which in range(2):
        end = target[:, which, None]
        seen = np.where(end >= 0, rows[np.maximum(target[:, which], 0)], 0.0)
        seen = np.where(end == SKY, sky, seen)
        seen = np.where(end == OPEN_GROUND, np.asarray(hour.ground_radiance_rgb), seen)
        radiance += share[:, which] * seen
    sun, power = np.asarray(hour.key_direction), np.asarray(hour.key_irradiance_rgb)
    sun_towards, sun_irradiance = mirrored_suns(transport, glass, flats, eye.place_m, sun, power)
    before = sun_towards @ eye.towards > 0.0
    return EyeView(
        directions,
        solid_angle,
        radiance,
        pixel,
        sun_towards[before] @ eye.axes.T,
        sun_irradiance[before],
    )


class Hemisphere(NamedTuple):
    """Directions (N, 3) of an angular fisheye in the eye's axes, solid angles (N,), and their row
    and column (N, 2) among `edge_px` pixels an edge, up first."""

    directions: FloatArray
    solid_angle_sr: FloatArray
    pixel: NDArray[np.integer]
    edge_px: int


@lru_cache(maxsize=4)
def hemisphere(edge_px: int = EDGE_PX) -> Hemisphere:
    """All that lies before an eye."""
    middle = (2.0 * np.arange(edge_px) + 1.0) / edge_px - 1.0
    y, x = np.meshgrid(-middle, middle, indexing="ij")
    radius = np.hypot(x, y)
    inside = radius < 1.0
    x, y, radius = x[inside], y[inside], np.maximum(radius[inside], 1e-9)
    angle = 0.5 * np.pi * radius
    level = np.sin(angle) / radius
    solid = (2.0 / edge_px) ** 2 * 0.5 * np.pi * level
    directions = np.stack([x * level, y * level, np.cos(angle)], axis=1)
    return Hemisphere(directions, solid, np.argwhere(inside), edge_px)


def row_radiances(
    transport: SceneTransport, where: GlazedScene, hour: Illumination, rows: NDArray[np.integer]
) -> Float32Array | FloatArray:
    """Radiance (rows of the transport, 3) of the given rows; others are 0.

    Texels have their own light, and the sun by a ray from their middle; other rows have patches'.
    """
    column_light = transport.column_light(hour)
    assert transport.patches is not None
    found = column_light[transport.patches.column_of[NODES:], :3] / np.pi
    light = transport.row_light(hour)
    texels = rows[(rows < len(transport.texels.pixel))]
    texels = texels[transport.good[texels]]
    normal = transport.texels.normal[texels].astype(float)
    sun = np.asarray(hour.key_direction, float)
    cosine = normal @ sun
    lit = np.zeros((len(texels), 3))
    facing = np.flatnonzero((cosine > 0.0) & (sun[1] > 0.0))
    if len(facing) and np.any(np.asarray(hour.key_irradiance_rgb) > 0.0):
        start = transport.texels.place[texels[facing]].astype(float) + _OFF * normal[facing]
        target, share = ends_of(where, start, np.tile(sun, (len(facing), 1)))
        free = (target[:, 0] == SKY)[:, None] * share[:, 0] * cosine[facing, None]
        lit[facing] = free * np.asarray(hour.key_irradiance_rgb)
    triangle = transport.colour_of[texels]
    reflectance = transport.surfaces.reflectance_rgb[triangle].astype(float)
    reflectance[transport.surfaces.part[triangle] == GROUND] = hour.ground_albedo_rgb
    emitted = transport.surfaces.emitted_rgb[triangle]
    found[texels] = (emitted + reflectance * (light[texels, :3] + lit)) / np.pi
    return found


class EyeYear:
    """View of one eye in some hours of a year, in cd m^-2."""

    def __init__(
        self, work: DaylightWork, eye: Eye, light: YearLight, solved: SolvedYear, hours: IntArray
    ):
        """Cast the eye's rays; `hours` (N,) are numbers of hours of the light that are asked."""
        transport = work.transport
        assert transport.patches is not None
        self.hemisphere: Hemisphere = hemisphere(_YEAR_EDGE_PX)
        self._work, self._light = work, light
        self._where = glazed(transport, work.glass)
        self._column = np.full(len(light.hour), -1)
        self._column[hours] = np.arange(len(hours))
        towards = self.hemisphere.directions @ eye.axes
        place = transport.in_radii(eye.place_m)
        origin = np.broadcast_to(place, towards.shape)
        self._end, share = ends_of(self._where, origin, towards)
        self._share = share @ _GREY
        above = np.maximum(towards[:, 1], 0.0)
        level = np.stack([towards[:, 0], above, towards[:, 2]], axis=1)
        level /= np.maximum(np.linalg.norm(level, axis=1, keepdims=True), 1e-12)
        self._node = np.where(self._end == OPEN_GROUND, GROUND_NODE, 0)
        sky = self._end == SKY
        self._node[sky] = np.broadcast_to(node_of_cell()[cell_of(level)][:, None], sky.shape)[sky]
        rows = np.unique(self._end[self._end >= 0])
        self._place_of_row = np.searchsorted(rows, self._end)
        self._sky = light.sky @ LUMENS_RGB
        self._set_rows(rows, solved, hours)

    def luminance(self, hour: int) -> FloatArray:
        """Luminance (R,) of each direction in an hour, without discs of the sun."""
        n = self._column[hour]
        rows = self._sent[:, n] + self._sunlit[:, n]
        asked = np.flatnonzero(self._is_texel & (self._sunlit[:, n] > 0.0))
        if len(asked):
            rows[asked] = self._sent[asked, n] + self._under_the_sun(asked, hour)
        sky = self._sky[hour, self._node]
        met = self._end >= 0
        beyond = (self._end == SKY) | (self._end == OPEN_GROUND)
        seen = np.where(beyond, sky, 0.0)
        seen[met] = rows[self._place_of_row[met]] / np.pi
        return np.asarray((self._share * seen).sum(axis=1))

    def _set_rows(self, rows: IntArray, solved: SolvedYear, hours: IntArray) -> None:
        """Radiosity (rows, N) in lm m^-2 of seen rows by all bounces, and straight by the sun."""
        transport, light = self._work.transport, self._light
        assert transport.patches is not None
        column = transport.patches.column_of[NODES + rows] - NODES
        lost = column >= len(transport.patches.area)
        patches, which = np.unique(np.where(lost, 0, column), return_inverse=True)
        reflectance = transport.patches.reflectance_rgb[patches].astype(float)
        reflectance[transport.patches.on_ground[patches]] = light.ground_albedo_rgb
        sky = light.sky[hours].transpose(2, 1, 0)
        lit = solved.sunlit[:, patches].T
        whole, own = np.zeros((2, len(patches), len(hours)), np.float32)
        for k in range(3):
            sun = light.sun_irradiance_rgb[hours, k]
            spread = suns_of_hours(solved.near[hours], solved.share[hours], sun, lit.shape[1])
            lumens = np.float32(LUMENS_RGB[k])
            whole += lumens * (solved.by_sky[k, patches] @ np.ascontiguousarray(sky[k]))
            whole += lumens * (spread.T @ solved.by_suns[k, patches].T).T
            own += lumens * reflectance[:, k, None].astype(np.float32) * (spread.T @ lit.T).T
        whole[:], own[:] = np.maximum(whole - own, 0.0), own
        self._sent, self._sunlit = whole[which], own[which]
        self._sent[lost], self._sunlit[lost] = 0.0, 0.0
        texel = rows < len(transport.texels.pixel)
        self._is_texel = texel & transport.good[np.where(texel, rows, 0)] & ~lost
        some = np.where(self._is_texel, rows, 0)
        self._normal = transport.texels.normal[some].astype(float)
        self._start = transport.texels.place[some].astype(float) + _OFF * self._normal
        triangle = transport.colour_of[some]
        self._reflectance = transport.surfaces.reflectance_rgb[triangle].astype(float)
        ground = transport.surfaces.part[triangle] == GROUND
        self._reflectance[ground] = light.ground_albedo_rgb

    def _under_the_sun(self, asked: IntArray, hour: int) -> Float32Array:
        """Radiosity (some rows) in lm m^-2 by the sun itself, a ray each."""
        sun = self._light.sun_direction[hour]
        cosine = self._normal[asked] @ sun
        found = np.zeros(len(asked), np.float32)
        facing = np.flatnonzero(cosine > 0.0)
        if len(facing):
            here = asked[facing]
            towards = np.tile(sun, (len(here), 1))
            target, share = ends_of(self._where, self._start[here], towards)
            power = self._light.sun_irradiance_rgb[hour] * LUMENS_RGB
            sent = (share[:, 0] * self._reflectance[here]) @ power
            found[facing] = np.where(target[:, 0] == SKY, sent * cosine[facing], 0.0)
        return found
