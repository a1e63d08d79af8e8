"""The modules' parts of the frame: made, shown their messages and drawn, on the GL thread."""

import logging
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple, TypeVar

import numpy as np

from vrut_lite.errors import GivenUp, UserError
from vrut_lite.foreign_errors import sentence_of
from vrut_lite.frame_part import (
    FramePart,
    Heard,
    MeshChart,
    PartFrame,
    PartTarget,
    PartView,
    PlacedSurface,
    Size,
)
from vrut_lite.installed_parts import HOOKS_OF_SEVERAL, PartsHeard, frame_parts, part_with
from vrut_lite.interrupts import pass_interrupt
from vrut_lite.kernel.work_counters import WorkCounters
from vrut_lite.render.context_loss import ContextLostError, loss
from vrut_lite.render.gl_owner import bind_permanent_framebuffer
from vrut_lite.render.hook_glsl import hook_define
from vrut_lite.render.part_slots import part_blocks, part_units
from vrut_lite.render.passes.full_screen import FullScreen
from vrut_lite.render.passes.programs import compile_error
from vrut_lite.render.passes.view import View
from vrut_lite.render.pyrender_scene import PlacedPrimitive
from vrut_lite.render.reversed_depth import BEFORE_SKY, DepthTexture
from vrut_lite.render.shader_files import Defines, defined, shader_source
from vrut_lite.render.size_cache import SizeCache
from vrut_lite.render.tiles import Patience, TiledPass
from vrut_lite.render.unlocked import build_mipmaps, run_compute
from vrut_lite.uniform_block import UniformBlock

from OpenGL import GL  # isort: skip  (after `reversed_depth`, which prepares it)

# Called with the name of a part, of the work that failed, and a sentence.
PartFailed = Callable[[str, str, str], None]
# The work whose failure leaves a part out of pictures.
DRAWING = "frame part"
T = TypeVar("T")
_NOTHING: Heard = {}
_UNITS = "GL_MAX_COMBINED_TEXTURE_IMAGE_UNITS"
_log = logging.getLogger(__name__)


def warn_of_part(name: str, work: str, error: str) -> None:
    """Log a part's failure, where there is no kernel to post it."""
    if work == DRAWING:
        _log.warning("the frame part %s is left out of pictures: %s", name, error)
    else:
        _log.warning("the frame part %s: %s: %s", name, work, error)


class PartDefines(NamedTuple):
    """Defines of shaders that call hooks of parts in a picture.

    Attributes:
        lights: for surfaces, of their light only.
        air: for shaders of parts, of the air in front of their fragments.
        surfaces: for surfaces, of light and air.
        sky: for the background, without air if the sky includes it.
    """

    lights: Defines
    air: Defines
    surfaces: Defines
    sky: Defines


