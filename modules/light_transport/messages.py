"""What the module says of its own, and a light map that is none."""

import numpy as np

from vrut_lite import checks
from vrut_lite.array import Array
from vrut_lite.daylight.light_map import LightMapLaid
from vrut_lite.kernel.messages import Derived

NAME = "light_transport"


class HourOutdated(Derived, frozen=True, kw_only=True):
    """What lights the scene has changed: heard when all that changes with it was heard."""


class BakeGrown(Derived, frozen=True, kw_only=True):
    """How far the bake of a light map is.

    Attributes:
        layout_key: of the map.
        texels: of it that lie on surfaces.
        rays, rays_wanted: that each of them has been given, and will be.
        table_bytes: memory of what the rays found.
    """

    layout_key: str
    texels: int
    rays: int
    rays_wanted: int
    table_bytes: int

    def check(self) -> None:
        """A name and counts."""
        checks.text(self, "layout_key")
        for name in ("texels", "rays", "rays_wanted", "table_bytes"):
            checks.whole(self, name, 0, 2**63)


def no_light_map() -> LightMapLaid:
    """A layout of no scene: it takes the place of the one before, where none is to hold."""
    return LightMapLaid(
        content_key="",
        layout_key="",
        size_px=(1, 1),
        shapes=Array(np.empty((0, 5), np.int64)),
        source_vertex=Array(np.empty(0, np.int32)),
        uv=Array(np.empty((0, 2), np.float32)),
        triangles=Array(np.empty((0, 3), np.int32)),
        part_shape=Array(np.empty(0, np.int32)),
        part_corner_px=Array(np.empty((0, 2), np.int32)),
        ground=None,
        probes=None,
        source=NAME,
    )
