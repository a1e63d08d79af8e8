"""Light at the surface points of one picture, finer than the light map: for finished stills.

A consumer of a still demands `ViewLightChanged`; the scene manager then posts the camera in
`StillAsked`, and the holder of the slot `light_map` answers when it has light for each pixel.
"""

from typing import ClassVar

import numpy as np

from vrut_lite import checks
from vrut_lite.array import Array
from vrut_lite.errors import UserError
from vrut_lite.kernel.messages import Derived
from vrut_lite.messages.camera import MoveCamera
from vrut_lite.messages.light_map import SLOT
from vrut_lite.messages.limits import LARGEST_EDGE, MOST_LIGHT, check_scale

_FARTHEST_M = 1e10


class StillAsked(Derived, frozen=True, kw_only=True):
    """A picture of `size_px` (width, height) through this camera is to be finished."""

    camera: MoveCamera
    size_px: tuple[int, int]

    def check(self) -> None:
        """A camera and a size."""
        checks.instance(self, "camera", (MoveCamera,))
        self.camera.check()
        checks.wholes(self, "size_px", 1, LARGEST_EDGE, most=2, least=2)


class ViewLightChanged(Derived, frozen=True, kw_only=True):
    """Light at points of surfaces that a picture shows, one in each square of pixels.

    Attributes:
        layout_key: key of the light map that it refines.
        camera, size_px: camera and size of the picture.
        edge_px: edge of the squares; a point is seen in the middle of its square, the first of
            which begins at the picture's upper left corner.
        light: (rows, columns, 4) float16. RGB times `radiance_scale` is irradiance, linear sRGB in
            W m^-2, without the key light's direct part; alpha is the share of the open sky's.
        plane: (rows, columns, 4) float32, the triangle's unit normal towards the eye, world axes,
            and the plane's distance from the eye along it, in metres, 0 or less; all 0 without a
            surface, or where only the map has light.
        mirrored: (2, rows, columns, 4) float16. RGB times `radiance_scale` is the mean radiance
            that a coat or metal mirrors there, W m^-2 sr^-1, without the key light's own: by the
            part of Schlick's term that is the same from everywhere, and by that of grazing angles.
            Alpha is 1; all are 0 where unknown.
        rays: rays per point.
    """

    slot: ClassVar[str | None] = SLOT

    layout_key: str
    camera: MoveCamera
    size_px: tuple[int, int]
    edge_px: int
    light: Array
    plane: Array
    mirrored: Array
    radiance_scale: float
    rays: int
    source: str

    @classmethod
    def without_points(
        cls, asked: StillAsked, layout_key: str, rays: int, source: str
    ) -> "ViewLightChanged":
        """The answer without points: the map's light of `rays` rays finishes the picture."""
        return cls(
            layout_key=layout_key,
            camera=asked.camera,
            size_px=asked.size_px,
            edge_px=max(asked.size_px),
            light=Array(np.zeros((1, 1, 4), np.float16)),
            plane=Array(np.zeros((1, 1, 4), np.float32)),
            mirrored=Array(np.zeros((2, 1, 1, 4), np.float16)),
            radiance_scale=1.0,
            rays=rays,
            source=source,
        )

    def check(self) -> None:
        """Arrays of one shape, that of the picture's squares."""
        checks.text(self, "layout_key", "source")
        checks.instance(self, "camera", (MoveCamera,))
        self.camera.check()
        checks.wholes(self, "size_px", 1, LARGEST_EDGE, most=2, least=2)
        checks.whole(self, "edge_px", 1, LARGEST_EDGE)
        columns, rows = (-(-edge // self.edge_px) for edge in self.size_px)
        shape = (rows, columns, 4)
        checks.arrays(
            self,
            {"light": ("<f2", shape), "plane": ("<f4", shape), "mirrored": ("<f2", (2, *shape))},
        )
        check_scale(self)
        checks.whole(self, "rays", 1, 2**40)

    def check_arrays(self) -> None:
        """Light within its bounds, shares of the sky, and planes.

        Raises:
            UserError: a value lies outside its bounds.
        """
        for name in ("light", "mirrored"):
            checks.contents(self, name, 0.0, max(MOST_LIGHT / self.radiance_scale, 1.0))
            if float(getattr(self, name).values[..., 3].max(initial=0.0)) > 1.0:
                raise UserError(f"{name} of a ViewLightChanged holds shares above 1")
        checks.contents(self, "plane", -_FARTHEST_M, _FARTHEST_M)
