"""Visible surface points of a view on a coarse pixel grid, to which shadow maps are fitted."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from vrut_lite.render.gl_environment import import_pyrender
from vrut_lite.render.passes.draw_order import is_blended
from vrut_lite.render.passes.mesh_renderer import MeshRenderer
from vrut_lite.render.passes.view import View
from vrut_lite.render.pyrender_scene import PlacedPrimitive
from vrut_lite.render.reversed_depth import DepthTexture, reversed_depth

import_pyrender()
from OpenGL import GL  # noqa: E402  (pyrender's repairs must come first)

_SIZE = (128, 80)


class SeenPoints(NamedTuple):
    """Points (n, 3) from the eye, world axes, and a pixel's width (n,) there, in metres."""

    from_eye_m: NDArray[np.float64]
    pixel_m: NDArray[np.float64]


class SeenGrid:
    """A small depth buffer; made and used on the GL thread only."""

    def __init__(self) -> None:
        self._depth = DepthTexture(_SIZE)

    def points(
        self,
        meshes: MeshRenderer,
        seen: list[PlacedPrimitive],
        view: View,
        size_px: tuple[int, int],
    ) -> SeenPoints:
        """Visible points of surfaces that are not blended; cut-out surfaces count as whole."""
        self._depth.bind()
        GL.glViewport(0, 0, *_SIZE)
        with reversed_depth():
            meshes.draw_whole_depth([p for p in seen if not is_blended(p.primitive.material)], view)
            depth = np.empty(_SIZE[::-1], np.float32)
            GL.glReadPixels(0, 0, *_SIZE, GL.GL_DEPTH_COMPONENT, GL.GL_FLOAT, depth)
        return points_at(depth, view, size_px)

    def release(self) -> None:
        """Free the depth buffer; another framebuffer must be bound."""
        self._depth.release()


def points_at(depth: NDArray[np.floating], view: View, size_px: tuple[int, int]) -> SeenPoints:
    """Visible points at reversed depths (rows, columns), row 0 at the bottom, 0 for none.

    `size_px`: size of the picture whose pixel widths are returned.
    """
    rows, columns = depth.shape
    y, x = np.nonzero(depth > 0.0)
    ones = np.ones(len(y))
    clip = [2.0 * (x + 0.5) / columns - 1.0, 2.0 * (y + 0.5) / rows - 1.0, depth[y, x], ones]
    found = np.stack(clip, axis=1) @ np.linalg.inv(view.clip_from_eye).T
    from_eye_m = found[:, :3] / found[:, 3:]
    away = from_eye_m @ view.clip_from_eye[3, :3] + view.clip_from_eye[3, 3]
    return SeenPoints(from_eye_m, 2.0 * away / (size_px[1] * float(view.projection[1, 1])))
