"""A ring on the floor that shows the target of a teleport, put over the eyes' pictures."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from vrut_lite.app.headset.openxr import OpenXrSession
from vrut_lite.numeric_types import FloatArray

# Diameter of the ring, its height above the floor, and its texels along an edge.
_WIDE_M, _ABOVE_M, _EDGE_PX = 0.5, 0.01, 128
# Radii of the ring's inner and outer edge, in halves of its width.
_INNER, _OUTER = 0.75, 0.95
# A quarter turn about x, by which a picture that faces +z faces up (x, y, z, w).
_FLAT = (-np.sqrt(0.5), 0.0, 0.0, np.sqrt(0.5))


def ring(edge_px: int = _EDGE_PX) -> NDArray[np.uint8]:
    """A white ring (edge, edge, 4), its alpha multiplied into its colours, as runtimes expect."""
    across = (np.arange(edge_px) + 0.5) / edge_px * 2.0 - 1.0
    radius = np.hypot(across[:, None], across[None, :])
    # Edges as soft as a texel.
    inside = np.minimum(radius - _INNER, _OUTER - radius) * 0.5 * edge_px + 0.5
    alpha = np.rint(255.0 * np.clip(inside, 0.0, 1.0)).astype(np.uint8)
    return np.repeat(alpha[..., None], 4, axis=-1)


class TeleportMarker:
    """The ring's texture in a session; made on the GL thread, closed before the session is."""

    def __init__(self, openxr: OpenXrSession):
        from OpenGL import GL

        self._openxr, xr = openxr, openxr.xr
        self._swapchain, (texture, *_) = openxr.swapchain((_EDGE_PX, _EDGE_PX), is_still=True)
        xr.acquire_swapchain_image(self._swapchain, xr.SwapchainImageAcquireInfo())
        forever = xr.SwapchainImageWaitInfo(timeout=xr.INFINITE_DURATION)
        xr.wait_swapchain_image(self._swapchain, forever)
        GL.glBindTexture(GL.GL_TEXTURE_2D, texture)
        whole = (0, 0, 0, _EDGE_PX, _EDGE_PX)
        GL.glTexSubImage2D(GL.GL_TEXTURE_2D, *whole, GL.GL_RGBA, GL.GL_UNSIGNED_BYTE, ring())
        GL.glBindTexture(GL.GL_TEXTURE_2D, 0)
        xr.release_swapchain_image(self._swapchain, xr.SwapchainImageReleaseInfo())

    def layer(self, floor_m: FloatArray) -> Any:
        """The ring flat on a point (3,) of the room, as a layer of a frame."""
        xr = self._openxr.xr
        x, y, z = floor_m.tolist()
        pose = xr.Posef(xr.Quaternionf(*_FLAT), xr.Vector3f(x, y + _ABOVE_M, z))
        return xr.CompositionLayerQuad(
            layer_flags=xr.CompositionLayerFlags.BLEND_TEXTURE_SOURCE_ALPHA_BIT,
            space=self._openxr.room,
            eye_visibility=xr.EyeVisibility.BOTH,
            sub_image=self._openxr.sub_image(self._swapchain, (_EDGE_PX, _EDGE_PX)),
            pose=pose,
            size=xr.Extent2Df(_WIDE_M, _WIDE_M),
        )
