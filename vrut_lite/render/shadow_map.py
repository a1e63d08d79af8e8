"""The sun's shadow map on the GPU, drawn when it is another than the last."""

from typing import Any

from vrut_lite.kernel.ledger import Ledger
from vrut_lite.render.light import Light, Shadow
from vrut_lite.render.mesh_renderer import MeshRenderer
from vrut_lite.render.pyrender_scene import PyrenderScene
from vrut_lite.render.shadow import light_matrix

SHADOW_SIZE = 4096


class ShadowMap:
    """A depth texture; made and used on the GL thread only.

    The ledger counts "shadow map" done, and skipped where no sun shines in or where scene and
    sun are those of the last.
    """

    def __init__(self, context: Any, ledger: Ledger):
        self._ledger = ledger
        self._texture = context.depth_texture((SHADOW_SIZE, SHADOW_SIZE))
        self._texture.compare_func = "<="
        self._texture.filter = (context.LINEAR, context.LINEAR)
        self._buffer = context.framebuffer(depth_attachment=self._texture)
        self._drawn: tuple[PyrenderScene, tuple[float, float, float]] | None = None

    def update(
        self, meshes: MeshRenderer, scene: PyrenderScene, light: Light, always: bool
    ) -> Shadow:
        """The shadows of a scene in the sun; `always` draws them also when nothing changed."""
        shadow = Shadow(
            texture=self._texture,
            matrix=light_matrix(light.sun_direction, scene.radius_m),
            texel_m=2 * scene.radius_m / SHADOW_SIZE,
        )
        now = (scene, light.sun_direction)
        if not always and not any(light.sun_irradiance):
            self._ledger.skip("shadow map: no sun to cast one")
        elif not always and self._is_drawn(*now):
            self._ledger.skip("shadow map: same scene, same sun")
        else:
            self._buffer.use()
            self._buffer.clear()
            meshes.draw_depth(scene, shadow.matrix)
            self._drawn = now
            self._ledger.did("shadow map")
        return shadow

    def _is_drawn(self, scene: PyrenderScene, direction: tuple[float, float, float]) -> bool:
        return self._drawn is not None and self._drawn[0] is scene and self._drawn[1] == direction

    def release(self) -> None:
        """Free the GL objects; another framebuffer must be bound."""
        self._buffer.release()
        self._texture.release()