class FrameParts:
    """One of each installed part."""

    def __init__(
        self, context: Any, counters: WorkCounters, patience: Patience, failed: PartFailed
    ):
        self._context, self._counters, self._patience = context, counters, patience
        self._tell_failed = failed
        self._types = frame_parts()
        self._lights_surfaces = part_with("irradiance", self._types)
        # Parts are created when they first have messages to show.
        self._parts: dict[str, FramePart] = {}
        self._made: dict[str, PartRenderer] = {}
        self._heard: dict[str, Heard] = {}
        self._failed: set[str] = set()
        # The part that draws the air in the prepared picture.
        self._air: FramePart | None = None

    def show(self, heard: PartsHeard) -> None:
        """Draw these messages from the next picture on."""
        for name in self._types:
            own, before = heard.get(name, _NOTHING), self._heard.get(name, _NOTHING)
            if own.keys() == before.keys() and all(own[kind] is before[kind] for kind in own):
                continue
            self._heard[name] = own
            if name not in self._failed:
                self._do(name, partial(self._show, name, own))

    def _show(self, name: str, heard: Heard) -> None:
        if name not in self._parts:
            self._made[name] = PartRenderer(
                self._context, self._counters, self._patience, partial(self._tell_failed, name)
            )
            self._parts[name] = self._types[name](self._made[name])
        self._parts[name].show(heard)

    @property
    def are_drawn(self) -> bool:
        """Whether any part draws over the sky or surfaces."""
        return any(map(_draws, self._seen().values()))

    def _seen(self) -> dict[str, FramePart]:
        return {name: part for name, part in self._parts.items() if part.is_seen}

    def prepare(self, frame: PartFrame) -> PartDefines:
        """Let parts prepare a picture; defines of their hooks in it."""
        for name in self._types:
            if name not in self._seen():
                self._counters.skip(f"{name}: none to be seen")
        for name, part in self._seen().items():
            self._do(name, partial(part.prepare, frame))
        seen = self._seen()
        sun = _hook_defines("sun_factor", [name for name, part in seen.items() if part.shades_sun])
        extra = _hook_defines(
            "extra_lights", [name for name, part in seen.items() if part.extra_lights]
        )
        self._air = next((part for part in seen.values() if part.through_air), None)
        air: Defines = () if self._air is None else ("THROUGH_AIR", *self._air.air_defines)
        through = (*air, "LIGHT_SHAFTS") if air and frame.light_shafts else air
        on_sky = through if frame.ground_is_bare or frame.light_shafts else ()
        return PartDefines(
            lights=(*sun, *extra),
            air=air,
            surfaces=(*through, *sun, *extra),
            sky=(*on_sky, *sun) if on_sky else (),
        )

    @property
    def fill_air(self) -> bool:
        """Whether air is visible."""
        return any(part.through_air for part in self._seen().values())

    def air_defines_on(self, placed: PlacedPrimitive) -> Defines:
        """Further defines of the air in front of a mesh."""
        if self._air is None:
            return ()
        return self._air.air_defines_on(placed.centre_m, placed.radius_m)

    def draw_over_solid(self, frame: PartFrame, target: PartTarget, sample: int) -> None:
        """Let parts draw over sky and opaque surfaces; depth is reversed."""
        for name, part in self._seen().items():
            self._do(name, partial(part.draw_over_solid, frame, target, sample))

    def draw_over_sky(self, size_px: Size, view: View) -> None:
        """Let parts add to the uncovered sky; depth is reversed."""
        seen = self._seen()
        if not seen:
            return
        context = self._context
        GL.glDepthFunc(GL.GL_GEQUAL)
        context.enable(context.DEPTH_TEST | context.BLEND)
        context.disable(context.CULL_FACE)
        context.depth_mask = False
        GL.glBlendFuncSeparate(GL.GL_ONE, GL.GL_ONE, GL.GL_ZERO, GL.GL_ONE)
        GL.glDepthRange(BEFORE_SKY, 1.0)
        for name, part in seen.items():
            self._do(name, partial(part.draw_over_sky, size_px, view))
        GL.glDepthRange(0.0, 1.0)
        GL.glDisable(GL.GL_SCISSOR_TEST)
        context.disable(context.BLEND)
        context.depth_mask = True
        GL.glDepthFunc(GL.GL_GREATER)

    # --- the part that lights surfaces ----------------------------------------------------

    @property
    def charts(self) -> Sequence[MeshChart | None] | None:
        """Charts of the scene's parts, by the messages that were shown last."""
        part = self._parts.get(self._lights_surfaces)
        return None if part is None else self._do(self._lights_surfaces, lambda: part.charts)

    def sees_sky(self, surface: PlacedSurface) -> bool:
        """Whether a surface may get light from the sky itself."""
        return self._of_surfaces(lambda part: part.sees_sky(surface), True)

    def surface_defines(self, surface: PlacedSurface) -> Defines:
        """Defines of the program of a surface that a part lights; empty under the open sky."""
        none: Defines = ()
        defines = self._of_surfaces(lambda part: part.surface_defines(surface), none)
        return ("IRRADIANCE", *defines) if defines else ()

    def bind_surface(self, surface: PlacedSurface) -> Mapping[str, Any]:
        """Bind a lit surface's textures; returns values of its program's uniforms."""
        return self._of_surfaces(lambda part: part.bind_surface(surface), {})

    def _of_surfaces(self, work: Callable[[FramePart], T], otherwise: T) -> T:
        """A call of the part that lights surfaces; `otherwise` without one or its light."""
        part = self._parts.get(self._lights_surfaces)
        if part is None or not part.is_seen:
            return otherwise
        found = self._do(self._lights_surfaces, partial(work, part))
        return otherwise if found is None else found

    def _do(self, name: str, work: Callable[[], T]) -> T | None:
        """Do a part's work; one that raises is left out from now on."""
        try:
            return work()
        except GivenUp:
            raise
        except BaseException as error:
            pass_interrupt(error)
            # In a lost context everything fails.
            if loss(error):
                raise
            self._leave_out(name, sentence_of(error))
            return None

    def _leave_out(self, name: str, sentence: str) -> None:
        self._parts.pop(name, None)
        self._failed.add(name)
        self._tell_failed(name, DRAWING, sentence)

    def drop_broken_glsl(self, surfaces: Iterable[PlacedSurface]) -> bool:
        """Leave out parts whose GLSL does not compile in the surfaces' shader; whether any."""
        left_out = False
        for name, part in self._seen().items():
            for defines in _defines_to_try(name, part, surfaces):
                if (error := compile_error(defines)) is not None:
                    self._leave_out(name, f"its GLSL does not compile: {error}")
                    left_out = True
                    break
        return left_out

    def release(self) -> None:
        """Free all GL objects."""
        for name, part in list(self._parts.items()):
            self._do(name, part.release)
        for made in self._made.values():
            made.release()


def _hook_defines(hook: str, part_names: list[str]) -> Defines:
    """Defines with which shaders call a hook of these parts; none without parts."""
    of_parts = (hook_define(hook, name) for name in part_names)
    return (hook.upper(), *of_parts) if part_names else ()


