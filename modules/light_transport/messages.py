"""The module's own messages, and an empty light map."""

import numpy as np

from vrut_lite import checks
from vrut_lite.array import Array
from vrut_lite.kernel.messages import Derived
from vrut_lite.messages.light_map import LightMapLaid

NAME = "light_transport"
# The job whose failed result says that the graphics card could not compute the light of an hour.
CARD_JOB = "light on the card"


class BakeGrown(Derived, frozen=True, kw_only=True):
    """Progress of the bake of a light map.

    Attributes:
        layout_key: of the map.
        texels: number of its texels on surfaces.
        rays, rays_wanted: present and final number of rays of each texel.
        table_bytes: memory of the table of rays.
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
    """An empty layout, which replaces the one before where there is no light map."""
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
