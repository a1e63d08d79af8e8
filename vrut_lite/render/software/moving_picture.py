"""Moving pictures: one sample per pixel, many of them reprojected from the previous picture."""

import numpy as np
from numpy.typing import NDArray

from vrut_lite.messages.picture import SetExposure
from vrut_lite.pictures import exposure
from vrut_lite.pictures.night_eye import adapted_cd
from vrut_lite.pictures.picture import Picture
from vrut_lite.render.passes.draw_order import in_order
from vrut_lite.render.picture_passes import ONE_SAMPLE, FrameInputs, PicturePasses
from vrut_lite.render.reversed_depth import reversed_depth
from vrut_lite.render.shader_files import Defines
from vrut_lite.render.size_cache import SizeCache
from vrut_lite.render.software.edge_kernel import smooth_edges
from vrut_lite.render.software.moving_targets import MovingTargets
from vrut_lite.render.software.row_threads import run_in_halves
from vrut_lite.render.software.temporal_reprojection import TemporalReprojection
from vrut_lite.render.software.tone_kernel import tone_mapped
from vrut_lite.render.surface_terms import needs_backdrop
from vrut_lite.render.unlocked import read_rgba


class MovingPictures:
    """Draws a shot; the next one reuses its valid pixels. On the GL thread only."""

    def __init__(self, passes: PicturePasses):
        self._passes = passes
        context = passes.context
        self._targets = SizeCache(context, lambda size: MovingTargets(context, size))
        self._reprojection = TemporalReprojection()

    def draw(self, shot: FrameInputs) -> Picture:
        """Draw a shot."""
        passes, view, state = self._passes, shot.view, shot.state
        targets = self._targets.get(state.size_px)
        solid, blended = in_order(shot.seen, view.eye_m)
        passes.meshes.read_finer(shot.scene, 0.0)
        passes.counters.did("picture")
        defines: Defines = (ONE_SAMPLE, *shot.defines.surfaces)
        targets.begin()
        with reversed_depth():
            with passes.measure("depth"):
                passes.meshes.draw_depth_of_solid(solid, view)
            with passes.measure("reuse"):
                self._reprojection.begin(targets, shot)
            with passes.measure("mesh"):
                passes.draw_meshes(shot, solid[::-1], defines, blended=False)
            with passes.measure("sky"):
                passes.sky.draw(targets.size, view, shot.light, shot.disc, True, shot.defines.sky)
            with passes.measure("copy and meter"):
                radiance = self._reprojection.keep(targets, shot)
            if blended or passes.parts.are_drawn:
                targets.draw_over()
                with passes.measure("parts over the sky"):
                    passes.parts.draw_over_sky(targets.size, view)
                with passes.measure("parts over surfaces"):
                    passes.parts.draw_over_solid(shot.parts, targets, sample=0)
                with passes.measure("blended mesh"):
                    if any(needs_backdrop(placed.primitive.material) for placed in blended):
                        passes.backdrop.take(targets.buffer, targets.size)
                    passes.draw_meshes(shot, blended, defines, blended=True)
                radiance = read_rgba(targets.radiance)
        with passes.measure("copy and meter"):
            ev100 = exposure.ev100_of(state.exposure, radiance[..., :3], state.white_card)
        pixel_rad = view.pixel_rad(targets.size)
        with passes.measure("tone map"):
            toned = self._toned(targets, radiance, ev100, state.exposure, pixel_rad)
        with passes.measure("edges"):
            display = _without_steps(toned)
        return Picture(radiance[::-1, :, :3], display, ev100, pixel_rad=pixel_rad)

    def _toned(
        self,
        targets: MovingTargets,
        radiance: NDArray[np.float32],
        ev100: float,
        wish: SetExposure,
        pixel_rad: float,
    ) -> NDArray[np.uint32]:
        """The bytes (h, w) of red, green, blue and luma, row 0 at the bottom."""
        if adapted_cd(ev100, wish.night_look) is not None:
            self._passes.tone.draw(targets.radiance, targets.toned, ev100, wish, pixel_rad)
            return targets.read_toned()
        return tone_mapped(radiance, ev100, wish)

    def release(self) -> None:
        """Free everything; another framebuffer must be bound."""
        self._targets.release()
        self._reprojection.release()


def _without_steps(toned: NDArray[np.uint32]) -> NDArray[np.uint8]:
    """The picture (h, w, 3) for display, its edges smoothed, row 0 at the top."""
    display = np.empty((*toned.shape, 3), np.uint8)
    run_in_halves(smooth_edges, len(toned), toned, display)
    return display
