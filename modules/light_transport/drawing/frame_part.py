"""The light map's part of the frame: the light of surfaces, of points of a still, and mirrors."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
from numpy.typing import NDArray

from light_transport.drawing.hour_on_card import HourOnCard
from light_transport.drawing.light_block import BLOCK, SURFACE_LIGHT
from light_transport.drawing.mapped_scene import (
    FewerRaysLight,
    MappedScene,
    heard_after,
    layout_in,
    light_of_view,
    mapped_scene,
)
from light_transport.drawing.reflection_probes import MirrorCubes
from light_transport.drawing.surface_light import SAMPLERS, SurfaceLightOnGpu
from light_transport.drawing.surface_look_up import reached_irradiance
from light_transport.drawing.value_light import ValueLight
from light_transport.messages import CARD_JOB
from vrut_lite.array import Array
from vrut_lite.errors import GivenUp
from vrut_lite.frame_part import (
    GROUND,
    FramePart,
    Heard,
    Hit,
    MeshChart,
    PartFrame,
    PartGl,
    PlacedSurface,
    Size,
    latest,
)
from vrut_lite.kernel.messages import Derived
from vrut_lite.messages.camera import MoveCamera
from vrut_lite.messages.late_array import LateArray
from vrut_lite.messages.light_map import NOT_MAPPED, LightMapLaid, SurfaceLightChanged
from vrut_lite.messages.scene import SceneOpened
from vrut_lite.messages.sky import AmbientChanged
from vrut_lite.messages.view_light import ViewLightChanged
from vrut_lite.numeric_types import FloatArray

_SHADERS = Path(__file__).parent / "shaders"
_OF_VALUES = ("texels", "noise")


class LightMapPart(FramePart):
    """Lights surfaces by the light map; without one the open sky lights them.

    The counters count each "mirror" in view, and skip pictures without one.
    """

    hears = (SceneOpened, LightMapLaid, SurfaceLightChanged, ViewLightChanged)
    on_demand = (ViewLightChanged,)
    blocks = {BLOCK: SURFACE_LIGHT}  # noqa: RUF012  (the base class says that it is the class's)
    samplers = SAMPLERS
    irradiance = _SHADERS / "surface_light.glsl"

    def __init__(self, gl: PartGl):
        super().__init__(gl)
        self._counters = gl.counters
        # Made with the first light.
        self._gpu: SurfaceLightOnGpu | None = None
        self._card: HourOnCard | None = None
        self._mirrors = MirrorCubes(gl)
        self._values = ValueLight()
        # Late light that the card could not compute, and its numbers.
        self._read: tuple[SurfaceLightChanged, SurfaceLightChanged] | None = None
        # The light of the last picture that showed light.
        self._last: SurfaceLightChanged | None = None
        self._heard: Heard = {}
        self._laid: LightMapLaid | None = None
        self._charts: list[MeshChart | None] | None = None
        self._mirror_of: dict[int, int] = {}
        # The present light, and that of the picture: the same, values in its place, or none.
        self._lit: MappedScene | None = None
        self._drawn: MappedScene | None = None
        self._has_view_light = False
        self._eye_m = np.zeros(3)
        self._sees_sky: dict[int, bool] = {}
        self._uniforms: dict[PlacedSurface, dict[str, NDArray[np.floating]]] = {}

    @classmethod
    def hear(cls, heard: Heard, message: Derived) -> Heard:
        """The latest of each type, and the light by fewer rays; see `heard_after`."""
        return heard_after(heard, message)

    @classmethod
    def irradiance_at(cls, heard: Heard, hit: Hit, sky: AmbientChanged) -> FloatArray | None:
        """Irradiance (3,) of a surface by texels or probes; None where the open sky lights it."""
        lit = mapped_scene(heard)
        return None if lit is None else reached_irradiance(lit, hit, sky.irradiance_sh_rgb.values)

    @classmethod
    def finishes(cls, heard: Heard, camera: MoveCamera, size_px: Size) -> bool:
        """Whether light of the points that a still from here shows is known."""
        return light_of_view(heard, camera, size_px) is not None

    @classmethod
    def may_reuse(cls, before: Heard, now: Heard, hour_moved: bool) -> bool:
        """Whether the map is the same, and its light too unless the hour has moved."""
        if layout_in(before) is not layout_in(now):
            return False
        return hour_moved or _light(before) is _light(now)

    def show(self, heard: Heard) -> None:
        """Light surfaces by these from the next picture on."""
        self._heard, self._lit = heard, mapped_scene(heard)
        self._sees_sky.clear()
        laid = layout_in(heard)
        if laid is not self._laid:
            self._laid, self._charts = laid, None if laid is None else _charts(laid)
            mirrors = None if laid is None else laid.mirrors
            parts = [] if mirrors is None else mirrors.part.values.tolist()
            self._mirror_of = {part: number for number, part in enumerate(parts)}
        if self._lit is None and self._gpu is not None:
            self._gpu.free()
        if self._lit is None:
            self._last = None
        is_late = self._lit is not None and isinstance(self._lit.light.texels, LateArray)
        if self._card is not None and not is_late:
            self._card.release()

    @property
    def is_seen(self) -> bool:
        """Whether there is light of the present map."""
        return self._lit is not None

    @property
    def charts(self) -> Sequence[MeshChart | None] | None:
        """The shapes of the layout."""
        return self._charts

    def prepare(self, frame: PartFrame) -> None:
        """Bring the light of this picture to the GPU, and bind it."""
        lit = self._lit
        assert lit is not None
        drawn = self._drawn = self._light_of(frame, lit)
        self._uniforms.clear()
        self._eye_m = frame.view.eye_m
        if drawn is None:
            return
        if self._gpu is None:
            self._gpu = SurfaceLightOnGpu(self.gl)
        view_light = None
        if frame.is_still and drawn is lit:
            view_light = light_of_view(self._heard, frame.camera, frame.size_px)
        card, light = self._computed(drawn, frame)
        if drawn is lit:
            self._last = light
        drawn = self._drawn = drawn._replace(light=light)
        self._gpu.show(light, card)
        self._has_view_light = self._gpu.show_view(view_light)
        self._gpu.bind(drawn, frame)
        self._mirrors.show(drawn.laid.mirrors, light, card)
        self._upload_mirrors(frame.seen)

    def _computed(
        self, drawn: MappedScene, frame: PartFrame
    ) -> tuple[HourOnCard | None, SurfaceLightChanged]:
        """The card, where it has computed the light to draw, and that light.

        Moving pictures show the last light while a bake's tables come to the card piece by piece.
        """
        light = drawn.light
        texels = light.texels
        if not isinstance(texels, LateArray):
            return None, light
        if self._read is None or self._read[0] is not light:
            self._read = None
            if self._card is None:
                self._card = HourOnCard(self.gl)
            most_pieces = None if frame.is_still else int(frame.is_first_view)
            try:
                is_there = self._card.compute(texels.recipe, most_pieces)
            except GivenUp:
                raise
            except Exception as error:  # Drivers and moderngl raise exceptions of many types.
                self._card.release()
                self.gl.report(CARD_JOB, f"the graphics card could not light surfaces ({error})")
                self._read = light, _read(light)
            else:
                if not is_there:
                    return self._meanwhile(drawn)
                self._counters.did("hour on the card")
                return self._card, light
        return None, self._read[1]

    def _meanwhile(self, drawn: MappedScene) -> tuple[HourOnCard | None, SurfaceLightChanged]:
        """The last light of this map, which costs nothing; without one the processor's numbers."""
        last, card = self._last, self._card
        assert card is not None
        if last is not None and last.fits(drawn.laid):
            if not isinstance(last.texels, LateArray):
                return None, last
            if card.holds(last.texels.recipe):
                return card, last
        return None, _read(drawn.light)

    def _light_of(self, frame: PartFrame, lit: MappedScene) -> MappedScene | None:
        """The scene with light, or with the values in its place that the picture shows."""
        if frame.shows not in _OF_VALUES:
            return lit
        kept = latest(self._heard, FewerRaysLight)
        light = self._values.of(frame.shows, lit, None if kept is None else kept.light)
        return None if light is None else lit._replace(light=light)

    def _upload_mirrors(self, seen: Sequence[PlacedSurface]) -> None:
        numbers = [number for each in seen if (number := self._mirror(each)) is not None]
        for number in numbers:
            self._mirrors.upload(number)
        if numbers:
            self._counters.did("mirror", len(numbers))
        else:
            self._counters.skip("mirror: none in view")

    def _mirror(self, surface: PlacedSurface) -> int | None:
        """Number of the cube map of a surface's surroundings, where it has one."""
        if surface.part is None or not self._mirrors.there:
            return None
        return self._mirror_of.get(surface.part)

    def sees_sky(self, surface: PlacedSurface) -> bool:
        """Whether a texel of the surface sees the sky; True without texels, and for two sides."""
        lit, part = self._lit, surface.part
        if lit is None or part is None or not _has_texels(lit.laid, part):
            return True
        if surface.is_two_sided:
            return True
        if part not in self._sees_sky:
            left, top = lit.laid.part_corner_px.values[part]
            known = lit.light.visible_sky
            texels = lit.light.texels.values[..., 3:] if known is None else known.values
            uv = lit.laid.shape(int(lit.laid.part_shape.values[part])).uv
            # Look-ups reach half a texel beyond.
            columns, rows = np.ceil(uv.max(axis=0, initial=0.0) + 0.5).astype(int)
            share = texels[top : top + rows, left : left + columns]
            self._sees_sky[part] = bool(share.any())
        return self._sees_sky[part]

    def surface_defines(self, surface: PlacedSurface) -> tuple[str, ...]:
        """Defines by the source of a surface's light; none under the open sky."""
        if self._drawn is None:
            return ()
        source = self._source(surface, self._drawn.laid)
        return (*source, "VIEW_LIGHT") if source and self._has_view_light else source

    def _source(self, surface: PlacedSurface, laid: LightMapLaid) -> tuple[str, ...]:
        if surface.part == GROUND:
            return () if laid.ground is None else ("GROUND_LIGHT",)
        probes = () if laid.probes is None else ("LIGHT_PROBES",)
        mirror = () if self._mirror(surface) is None else ("MIRROR",)
        if surface.part is None or not _has_texels(laid, surface.part):
            return (*probes, *mirror) if probes else ()
        if surface.is_two_sided:
            return ("LIGHT_MAP", "TWO_SIDED", *probes, *mirror)
        return ("LIGHT_MAP", *(() if self.sees_sky(surface) else ("NO_SKY",)), *mirror)

    def bind_surface(self, surface: PlacedSurface) -> Mapping[str, Any]:
        """Bind the cubes of a mirror; its place in the map, and the eye from the cubes' middle."""
        number = self._mirror(surface)
        if number is not None:
            self._mirrors.bind(number)
        if surface not in self._uniforms:
            assert self._drawn is not None
            uniforms = self._uniforms[surface] = {}
            if surface.part is not None and _has_texels(self._drawn.laid, surface.part):
                corner = self._drawn.laid.part_corner_px.values[surface.part]
                uniforms["light_corner_px"] = corner.astype(np.float32)
            if number is not None:
                uniforms["mirror_eye_m"] = self._mirrors.from_middle_m(number, self._eye_m)
        return self._uniforms[surface]

    def release(self) -> None:
        """Free the GL objects."""
        self._mirrors.release()
        if self._gpu is not None:
            self._gpu.release()
        if self._card is not None:
            self._card.release()


def _light(heard: Heard) -> SurfaceLightChanged | None:
    lit = mapped_scene(heard)
    return None if lit is None else lit.light


def _read(light: SurfaceLightChanged) -> SurfaceLightChanged:
    """Late light with its numbers, computed here."""
    parts = {name: getattr(light, name) for name in ("texels", "probes", "mirrors")}
    numbers = {name: Array(late.values) for name, late in parts.items() if late is not None}
    return msgspec.structs.replace(light, **numbers)


def _has_texels(laid: LightMapLaid, part: int) -> bool:
    return part != GROUND and int(laid.part_shape.values[part]) != NOT_MAPPED


def _charts(laid: LightMapLaid) -> list[MeshChart | None]:
    """The chart of each part of the scene; instances of one shape share it."""
    made: dict[int, MeshChart | None] = {NOT_MAPPED: None}
    numbers = laid.part_shape.values.tolist()
    for number in numbers:
        if number not in made:
            shape = laid.shape(number)
            made[number] = MeshChart(shape.source_vertex, shape.uv, shape.triangles)
    return [made[number] for number in numbers]
