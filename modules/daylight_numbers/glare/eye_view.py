"""Luminances over an eye's hemisphere in an hour or a year, and the sun and its images as discs.

In a year the rays of the eye are cast once. Patches have the light of the year's product; texels
that the sun may reach have a ray towards it in each hour, so that sunlit spots have exact edges.
"""

from functools import lru_cache
from typing import NamedTuple

import numpy as np
from light_transport.public import GROUND, GROUND_NODE, NODES, Illumination, SceneTransport
from numpy.typing import NDArray

from daylight_numbers.glare.mirrored_sun import Flats, mirrored_suns
from daylight_numbers.glazing.glass import Glass
from daylight_numbers.matrix.measured_panes import MeasuredPanes
from daylight_numbers.matrix.pane_bounces import PaneBounces
from daylight_numbers.matrix.sensor_rays import OPEN_GROUND, SKY, GlazedScene, ends_of, glazed
from daylight_numbers.now import light_by_panes, sun_reaching
from daylight_numbers.sky_cells import cell_of, cell_radiances, node_of_cell
from daylight_numbers.work import DaylightWork
from daylight_numbers.year.year import LUMENS_RGB, SolvedYear, on_nodes, suns_of_hours
from daylight_numbers.year.year_light import YearLight
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
# Hours whose suns' scattered light is computed together, to bound memory.
_HOURS_AT_ONCE = 64
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
    transport: SceneTransport,
    glass: Glass,
    flats: Flats,
    eye: Eye,
    hour: Illumination,
    bounces: PaneBounces | None = None,
) -> EyeView:
    """Computes an eye's view in an hour: diffuse surfaces, the sun in mirrors, and measured panes,
    whose scattered light has the size of their angle basis's patches."""
    directions, solid_angle, pixel, _ = hemisphere()
    where = glazed(transport, glass)
    place = transport.in_radii(eye.place_m)
    towards = directions @ eye.axes
    origin = np.broadcast_to(place, towards.shape)
    target, share = ends_of(where, origin, towards)
    panes = None if bounces is None else bounces.panes
    met = beyond = None
    if panes is not None:
        met = panes.met_by(target[:, 0], towards)
        beyond = ends_of(panes.opened, origin[met.met], towards[met.met])
    seen_rows = [target] if beyond is None else [target, beyond[0]]
    asked = np.unique(np.concatenate([each[each >= 0] for each in seen_rows]))
    rows = row_radiances(transport, where, hour, asked, panes)
    if bounces is not None:
        cells = np.vstack([cell_radiances(hour.sky), np.asarray(hour.ground_radiance_rgb)])
        radiosity = np.asarray(transport.column_light(hour)[NODES:-1, :3], float)
        of_sun, more = light_by_panes(bounces, cells, radiosity, hour)
        rows += _blurred_rows(bounces, more, hour) / np.pi
    radiance = _seen_radiance(target, share, towards, rows, hour)
    if bounces is not None and met is not None and beyond is not None:
        of_panes = of_sun + bounces.mean_radiances(cells, radiosity + more)
        through = _seen_radiance(*beyond, towards[met.met], rows, hour)
        scattered = of_panes[met.exiting] + met.straight[:, None] * through
        radiance[met.met] += share[met.met, 0] * scattered
    sun, power = np.asarray(hour.key_direction), np.asarray(hour.key_irradiance_rgb)
    sun_towards, sun_irradiance = mirrored_suns(transport, glass, flats, eye.place_m, sun, power)
    if panes is not None:
        disc = sun_through(where, panes, place, sun)
        if disc.any():
            sun_towards = np.vstack([sun_towards, sun])
            sun_irradiance = np.vstack([sun_irradiance, disc * power])
    before = sun_towards @ eye.towards > 0.0
    return EyeView(
        directions,
        solid_angle,
        radiance,
        pixel,
        sun_towards[before] @ eye.axes.T,
        sun_irradiance[before],
    )


def sun_through(
    where: GlazedScene, panes: MeasuredPanes, place: FloatArray, sun: FloatArray
) -> FloatArray:
    """Share (3,) of the sun's light that comes straight through measured panes to a place (3,)."""
    if sun[1] <= 0.0:
        return np.zeros(3)
    straight = sun_reaching(where, panes, place[None], sun[None])[0]
    return np.asarray(straight - sun_reaching(where, None, place[None], sun[None])[0])


def _seen_radiance(
    target: NDArray[np.integer],
    share: Float32Array,
    towards: FloatArray,
    rows: Float32Array | FloatArray,
    hour: Illumination,
) -> FloatArray:
    """Radiance (R, 3) along rays by their ends, see `ends_of`."""
    found = np.zeros(towards.shape)
    sky = sample_cube(hour.sky, towards)
    for which in range(2):
        end = target[:, which, None]
        seen = np.where(end >= 0, rows[np.maximum(target[:, which], 0)], 0.0)
        seen = np.where(end == SKY, sky, seen)
        seen = np.where(end == OPEN_GROUND, np.asarray(hour.ground_radiance_rgb), seen)
        found += share[:, which] * seen
    return found


