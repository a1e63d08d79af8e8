"""The clouds of a frame: uploading, shadows, and drawing."""

from collections.abc import Callable
from contextlib import AbstractContextManager
from itertools import zip_longest
from typing import Any

import numpy as np

from vrut_lite.clouds.cloud_layers import clear_light, lights_on
from vrut_lite.geometry.spherical_harmonics import evaluate_irradiance
from vrut_lite.kernel.ledger import Ledger
from vrut_lite.messages.clouds import CloudLayer
from vrut_lite.messages.sun import KeyLightChanged
from vrut_lite.render.air import FrameAir
from vrut_lite.render.clouds.cloud_pass import MARCHED, CloudPass
from vrut_lite.render.clouds.cloud_shadow import CloudShadowMap
from vrut_lite.render.clouds.layer_textures import CloudsOnGpu, CloudSurroundings
from vrut_lite.render.light import Light
from vrut_lite.render.moving_targets import MovingTargets
from vrut_lite.render.passes.view import View
from vrut_lite.render.pieces import Patience
from vrut_lite.render.pyrender_scene import PyrenderScene
from vrut_lite.render.targets import Targets

CLOUD_SHADOWS = "CLOUD_SHADOWS"
# Light that changes by more from one picture to the next shows in all of the next.
_LARGEST_CHANGE = 0.01
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
        # Made with the first layers: a frame without clouds compiles nothing of them.
        self._made: list[CloudsOnGpu] = []
        # Each layer has its own: a moving picture takes clouds over from the one before.
        self._passes: list[CloudPass] = []
        self._shadow: CloudShadowMap | None = None
        self._drawn: list[CloudsOnGpu] = []
        # Light of the clear sky on the ground, and how often it has changed at once.
        self._on_ground = np.zeros(3)
        self._changes = 0

    def show(self, layers: tuple[CloudLayer, ...]) -> None:
        """Draw these layers from the next frame on, from low to high."""
        if layers and self._shadow is None:
            self._shadow = CloudShadowMap(self._context, self._ledger)
        while len(self._made) < len(layers):
            self._made.append(CloudsOnGpu(self._context))
            self._passes.append(CloudPass(self._context, self._patience))
        for cloud, layer in zip_longest(self._made, layers):
            cloud.show(layer)

    def prepare(
        self,
        scene: PyrenderScene,
        view: View,
        light: Light,
        air: FrameAir,
        size: tuple[int, int],
        key_light: KeyLightChanged,
    ) -> FrameAir:
        """Bind the clouds of this frame; returns the shaders' defines."""
        self._drawn = [cloud for cloud in self._made if cloud.layer is not None]
        if not self._drawn:
            self._ledger.skip("clouds: none")
            return air
        around = CloudSurroundings(
            eye_m=view.eye_m,
            ground_level_m=scene.ground_level_m,
            pixel_rad=2.0 / (float(view.projection[1, 1]) * size[1]),
        )
        assert self._shadow is not None
        clear = clear_light(key_light, light.clear_sh, light.lamps_rgb)
        change = np.abs(clear.on_ground - self._on_ground)
        self._changes += bool(np.any(change > _LARGEST_CHANGE * clear.on_ground))
        self._on_ground = clear.on_ground
        beneath = evaluate_irradiance(light.irradiance_sh, (0.0, 1.0, 0.0))
        layers = tuple(cloud.layer for cloud in self._drawn if cloud.layer is not None)
        casts = self._shadow.bind(self._drawn, lights_on(layers, clear), beneath, around)
        return with_cloud_shadows(air) if casts else air

    @property
    def are_drawn(self) -> bool:
        """Whether this frame has clouds."""
        return bool(self._drawn)

    def draw(
        self,
        scene: PyrenderScene,
        targets: Targets | MovingTargets,
        view: View,
        air: FrameAir,
        still: bool,
        sample: int = 0,
    ) -> None:
        """Layers over the sky, and over meshes that stand behind them.

        `sample`: of a still's pictures, which.
        """
        if not self._drawn:
            return
        assert self._shadow is not None
        highest_m = scene.centre_m[1] + scene.radius_m
        light = None if still else self._shadow.lights + self._changes
        eye_m = float(view.eye_m[1])
        # Farther layers first, so that nearer ones are blended over them.
        far_first = sorted(
            zip(self._drawn, self._passes, strict=False),
            key=lambda drawn: drawn[0].distance_m(eye_m),
            reverse=True,
        )
        for cloud, drawing in far_first:
            before_meshes = max(highest_m, view.eye_m[1]) > cloud.base_m
            if not before_meshes:
                self._ledger.skip("clouds: before meshes, all below them")
            if sample not in MARCHED:
                self._ledger.skip("clouds: those of the picture before")
                drawing.draw_again(before_meshes)
                continue
            cloud.bind_again()
            self._shadow.bind_light(self._drawn.index(cloud))
            drawing.draw(cloud, targets, view, air.mesh, before_meshes, light, sample)
            self._ledger.did("clouds")
        # What is drawn next is shaded by the map, which lies at the lowest base.
        self._drawn[0].bind_again()

    def release(self) -> None:
        """Free the GL objects."""
        for thing in (*self._made, *self._passes, self._shadow):
            if thing is not None:
                thing.release()


def with_cloud_shadows(air: FrameAir) -> FrameAir:
    """The defines where clouds shade the sun; the sky's own ground is shaded only through air."""
    sky = (*air.sky, CLOUD_SHADOWS) if "AIR" in air.sky else air.sky
    return FrameAir((*air.mesh, CLOUD_SHADOWS), sky, air.near)
