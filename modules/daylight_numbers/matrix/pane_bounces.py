"""Light that measured panes bring onto the patches of a light map, and its bounces.

Panes are opaque in the light map: this file adds the light that comes through them. Rays of each
patch that sees a pane end in the pane's exiting patches, or beyond it for the straight beam.
"""

from concurrent.futures import ThreadPoolExecutor
from copy import copy
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from light_transport.public import CancelCheck, SceneTransport, always
from scipy.sparse import csr_matrix

from daylight_numbers.matrix.measured_panes import Entries, MeasuredPanes, joined
from daylight_numbers.matrix.pane_tiles import FACET_COSINE, points_of, spread
from daylight_numbers.matrix.sensor_rays import BODY, Ends, ends_of
from daylight_numbers.sky_cells import CELLS
from vrut_lite.geometry.colour import luminance
from vrut_lite.numeric_types import Float32Array, FloatArray, IntArray, Vector

# Number of rays of a patch that sees panes, and of patches whose rays are cast together.
_RAYS, _PATCHES_AT_ONCE = 576, 64
# Offset of rays in radii.
_OFF = 1e-5


@dataclass(frozen=True, eq=False)
class PaneBounces:
    """Light that panes bring onto patches (M).

    `through` (M, O): irradiance by radiances of exiting patches; `by_cells` (M, CELLS + 1) and
    `by_patches` (M, M): straight through panes by radiances of the sky and by radiosities.
    """

    transport: SceneTransport
    panes: MeasuredPanes
    through: csr_matrix
    by_cells: csr_matrix
    by_patches: csr_matrix

    def straight_sun(self, direction: FloatArray) -> FloatArray:
        """Irradiance (M,) straight through panes by a sun of 1 W m^-2 from a unit vector (3,)."""
        assert self.transport.patches is not None
        found = np.zeros(len(self.transport.patches.area))
        for facet, opened in enumerate(self._opened):
            passed = float(self.panes.straight_through(facet, np.asarray(direction)[None])[0])
            if passed > 0.0:
                closed = self.transport.sunlit_patches(direction)
                found += passed * (opened.sunlit_patches(direction) - closed)
        return found

    def more_radiosity(
        self,
        radiances: FloatArray,
        radiosity: FloatArray,
        of_sun: FloatArray,
        direction: FloatArray,
        irradiance_rgb: FloatArray,
        ground_albedo_rgb: Vector,
    ) -> FloatArray:
        """Radiosity (M, 3) of patches in an hour by light of panes and all its bounces.

        Args:
            radiances: (CELLS + 1, 3), of the sky's cells and of open ground.
            radiosity: (M, 3), without light of panes.
            of_sun: (O, 3), radiances of panes by the sun.
            direction: (3,), to the sun; irradiance_rgb: (3,), of it.
            ground_albedo_rgb: of the ground.
        """
        patches = self.transport.patches
        assert patches is not None
        of_panes = of_sun + self.mean_radiances(radiances, radiosity)
        light = self.on_patches(of_panes, radiosity) + self.by_cells @ radiances
        light += self.straight_sun(direction)[:, None] * irradiance_rgb
        reflectance = patches.reflectance_rgb.copy()
        reflectance[patches.on_ground] = ground_albedo_rgb
        nothing = np.zeros_like(reflectance)
        return np.asarray(
            self.transport.radiosity(light.astype(np.float32), nothing, reflectance), float
        )

    def mean_radiances(
        self, radiances: FloatArray | csr_matrix | None, radiosity: FloatArray | Float32Array
    ) -> FloatArray:
        """`MeasuredPanes.radiances` by both halves of the rays."""
        one, other = (self.panes.radiances(half, radiances, radiosity) for half in range(2))
        return np.asarray(0.5 * (one + other))

    def on_patches(self, of_panes: FloatArray, radiosity: FloatArray | Float32Array) -> FloatArray:
        """Irradiance (M, L) by radiances of panes (O, L), and straight by radiosities (M, L)."""
        return np.asarray(self.through @ of_panes + self.by_patches @ radiosity)

    @cached_property
    def _opened(self) -> list[SceneTransport]:
        """The scene with panes that face one way as openings, by facets."""
        tree, faces = self.transport.tree, self.transport.receivers.geometry.faces
        tiles, found = self.panes.tiles, []
        # All have the starts of rays in common.
        _ = self.transport.cache
        for glazing, axes in zip(tiles.glazing, tiles.axes, strict=True):
            is_open = self.panes.materials.of_triangle == glazing
            is_open &= np.abs(faces @ axes[2]) > FACET_COSINE
            opened = copy(self.transport)
            opacity = np.where(is_open[tree.order], np.float32(0.0), tree.opacity)
            opened.tree = tree._replace(opacity=opacity.astype(np.float32))
            found.append(opened)
        return found


def pane_bounces(
    transport: SceneTransport, panes: MeasuredPanes, go_on: CancelCheck = always
) -> PaneBounces:
    """Trace the rays of patches that see panes.

    Raises:
        GivenUp: by `go_on`.
    """
    assert transport.patches is not None
    count = len(transport.patches.area)
    width = CELLS + 1 + count + panes.exiting
    seeing = _seeing(transport, panes)

    def block(first: int) -> csr_matrix:
        go_on()
        some = seeing[first : first + _PATCHES_AT_ONCE]
        random = np.random.Generator(np.random.Philox(key=first))
        started = [points_of(transport, some[n : n + 1], _RAYS, random) for n in range(len(some))]
        normals = np.concatenate([normal for _, normal in started])
        places = np.concatenate([place for place, _ in started]) + _OFF * normals
        towards = np.concatenate([spread(normal, _RAYS, random) for _, normal in started])
        each = np.arange(len(places))
        area = np.full(len(places), 1.0 / _RAYS)
        target, share = ends_of(panes.opened, places, towards)
        ends, parts = panes.seen_along(Ends(each, area, towards, target, share), places)
        patch = each // _RAYS
        free = np.bincount(patch, ends.target[:, 0] != BODY, len(some)) / _RAYS
        found: Entries = joined(parts)
        row = patch[found.row]
        value = luminance(found.value) / np.maximum(free, 1e-9)[row]
        return csr_matrix((value, (some[row], found.column)), (count, width))

    firsts = range(0, len(seeing), _PATCHES_AT_ONCE)
    with ThreadPoolExecutor(transport.threads) as pool:
        total = sum(pool.map(block, firsts), csr_matrix((count, width))).tocsr()
    first = CELLS + 1
    return PaneBounces(
        transport,
        panes,
        total[:, first + count :].tocsr(),
        total[:, :first].tocsr(),
        total[:, first : first + count].tocsr(),
    )


def _seeing(transport: SceneTransport, panes: MeasuredPanes) -> IntArray:
    """Patches from which rays met tiles."""
    assert transport.patches is not None
    exchange, count = transport.cache.patch_transfer, len(transport.patches.area)
    share = csr_matrix((exchange.share, exchange.column, exchange.start), (count, count))
    seen = np.asarray(share @ (panes.tile_of >= 0).astype(np.float32)).ravel()
    return np.flatnonzero((seen > 0.0) & (transport.patches.area > 0.0))