def _blurred_rows(bounces: PaneBounces, more: FloatArray, hour: Illumination) -> FloatArray:
    """Radiosity (rows, 3) by light of panes (M, 3) without the sun's beam straight through them.

    Texels trace that beam themselves.
    """
    transport = bounces.transport
    assert transport.patches is not None
    beam = bounces.straight_sun(np.asarray(hour.key_direction))
    power = np.asarray(hour.key_irradiance_rgb)
    own = transport.patches.reflectance_rgb * beam[:, None] * power
    column = transport.patches.column_of[NODES:] - NODES
    known = column < len(more)
    found = np.where(known[:, None], more[np.where(known, column, 0)], 0.0)
    texel = np.arange(len(column)) < len(transport.texels.pixel)
    texel[: len(transport.good)] &= transport.good[: len(texel)]
    found -= np.where((known & texel)[:, None], own[np.where(known, column, 0)], 0.0)
    return np.maximum(found, 0.0)


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
    transport: SceneTransport,
    where: GlazedScene,
    hour: Illumination,
    rows: NDArray[np.integer],
    panes: MeasuredPanes | None = None,
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
        free = sun_reaching(where, panes, start, np.tile(sun, (len(facing), 1)))
        free *= cosine[facing, None]
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
        self._panes = work.operator.panes
        ends = [self._end]
        if self._panes is not None:
            self._met = self._panes.met_by(self._end[:, 0], towards)
            through = self._met.met
            self._beyond, beyond_share = ends_of(
                self._panes.opened, origin[through], towards[through]
            )
            self._beyond_share = beyond_share @ _GREY
            ends.append(self._beyond)
            self._set_panes(solved, hours)
        above = np.maximum(towards[:, 1], 0.0)
        level = np.stack([towards[:, 0], above, towards[:, 2]], axis=1)
        level /= np.maximum(np.linalg.norm(level, axis=1, keepdims=True), 1e-12)
        self._node = node_of_cell()[cell_of(level)]
        self._rows = np.unique(np.concatenate([each[each >= 0] for each in ends]))
        self._sky = light.sky @ LUMENS_RGB
        self._set_rows(self._rows, solved, hours)

    def luminance(self, hour: int) -> FloatArray:
        """Luminance (R,) of each direction in an hour, without discs of the sun."""
        n = self._column[hour]
        rows = self._sent[:, n] + self._sunlit[:, n]
        asked = np.flatnonzero(self._is_texel & (self._sunlit[:, n] > 0.0))
        if len(asked):
            rows[asked] = self._sent[asked, n] + self._under_the_sun(asked, hour)
        found = (self._share * self._seen(self._end, self._node, rows, hour)).sum(axis=1)
        if self._panes is not None:
            met = self._met
            seen = self._seen(self._beyond, self._node[met.met], rows, hour)
            through = met.straight * (self._beyond_share * seen).sum(axis=1)
            scattered = self._of_panes[self._place_of_exit, n] + through
            found[met.met] += self._share[met.met, 0] * scattered
        return np.asarray(found)

    def _seen(
        self, end: NDArray[np.integer], node: IntArray, rows: Float32Array | FloatArray, hour: int
    ) -> FloatArray:
        """Luminance (R, 2) at the ends (R, 2) of rays towards nodes (R,) of the sky."""
        found = np.where(end == SKY, self._sky[hour, node][:, None], 0.0)
        found[end == OPEN_GROUND] = self._sky[hour, GROUND_NODE]
        met = end >= 0
        found[met] = rows[np.searchsorted(self._rows, end[met])] / np.pi
        return found

    def _set_panes(self, solved: SolvedYear, hours: IntArray) -> None:
        """Luminance (exits, N) of the exiting patches of panes that are seen."""
        assert self._panes is not None
        light, panes = self._light, self._panes
        exits, self._place_of_exit = np.unique(self._met.exiting, return_inverse=True)
        sky = light.sky[hours].transpose(2, 1, 0)
        sun = light.sun_irradiance_rgb[hours]
        found = np.zeros((len(exits), len(hours)), np.float32)
        for k in range(3):
            of_sky, of_suns = (
                np.mean([panes.radiances(half, cells, sent[k])[exits] for half in range(2)], axis=0)
                for cells, sent in ((on_nodes(), solved.by_sky), (None, solved.by_suns))
            )
            spread = suns_of_hours(
                solved.near[hours], solved.share[hours], sun[:, k], of_suns.shape[1]
            )
            lumens = np.float32(LUMENS_RGB[k])
            found += lumens * (of_sky.astype(np.float32) @ np.ascontiguousarray(sky[k]))
            found += lumens * (spread.T @ of_suns.astype(np.float32).T).T
        lux = (sun @ LUMENS_RGB).astype(np.float32)
        for first in range(0, len(hours), _HOURS_AT_ONCE):
            some = slice(first, first + _HOURS_AT_ONCE)
            found[:, some] += panes.of_sun(light.sun_direction[hours[some]])[exits] * lux[some]
        self._of_panes = found

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
            share = sun_reaching(self._where, self._panes, self._start[here], towards)
            power = self._light.sun_irradiance_rgb[hour] * LUMENS_RGB
            found[facing] = ((share * self._reflectance[here]) @ power) * cosine[facing]
        return found
