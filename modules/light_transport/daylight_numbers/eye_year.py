"""Luminances before an eye in each hour of a year: sky, ground, and surfaces with the sun on them.

Rays of the eye are cast once. Patches have the light of the year's product; texels that the sun may
reach have a ray towards it in each hour, so that edges of sunlit spots are where they are.
"""

import numpy as np

from light_transport.daylight_numbers.annual import LUMENS_RGB, SolvedYear, suns_of_hours
from light_transport.daylight_numbers.eye_view import Eye, Hemisphere, hemisphere
from light_transport.daylight_numbers.sensor_rays import OPEN_GROUND, SKY, ends_of, tree_with_glass
from light_transport.daylight_numbers.sky_cells import cell_of, node_of_cell
from light_transport.daylight_numbers.work import Work
from light_transport.daylight_numbers.year_light import YearLight
from light_transport.rays.sky_nodes import GROUND_NODE, NODES
from light_transport.surfaces.surfaces import GROUND
from vrut_lite.numeric_types import Float32Array, FloatArray, IntArray

# Of the fisheye: pixels are 2.2 degrees wide.
_EDGE_PX = 80
_OFF = 1e-5
_GREY = LUMENS_RGB / LUMENS_RGB.sum()


class EyeYear:
    """What one eye sees in some hours of a year, in cd m^-2."""

    def __init__(self, work: Work, eye: Eye, light: YearLight, solved: SolvedYear, hours: IntArray):
        """Cast the eye's rays; `hours` (N,) are numbers of hours of the light that are asked."""
        bake = work.bake
        assert bake.patches is not None
        self.hemisphere: Hemisphere = hemisphere(_EDGE_PX)
        self._work, self._light = work, light
        self._tree = tree_with_glass(bake, work.glass)
        self._column = np.full(len(light.hour), -1)
        self._column[hours] = np.arange(len(hours))
        towards = self.hemisphere.directions @ eye.axes
        place = (eye.place_m - bake.surfaces.centre_m) / bake.surfaces.radius_m
        origin = np.broadcast_to(place, towards.shape)
        self._end, share = ends_of(bake, self._tree, work.glass, origin, towards)
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
        """Of each direction (R,) in an hour, without discs of the sun."""
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
        bake, light = self._work.bake, self._light
        assert bake.patches is not None
        column = bake.patches.column_of[NODES + rows] - NODES
        lost = column >= len(bake.patches.area)
        patches, which = np.unique(np.where(lost, 0, column), return_inverse=True)
        reflectance = bake.patches.reflectance_rgb[patches].astype(float)
        reflectance[bake.patches.on_ground[patches]] = light.ground_albedo_rgb
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
        texel = rows < len(bake.texels.pixel)
        self._is_texel = texel & bake.good[np.where(texel, rows, 0)] & ~lost
        some = np.where(self._is_texel, rows, 0)
        self._normal = bake.texels.normal[some].astype(float)
        self._start = bake.texels.place[some].astype(float) + _OFF * self._normal
        triangle = bake.colour_of[some]
        self._reflectance = bake.surfaces.reflectance_rgb[triangle].astype(float)
        ground = bake.surfaces.part[triangle] == GROUND
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
            work = self._work
            target, share = ends_of(work.bake, self._tree, work.glass, self._start[here], towards)
            power = self._light.sun_irradiance_rgb[hour] * LUMENS_RGB
            sent = (share[:, 0] * self._reflectance[here]) @ power
            found[facing] = np.where(target[:, 0] == SKY, sent * cosine[facing], 0.0)
        return found