def _defines_to_try(
    name: str, part: FramePart, surfaces: Iterable[PlacedSurface]
) -> Iterator[Defines]:
    """Defines with which each hook of a part is compiled by itself."""
    for hook in HOOKS_OF_SEVERAL:
        if getattr(part, hook) is not None:
            yield _hook_defines(hook, [name])
    if part.through_air is not None:
        yield ("THROUGH_AIR", *part.air_defines)
    if part.irradiance is not None:
        of_surfaces = {part.surface_defines(surface) for surface in surfaces}
        yield from (("IRRADIANCE", *defines) for defines in of_surfaces if defines)


def _draws(part: FramePart) -> bool:
    kind = type(part)
    return (
        kind.draw_over_sky is not FramePart.draw_over_sky
        or kind.draw_over_solid is not FramePart.draw_over_solid
    )


class PartRenderer:
    """The renderer's side of a part; see `PartGl`."""

    gl, before_sky = GL, BEFORE_SKY

    def __init__(
        self,
        context: Any,
        counters: WorkCounters,
        patience: Patience,
        report: Callable[[str, str], None],
    ):
        self.context, self.counters = context, counters
        self._patience = patience
        self._report = report
        self._made: list[Any] = []

    def screen(self, fragment_shader: Path, defines: Defines = ()) -> "_PartScreen":
        """A program of a module's own shader."""
        screen = _PartScreen(self.context, fragment_shader, defines)
        self._made.append(screen)
        return screen

    def compute(self, shader: Path, defines: Defines = ()) -> "_PartCompute":
        """A compute shader of a module's own."""
        made = _PartCompute(self.context, shader, defines)
        self._made.append(made)
        return made

    def check_wanted(self) -> None:
        """Return if the picture is still wanted.

        Raises:
            GivenUp: it is not.
        """
        self._patience.check()

    def report(self, job: str, error: str) -> None:
        """Send the part's module a failed `JobResult`.

        Raises:
            ContextLostError: the context is lost, in which everything fails.
        """
        if why := loss():
            raise ContextLostError(why)
        self._report(job, error)

    def tiles(self, most: int | None = None) -> TiledPass:
        """TiledPass of a slow pass."""
        return TiledPass(self._patience, most)

    def depth_copy(self, size: Size) -> DepthTexture:
        """A texture for the depth of pictures of a size."""
        return DepthTexture(size)

    def by_size(self, make: Callable[[Size], Any]) -> SizeCache[Any]:
        """A cache of the results of `make`, by size."""
        return SizeCache(self.context, make)

    def block(self, name: str) -> UniformBlock:
        """A block with its binding."""
        return part_blocks()[name]

    def unit(self, sampler: str) -> int:
        """Texture unit of a sampler.

        Raises:
            UserError: the driver has fewer units than all installed parts require.
        """
        unit, limit = part_units()[sampler], self.context.info[_UNITS]
        if unit >= limit:
            raise UserError(f"its texture {sampler} needs unit {unit}, and this driver has {limit}")
        return unit

    def average_down(self, texture: Any) -> None:
        """Generate the mipmaps of a texture."""
        is_volume = len(texture.size) == 3
        build_mipmaps(GL.GL_TEXTURE_3D if is_volume else GL.GL_TEXTURE_2D, texture)

    def leave_framebuffers(self) -> None:
        """Bind a permanent framebuffer."""
        bind_permanent_framebuffer(self.context)

    def program(self, vertex_shader: Path, fragment_shader: Path) -> Any:
        """moderngl's program of a module's own shaders."""
        program = self.context.program(
            vertex_shader=shader_source(vertex_shader),
            fragment_shader=shader_source(fragment_shader),
        )
        self._made.append(program)
        return program

    def release(self) -> None:
        """Free all programs."""
        for thing in self._made:
            thing.release()


class _PartScreen(FullScreen):
    """A shader for every pixel, with the pixel's ray as its input."""

    def draw(
        self, view: PartView | None = None, box_px: tuple[int, int, int, int] | None = None
    ) -> None:
        """Draw into the bound framebuffer, or a box of it: left, lower, width and height."""
        if view is not None:
            self.set("ray_from_clip", np.linalg.inv(view.clip_from_eye).T.ravel())
        if box_px is not None:
            GL.glEnable(GL.GL_SCISSOR_TEST)
            GL.glScissor(*box_px)
        super().draw()
        GL.glDisable(GL.GL_SCISSOR_TEST)


class _PartCompute:
    """A compute shader; work that follows sees what it wrote."""

    def __init__(self, context: Any, shader: Path, defines: Defines):
        self._context = context
        source = defined(shader_source(shader), dict.fromkeys(defines, 1))
        self._program = context.compute_shader(source)

    def set(self, name: str, value: Any) -> None:
        """Set a uniform, a number or numbers, unless the compiler found it unused."""
        if name in self._program:
            number = isinstance(value, int | float)
            self._program[name].value = value if number else tuple(map(float, value))

    def run(self, x: int, y: int = 1, z: int = 1) -> None:
        """Run so many work groups."""
        run_compute(self._program, x, y, z)
        self._context.memory_barrier()

    def release(self) -> None:
        """Free the program."""
        self._program.release()
