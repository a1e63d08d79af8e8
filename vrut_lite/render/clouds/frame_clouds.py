"""The clouds of a frame: uploading, shadows, and drawing."""

from collections.abc import Callable
from contextlib import AbstractContextManager
from typing import Any

from vrut_lite.daylight.cloud_light import ClearLight
from vrut_lite.daylight.clouds import CloudLayer
from vrut_lite.geometry.spherical_harmonics import evaluate_irradiance
from vrut_lite.kernel.ledger import Ledger
from vrut_lite.render.air import FrameAir
from vrut_lite.render.clouds.cloud_pass import COARSER, CloudPass
from vrut_lite.render.clouds.cloud_shadow import CloudShadowMap
from vrut_lite.render.clouds.layer_textures import CloudsOnGpu, CloudSurroundings
from vrut_lite.render.light import Light
from vrut_lite.render.moving_targets import MovingTargets
from vrut_lite.render.passes.view import View
from vrut_lite.render.pieces import Patience
from vrut_lite.render.pyrender_scene import PyrenderScene
from vrut_lite.render.targets import Targets

CLOUD_SHADOWS = "CLOUD_SHADOWS"
Measure = Callable[[str], AbstractContextManager[Any]]


class FrameClouds:
    """The clouds of a frame; made and used on the GL thread only.

    The ledger counts "clouds" drawn, and skips: no clouds, and the copy of depths where no
    mesh reaches up to them.
    """

    def __init__(self, context: Any, ledger: Ledger, patience: Patience):
        self._context = context
        self._ledger = ledger
        self._patience = patience
        # Made with the first layer: a frame without clouds compiles nothing of them.
        self._clouds: CloudsOnGpu | None = None
        self._pass: CloudPass | None = None
        self._shadow: CloudShadowMap | None = None
        self._drawn = False

    def show(self, layer: CloudLayer | None) -> None:
        """Draw this layer from the next frame on; None where there are no clouds."""
        if self._clouds is None:
            if layer is None:
                return
            self._clouds = CloudsOnGpu(self._context)
            self._pass = CloudPass(self._context, self._patience)
            self._shadow = CloudShadowMap(self._context, self._ledger)
        self._clouds.show(layer)

    def prepare(
        self, scene: PyrenderScene, view: View, light: Light, air: FrameAir, size: tuple[int, int]
    ) -> FrameAir:
        """Bind the clouds of this frame; returns the shaders' defines."""
        self._drawn = False
        if self._clouds is None or self._clouds.layer is None:
            self._ledger.skip("clouds: none")
            return air
        self._drawn = True
        around = CloudSurroundings(
            eye_m=view.eye_m,
            ground_level_m=scene.ground_level_m,
            pixel_rad=2.0 / (float(view.projection[1, 1]) * size[1]),
        )
        assert self._shadow is not None
        clear = ClearLight(light.sun_direction, light.sun_irradiance, light.clear_sh)
        beneath = evaluate_irradiance(light.irradiance_sh, (0.0, 1.0, 0.0))
        casts = self._shadow.bind(self._clouds, clear, beneath, around)
        return with_cloud_shadows(air) if casts else air

    @property
    def are_drawn(self) -> bool:
        """Whether this frame has clouds."""
        return self._drawn

    def draw(
        self,
        scene: PyrenderScene,
        targets: Targets | MovingTargets,
        view: View,
        air: FrameAir,
        still: bool,
    ) -> None:
        """Clouds over the sky, and over meshes that stand behind them."""
        if not self._drawn:
            return
        assert self._clouds is not None
        assert self._pass is not None
        assert self._clouds.layer is not None
        base_m = self._clouds.layer.base_m
        before_meshes = max(scene.centre_m[1] + scene.radius_m, view.eye_m[1]) > base_m
        if not before_meshes:
            self._ledger.skip("clouds: before meshes, all below them")
        pixels = 1 if still else COARSER
        assert self._shadow is not None
        self._shadow.bind_light()
        light = None if still else self._shadow.lights
        self._pass.draw(self._clouds, targets, view, air.mesh, pixels, before_meshes, light)
        self._ledger.did("clouds")

    def release(self) -> None:
        """Free the GL objects."""
        for thing in (self._clouds, self._pass, self._shadow):
            if thing is not None:
                thing.release()


def with_cloud_shadows(air: FrameAir) -> FrameAir:
    """The defines where clouds shade the sun; the sky's own ground is shaded only through air."""
    sky = (*air.sky, CLOUD_SHADOWS) if "AIR" in air.sky else air.sky
    return FrameAir((*air.mesh, CLOUD_SHADOWS), sky)
