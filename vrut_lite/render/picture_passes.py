"""Inputs of a picture, and the passes that draw stills and moving pictures."""

from collections.abc import Callable
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass
from typing import Any, NamedTuple

from vrut_lite.frame_part import PartFrame
from vrut_lite.kernel.work_counters import WorkCounters
from vrut_lite.render.backdrop import Backdrop
from vrut_lite.render.frame_parts import FrameParts, PartDefines, PartFailed
from vrut_lite.render.light import Light, Reflection, Shadows
from vrut_lite.render.passes.deferred_meshes import DeferredMeshes
from vrut_lite.render.passes.mesh_renderer import MeshRenderer
from vrut_lite.render.passes.sky_pass import SkyPass, VisibleSun
from vrut_lite.render.passes.tone_pass import TonePass
from vrut_lite.render.passes.view import View
from vrut_lite.render.pyrender_scene import PlacedPrimitive, PyrenderScene
from vrut_lite.render.shader_files import Defines
from vrut_lite.render.tiles import Patience
from vrut_lite.scene.scene_state import SceneState

# Define of mesh shaders for targets with one sample per pixel.
ONE_SAMPLE = "ONE_SAMPLE"
Measure = Callable[[str], AbstractContextManager[Any]]


def unmeasured(name: str) -> AbstractContextManager[None]:
    """Measure nothing."""
    return nullcontext()


class FrameInputs(NamedTuple):
    """Scene, light and view of a picture; `seen`: meshes that may be in it."""

    scene: PyrenderScene
    seen: list[PlacedPrimitive]
    view: View
    light: Light
    disc: VisibleSun
    shadows: Shadows
    reflection: Reflection
    defines: PartDefines
    parts: PartFrame
    state: SceneState


@dataclass
class PicturePasses:
    """The passes, one of each; used on the GL thread only.

    `measure` is entered around each pass, with its name; `counters` counts done and skipped work.
    """

    context: Any
    counters: WorkCounters
    patience: Patience
    meshes: MeshRenderer
    sky: SkyPass
    parts: FrameParts
    tone: TonePass
    backdrop: Backdrop
    measure: Measure = unmeasured

    @staticmethod
    def made(context: Any, counters: WorkCounters, part_failed: PartFailed) -> "PicturePasses":
        """New passes in a context."""
        patience = Patience(counters)
        return PicturePasses(
            context,
            counters,
            patience,
            MeshRenderer(),
            SkyPass(context),
            FrameParts(context, counters, patience, part_failed),
            TonePass(context),
            Backdrop(context),
        )

    def draw_meshes(
        self,
        shot: FrameInputs,
        placed: list[PlacedPrimitive],
        defines: Defines,
        blended: bool,
        deferred: DeferredMeshes | None = None,
    ) -> None:
        """Draw some of a shot's meshes."""
        self.meshes.draw(
            shot.scene,
            placed,
            shot.view,
            shot.light,
            shot.shadows,
            shot.reflection,
            self.parts,
            defines,
            self.parts.air_defines_on,
            blended,
            deferred,
        )

    def release(self) -> None:
        """Free everything; another framebuffer must be bound."""
        self.meshes.delete()
        for thing in (self.sky, self.parts, self.tone, self.backdrop):
            thing.release()
