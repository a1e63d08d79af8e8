"""The sun's shadow maps on the GPU, drawn when they are others than the last."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from vrut_lite.kernel.ledger import Ledger
from vrut_lite.render.light import Light, Shadow, Shadows
from vrut_lite.render.mesh_renderer import MeshRenderer
from vrut_lite.render.pyrender_scene import PyrenderScene
from vrut_lite.render.shadow import NEAR_RADIUS_M, light_matrix, near_centre_m

SHADOW_SIZE = 4096


class ShadowMap:
    """A depth texture; made and used on the GL thread only.

    The ledger counts its name done, and skipped where no sun shines in or where scene, sun and
    place are those of the last.
    """

    def __init__(self, context: Any, ledger: Ledger, name: str = "shadow map"):
        self._ledger = ledger
        self._name = name
        self._texture = context.depth_texture((SHADOW_SIZE, SHADOW_SIZE))
        self._texture.compare_func = "<="
        self._texture.filter = (context.LINEAR, context.LINEAR)
        self._buffer = context.framebuffer(depth_attachment=self._texture)
        self._drawn: tuple[Any, ...] = ()

    def update(
        self,
        meshes: MeshRenderer,
        scene: PyrenderScene,
        light: Light,
        centre_m: NDArray[np.float64],
        radius_m: float,
        always: bool,
    ) -> Shadow:
        """The shadows in a sphere of the scene; `always` draws them also when nothing changed."""
        shadow = Shadow(
            texture=self._texture,
            matrix=light_matrix(light.sun_direction, radius_m),
            texel_m=2 * radius_m / SHADOW_SIZE,
            centre_m=centre_m,
        )
        now = (scene, light.sun_direction, tuple(centre_m))
        if not always and not any(light.sun_irradiance):
            self._ledger.skip(f"{self._name}: no sun to cast one")
        elif not always and self._drawn == now:
            self._ledger.skip(f"{self._name}: same scene, same sun")
        else:
            self._buffer.use()
            self._buffer.clear()
            meshes.draw_depth(scene, shadow)
            self._drawn = now
            self._ledger.did(self._name)
        return shadow

    def release(self) -> None:
        """Free the GL objects; another framebuffer must be bound."""
        self._buffer.release()
        self._texture.release()


class ShadowMaps:
    """That of the scene, and one around the eye, made when a large scene first wants it."""

    def __init__(self, context: Any, ledger: Ledger):
        self._context = context
        self._ledger = ledger
        self._scene = ShadowMap(context, ledger)
        self._near: ShadowMap | None = None

    def update(
        self,
        meshes: MeshRenderer,
        scene: PyrenderScene,
        light: Light,
        eye_m: NDArray[np.float64],
        always: bool,
    ) -> Shadows:
        """The shadows that an eye (3,) sees; `always` draws them also when nothing changed."""
        bounds = scene.centre_m, scene.radius_m
        whole = self._scene.update(meshes, scene, light, *bounds, always)
        centre_m = near_centre_m(eye_m, light.sun_direction, *bounds)
        if centre_m is None:
            return Shadows(whole, None)
        if self._near is None:
            self._near = ShadowMap(self._context, self._ledger, "near shadow map")
        near = self._near.update(meshes, scene, light, centre_m, NEAR_RADIUS_M, always)
        return Shadows(whole, near)

    def release(self) -> None:
        """Free the GL objects; another framebuffer must be bound."""
        self._scene.release()
        if self._near is not None:
            self._near.release()
