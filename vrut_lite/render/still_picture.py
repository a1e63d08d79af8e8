"""Complete pictures, also in false colours: one, or the mean of several shifted ones."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from vrut_lite.geometry.colour import LUMENS_PER_WATT, luminance
from vrut_lite.messages.picture import SetExposure
from vrut_lite.numeric_types import Float32Array
from vrut_lite.pictures import exposure
from vrut_lite.pictures.glare import with_glare
from vrut_lite.pictures.picture import Picture
from vrut_lite.pictures.value_picture import value_pixels, values_of
from vrut_lite.render.card_targets import CardTargets
from vrut_lite.render.culling import in_view, part_of
from vrut_lite.render.passes.caster_renderer import is_all_solid
from vrut_lite.render.passes.deferred_meshes import DeferredMeshes
from vrut_lite.render.passes.draw_order import in_order
from vrut_lite.render.passes.view import View
from vrut_lite.render.picture_passes import ONE_SAMPLE, FrameInputs, PicturePasses
from vrut_lite.render.picture_sum import PictureSum
from vrut_lite.render.pyrender_scene import PlacedPrimitive
from vrut_lite.render.reversed_depth import reversed_depth
from vrut_lite.render.shader_files import Defines
from vrut_lite.render.size_cache import SizeCache
from vrut_lite.render.surface_terms import needs_backdrop
from vrut_lite.render.targets import SAMPLES, Targets
from vrut_lite.render.tiles import Piece, TiledPass, smaller_boxes
from vrut_lite.scene.scene_state import SceneState, Shown

# A still is the mean of pictures with one sample per pixel, shifted to the right and up, in pixels.
# Software renderers shade hidden samples of multisampled pictures too: three such pictures cost
# about as much as one of four samples and are closer to 64 samples; eight have half the error.
SHIFTS_PX = tuple(
    ((2 * i - 7) / 16, (2 * j - 7) / 16) for i, j in enumerate((2, 5, 0, 7, 3, 6, 1, 4))
)
FEWER_SHIFTS_PX = ((-1 / 3, 0.0), (0.0, 1 / 3), (1 / 3, -1 / 3))
_UNSHIFTED_PX = ((0.0, 0.0),)
# Least covered fraction of a pixel that shows a value.
_LEAST_COVERED = 0.5
DrawnInto = Targets | CardTargets


class StillPictures:
    """Draws a shot; keeps the last still for other exposures. On the GL thread only."""

    def __init__(self, passes: PicturePasses, several_samples: bool):
        """`several_samples`: an unfinished picture is one multisampled picture."""
        self._passes, self._defers = passes, not several_samples
        self._shifts_px = _UNSHIFTED_PX if several_samples else FEWER_SHIFTS_PX
        self._pieces = TiledPass(passes.patience)
        context = passes.context
        self._of_one = SizeCache(context, lambda size: Targets(context, size, SAMPLES))
        self._of_several = SizeCache(context, lambda size: Targets(context, size, 1))
        # On a card the pictures of a mean are added there: each would take long to read.
        self._sum = PictureSum(context) if several_samples else None
        # The last still, whose radiance its targets still hold.
        self._last: tuple[SceneState, Targets, NDArray[np.float32]] | None = None

    def exposed_again(self, state: SceneState, view: View) -> Picture | None:
        """The last still with another exposure; None if anything else differs."""
        if self._last is None:
            return None
        drawn, targets, radiance = self._last
        if drawn.exposure == state.exposure or not state.shares_all_but(drawn, "exposure"):
            return None
        if targets.is_released:
            return None
        self._passes.counters.skip("picture: the same but for its exposure")
        self._last = state, targets, radiance
        return self._exposed(targets, radiance, view, state)

    def forget(self) -> None:
        """Drop the last still: another picture may overwrite its targets."""
        self._last = None

    def draw(self, shot: FrameInputs, still: bool, finished: bool) -> Picture:
        """Draw a shot, the mean of several pictures if `finished`; a `still` is kept.

        Raises:
            GivenUp: see `Patience`.
        """
        passes, state = self._passes, shot.state
        shifts = SHIFTS_PX if finished else self._shifts_px
        targets = (self._of_one if len(shifts) == 1 else self._of_several).get(state.size_px)
        passes.meshes.read_finer(shot.scene, np.log2(len(shifts)) / 2.0 if finished else 0.0)
        passes.counters.did("picture", len(shifts))
        try:
            resolved = self._mean(shot, targets, shifts)
        finally:
            passes.meshes.picture_number, passes.meshes.picture_count = 0, 1
        if state.shows != "picture":
            return _in_false_colours(resolved, state.shows)
        radiance = resolved[..., :3]
        if len(shifts) > 1:
            with passes.measure("copy and meter"):
                targets.write_resolved(resolved)
        if still:
            self._last = state, targets, radiance
        return self._exposed(targets, radiance, shot.view, state)

    def draw_once(self, targets: DrawnInto, shot: FrameInputs) -> None:
        """Draw one unshifted picture of a shot into the bound framebuffer."""
        self._passes.meshes.picture_number, self._passes.meshes.picture_count = 0, 1
        with reversed_depth():
            self._draw_seen(targets, shot, sample=0)

    def release(self) -> None:
        """Free everything; another framebuffer must be bound."""
        self._of_one.release()
        self._of_several.release()
        if self._sum is not None:
            self._sum.release()

    def _mean(
        self, shot: FrameInputs, targets: Targets, shifts: tuple[tuple[float, float], ...]
    ) -> NDArray[np.float32]:
        """The mean (h, w, 4) of shifted pictures, row 0 at the top."""
        passes, state = self._passes, shot.state
        passes.meshes.picture_count = len(shifts)
        total: NDArray[np.float32] | None = None
        for sample, shift_px in enumerate(shifts):
            passes.patience.check()
            passes.meshes.picture_number = sample
            targets.buffer.use()
            targets.buffer.clear()
            view = shot.view if len(shifts) == 1 else shot.view.shifted(shift_px, targets.size)
            with reversed_depth():
                self._draw_seen(targets, shot._replace(view=view), sample)
            with passes.measure("resolve"):
                if self._sum is not None and len(shifts) > 1:
                    self._sum.add(targets.radiance, first=sample == 0)
                else:
                    resolved = targets.read_resolved()
                    total = resolved if total is None else np.add(total, resolved, out=total)
            if state.shows == "picture":
                drawn = passes.sky.count_samples()
                passes.counters.did("sky sample", drawn)
                passes.counters.skip("sky sample: covered", targets.samples - drawn)
        if total is None:
            assert self._sum is not None
            total = self._sum.read(targets.size)
        if len(shifts) > 1:
            total /= np.float32(len(shifts))
        return total[::-1]

    def _exposed(
        self, targets: Targets, radiance: NDArray[np.float32], view: View, state: SceneState
    ) -> Picture:
        """The picture whose radiance (h, w, 3) the targets hold."""
        passes = self._passes
        with passes.measure("copy and meter"):
            ev100 = exposure.ev100_of(state.exposure, radiance, state.white_card)
        with passes.measure("tone map"):
            pixel_rad = view.pixel_rad(targets.size)
            if state.exposure.glare > 0.0:
                veiled = with_glare(radiance, state.exposure.glare, pixel_rad)
                targets.write_resolved(_opaque(veiled))
            passes.tone.draw(targets.radiance, targets.display, ev100, state.exposure, pixel_rad)
            if state.exposure.glare > 0.0:
                # For another exposure, as `_last` says.
                targets.write_resolved(_opaque(radiance))
        return Picture(radiance, targets.read_display(), ev100, pixel_rad=pixel_rad)

    def _draw_seen(self, targets: DrawnInto, shot: FrameInputs, sample: int) -> None:
        """Draw opaque surfaces, the sky, frame parts, and blended surfaces.

        False colours show opaque surfaces only.
        """
        passes, state = self._passes, shot.state
        solid, blended = in_order(shot.seen, shot.view.eye_m)
        defines = _defines(shot)
        if targets.has_one_sample:
            defines = (ONE_SAMPLE, *defines)
        if state.shows != "picture":
            with passes.measure("mesh"):
                self._draw_meshes(targets, shot, solid, defines)
            return
        if not state.skips.sky:
            self._draw_sky(targets, shot)
        with passes.measure("mesh"):
            self._draw_meshes(targets, shot, solid, defines)
        if state.skips.sky:
            self._draw_sky(targets, shot)
        with passes.measure("parts over the sky"):
            passes.parts.draw_over_sky(targets.size, shot.view)
        with passes.measure("parts over surfaces"):
            passes.parts.draw_over_solid(replace(shot.parts, view=shot.view), targets, sample)
        if any(needs_backdrop(placed.primitive.material) for placed in blended):
            with passes.measure("backdrop"):
                passes.backdrop.take(targets.buffer, targets.size)
            passes.counters.did("backdrop")
        with passes.measure("blended mesh"):
            self._draw_meshes(targets, shot, blended, defines, blended=True)

    def _draw_meshes(
        self,
        targets: DrawnInto,
        shot: FrameInputs,
        placed: list[PlacedPrimitive],
        defines: Defines,
        blended: bool = False,
    ) -> None:
        """Draw meshes in pieces of the picture, opaque ones after their depth."""
        passes = self._passes
        # The same in all pieces: pixels must not depend on where these end.
        fit = self._defers and targets.has_one_sample and not blended
        deferred = DeferredMeshes.among(placed if fit else [], shot.view, targets.size)
        if deferred.numbers:
            passes.counters.did("deferred mesh", len(deferred.numbers))

        def draw(piece: Piece) -> None:
            within = placed
            if shot.state.skips.meshes and piece[2:] != targets.size:
                part = part_of(shot.view, targets.size, piece)
                within = [p for p in placed if in_view(p, part)]
            here = deferred.within(within, piece)
            if blended:
                passes.draw_meshes(shot, within, defines, blended)
            elif here.numbers:
                self._draw_deferred(targets, shot, within, defines, piece, here)
            else:
                passes.meshes.draw_depth_of_solid(within, shot.view)
                # At equal depth the last fragment shows: that of the nearer mesh.
                passes.draw_meshes(shot, within[::-1], defines, blended)

        if placed:
            self._pieces.draw(targets.size, draw)

    def _draw_deferred(
        self,
        targets: DrawnInto,
        shot: FrameInputs,
        placed: list[PlacedPrimitive],
        defines: Defines,
        piece: Piece,
        deferred: DeferredMeshes,
    ) -> None:
        """Draw opaque meshes, given from near to far, some of them deferred."""
        assert isinstance(targets, Targets)
        passes, surfaces = self._passes, targets.surfaces
        at_once = [each for each in placed[::-1] if each not in deferred.numbers]
        solid: list[PlacedPrimitive] = []
        holed: list[PlacedPrimitive] = []
        for each in at_once:
            (solid if is_all_solid(each.primitive.material) else holed).append(each)
        with smaller_boxes(piece):
            surfaces.begin(deferred.boxes.values())
        passes.meshes.draw_surfaces(placed, shot.view, passes.parts, deferred)
        with smaller_boxes(piece):
            surfaces.number(deferred.boxes.values())
        passes.draw_meshes(shot, solid, defines, blended=False)
        # At equal depth the nearer mesh has a pixel's number.
        with smaller_boxes(piece), surfaces.lit():
            passes.draw_meshes(shot, list(deferred.numbers), defines, False, deferred)
        passes.draw_meshes(shot, holed, defines, blended=False)

    def _draw_sky(self, targets: DrawnInto, shot: FrameInputs) -> None:
        passes, skips = self._passes, shot.state.skips
        with passes.measure("sky"):
            pictures = passes.meshes.picture_count
            passes.sky.draw(
                targets.size,
                shot.view,
                shot.light,
                shot.disc,
                skips.sky,
                shot.defines.sky,
                pictures,
            )


def _opaque(radiance: NDArray[np.floating]) -> NDArray[np.float32]:
    """Radiance (h, w, 3) with an alpha of 1."""
    return np.dstack([radiance, np.ones(radiance.shape[:2])]).astype(np.float32)


def _defines(shot: FrameInputs) -> Defines:
    """Defines of the mesh shaders."""
    if shot.state.shows == "picture":
        return shot.defines.surfaces
    if shot.state.shows == "illuminance":
        return ("ILLUMINANCE", *shot.defines.lights)
    return ("ILLUMINANCE", "MAP_VALUES")


def _in_false_colours(resolved: Float32Array, shows: Shown) -> Picture:
    """The picture of values (h, w, 4); alpha is the share of a pixel with a value."""
    value: NDArray[np.floating] = resolved[..., 0]
    if shows == "illuminance":
        value = luminance(resolved[..., :3]) * LUMENS_PER_WATT
    covered = (resolved[..., 3] >= _LEAST_COVERED) & (value > 0.0)
    share = np.where(covered, resolved[..., 3], 1.0)
    values = np.where(covered, value / share, np.nan).astype(np.float32)
    found = values_of(values, shows)
    each = np.repeat(np.nan_to_num(values)[..., None], 3, axis=-1)
    return Picture(each, value_pixels(found), exposure.ev100_of(SetExposure(), each), found)
