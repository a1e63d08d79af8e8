"""Pictures while something moves: one sample a pixel, much of it taken over from the one before."""

from vrut_lite.pictures import exposure
from vrut_lite.pictures.picture import Picture
from vrut_lite.render.moving_targets import MovingTargets
from vrut_lite.render.passes.draw_order import in_order
from vrut_lite.render.passes.reuse import Reuse
from vrut_lite.render.picture_passes import PicturePasses, Shot
from vrut_lite.render.reversed_depth import reversed_depth
from vrut_lite.render.shader_files import Defines
from vrut_lite.render.size_cache import SizeCache
from vrut_lite.render.surface_terms import needs_backdrop
from vrut_lite.render.unlocked import read_rgba


class MovingPictures:
    """Draws a shot; the next one takes over what still holds. On the GL thread only."""

    def __init__(self, passes: PicturePasses):
        self._passes = passes
        context = passes.context
        self._targets = SizeCache(context, lambda size: MovingTargets(context, size))
        self._reuse = Reuse()

    def draw(self, shot: Shot) -> Picture:
        """Draw a shot."""
        passes, view, state = self._passes, shot.view, shot.state
        targets = self._targets.get(state.size_px)
        solid, blended = in_order(shot.seen, view.eye_m)
        passes.meshes.read_finer(shot.scene, 0.0)
        passes.ledger.did("picture")
        defines: Defines = (*shot.air.mesh, *passes.lamps.defines)
        reflection = shot.reflection.texture
        targets.begin()
        with reversed_depth():
            with passes.measure("depth"):
                passes.meshes.draw_depth_of_solid(solid, view)
            with passes.measure("reuse"):
                self._reuse.begin(targets, view, state, reflection)
            with passes.measure("mesh"):
                passes.draw_meshes(shot, solid[::-1], defines, blended=False)
            with passes.measure("sky"):
                passes.sky.draw_remaining(targets.size, view, shot.light, shot.disc, shot.air.sky)
            with passes.measure("reading"):
                radiance = self._reuse.keep(targets, view, state, reflection)
            if blended or passes.clouds.are_drawn:
                targets.draw_over()
                with passes.measure("clouds"):
                    passes.clouds.draw(shot.scene, targets, view, shot.air, still=False)
                with passes.measure("blended mesh"):
                    if any(needs_backdrop(placed.primitive.material) for placed in blended):
                        passes.backdrop.take(targets.multisampled, targets.size)
                    passes.draw_meshes(shot, blended, defines, blended=True)
                radiance = read_rgba(targets.radiance)
        with passes.measure("meter"):
            radiance = radiance[::-1, :, :3]
            ev100 = exposure.ev100_of(state.exposure, radiance)
        with passes.measure("tone map"):
            pixel_rad = view.pixel_rad(targets.size)
            passes.tone.draw(targets.radiance, targets.toned, ev100, state.exposure, pixel_rad)
        with passes.measure("edges"):
            display = targets.read_display()
        return Picture(radiance, display, ev100, pixel_rad=pixel_rad)

    def release(self) -> None:
        """Free everything; another framebuffer must be bound."""
        self._targets.release()
        self._reuse.release()
