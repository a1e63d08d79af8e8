"""The module that posts the complete light of the sky, for all consumers."""

from collections.abc import Callable
from typing import Any, TypeVar

import msgspec
import numpy as np

from vrut_lite import __version__
from vrut_lite.array import Array
from vrut_lite.geometry.encoding import decode_float16
from vrut_lite.kernel.messages import Demand, Derived, JobResult, SlotChanged
from vrut_lite.kernel.module import Link, Manifest, Module, handles
from vrut_lite.messages.camera import MoveCamera
from vrut_lite.messages.gpu_texture import GpuTexture
from vrut_lite.messages.scene import SceneNeeds, SceneOpened
from vrut_lite.messages.sky import (
    AmbientChanged,
    BackgroundChanged,
    SkyPolarisationChanged,
    SkyRadianceChanged,
)
from vrut_lite.messages.sky_light import LIGHT, SkyGlowAdded, SkyLightChanged
from vrut_lite.messages.sun import KeyLightChanged
from vrut_lite.numeric_types import Vector
from vrut_lite.sky.sky_glow import with_glow
from vrut_lite.sky.sky_layer import SkyLayer, Viewpoint, sky_layers
from vrut_lite.sky.sky_of_hour import polarisation_message

NAME = "sky_sum"
JOB = "sum"
# Edge of the summed cube map in texels, used when the consumer gives no size.
CUBE_SIZE = 64
# Layers that are seen from a place that has risen by less than this share of their distance look
# the same.
_UNSEEN_SHARE = 0.02
_LEAST_DISTANCE_M = 50.0
# Radiance of an even sky that outshines all layers, to measure how much of it they transmit.
_OUTSHINES = 2.0**24
Layers = dict[SkyLayer, Derived]
D = TypeVar("D", bound=Derived)


class SumOutdated(Derived, frozen=True, kw_only=True):
    """A source of the sum has changed; delivered after all messages of that change."""


class SkySum(Module):
    """Posts `SkyLightChanged` where it is demanded.

    Without layers its parts are the clear sky's own messages, in the same transaction; with a
    layer (`SkyLayer`) or a glow (`SkyGlowAdded`) a background job sums. The counters count "sum"
    posted, and skips "sum: no layers", "sum: unwanted" and "sum: no change to be seen".
    """

    speaks = (SumOutdated,)
    manifest = Manifest(
        name=NAME, title="All light of the sky", version=__version__, auxiliary=True
    )

    def __init__(self, link: Link, settings: Any):
        super().__init__(link, settings)
        self._wanted: Demand | None = None
        # Sources of the latest sum, posted or under way.
        self._made_from: tuple[Any, ...] = ()
        self._layers: Layers = {}
        # Glows by the modules that add them.
        self._glows: dict[str, SkyGlowAdded] = {}
        self._height_m = 0.0

    # --- sources -------------------------------------------------------------------------

    @handles(Demand)
    def on_demand(self, message: Demand) -> None:
        """Pass demands for the sum on to the sky and its layers."""
        if message.message != SkyLightChanged.__name__:
            return
        self._wanted = self.link.wanted(SkyLightChanged)
        for layer in sky_layers().values():
            self.link.demand(layer.hears, 0 if self._wanted is None else None)
        self._want_sky()
        self.link.post(SumOutdated())

    @handles(*(layer.hears for layer in sky_layers().values()))
    def on_layer(self, _message: Derived) -> None:
        """With a layer the sky is needed as an array."""
        self._want_sky()
        self.link.post(SumOutdated())

    @handles(SkyGlowAdded)
    def on_glow(self, message: SkyGlowAdded) -> None:
        """A module's glow has changed or ended."""
        self._glows[message.source] = message
        self._keep_glows(lambda glow: glow.glow_rgb is not None)

    @handles(SlotChanged)
    def on_slot(self, message: SlotChanged) -> None:
        """Glows of a slot that nobody holds are gone."""
        if message.holder == "":
            self._keep_glows(lambda glow: glow.of_slot != message.name)
        self.link.post(SumOutdated())

    def _keep_glows(self, is_kept: Callable[[SkyGlowAdded], bool]) -> None:
        self._glows = {source: glow for source, glow in self._glows.items() if is_kept(glow)}
        self._want_sky()
        self.link.post(SumOutdated())

    @handles(BackgroundChanged)
    @handles(KeyLightChanged)
    @handles(AmbientChanged)
    @handles(SkyRadianceChanged)
    @handles(SkyPolarisationChanged)
    @handles(SceneOpened)
    @handles(SceneNeeds)
    @handles(MoveCamera)
    def parts_changed(self, _message: Any) -> None:
        """Sum when all parts of this change were heard: parts of two hours have no sum."""
        self.link.post(SumOutdated())

    @handles(SumOutdated)
    def all_heard(self, _message: SumOutdated) -> None:
        """Sum if a source changed."""
        self._update()

    @handles(JobResult)
    def summed(self, result: JobResult) -> None:
        """Post a sum; the kernel posts a Fault for a failed job."""
        if result.error:
            self._made_from = ()
        else:
            self._post(result.value)

    # --- summing -------------------------------------------------------------------------

    def _want_sky(self) -> None:
        """Demand the clear sky; nothing is read back from the GPU, so it is made as an array."""
        wanted, exact = self._wanted, bool(self._there() or self._glows)
        for kind in LIGHT:
            size = 0 if wanted is None else wanted.size
            self.link.demand(kind, size, "float16" if exact and wanted is not None else "")
        self.link.demand(SkyRadianceChanged, None if exact and wanted is not None else 0)

    def _there(self) -> Layers:
        """Messages of the layers that are before the sky."""
        heard = ((layer, self.link.last(layer.hears)) for layer in sky_layers().values())
        return {layer: last for layer, last in heard if last is not None and layer.is_there(last)}

    def _update(self) -> None:
        if self._wanted is None:
            self.counters.skip("sum: unwanted")
            self._forget()
            return
        background = self.link.last(BackgroundChanged)
        key_light, ambient = self.link.last(KeyLightChanged), self.link.last(AmbientChanged)
        if background is None or key_light is None or ambient is None:
            return
        radiance = self._last_wanted(SkyRadianceChanged)
        clear = SkyLightChanged(
            background=background,
            key_light=key_light,
            ambient=ambient,
            radiance=radiance,
            polarisation=self._last_wanted(SkyPolarisationChanged),
            source=NAME,
        )
        layers = self._there()
        if not layers and not self._glows:
            self._post_clear(clear)
        elif radiance is not None and not isinstance(background.cube, GpuTexture):
            self._start(layers, clear)

    def _last_wanted(self, kind: type[D]) -> D | None:
        """The last message, if anybody wants it: else nobody updates it."""
        return None if self.link.wanted(kind) is None else self.link.last(kind)

    def _forget(self) -> None:
        self.link.cancel_job(JOB)
        self._made_from = ()

    def _post_clear(self, clear: SkyLightChanged) -> None:
        """Without layers the sum is the clear sky."""
        if _same(_parts(clear), self._made_from):
            return
        self.counters.skip("sum: no layers")
        self._forget()
        self._made_from = _parts(clear)
        self._post(clear)

    def _start(self, layers: Layers, clear: SkyLightChanged) -> None:
        """Sum in the background, unless the change is invisible."""
        assert self._wanted is not None
        layers, scene = self._unless_unseen(layers), self.link.last(SceneOpened)
        self._height_m = self._seen_from(layers)
        size = self._wanted.size or CUBE_SIZE
        glows = tuple(glow.glow_rgb for glow in self._glows.values() if glow.glow_rgb is not None)
        made_from = (*_parts(clear), *layers.values(), scene, self._height_m, size, *glows)
        if _same(made_from, self._made_from):
            self.counters.skip("sum: no change to be seen")
            return
        self._made_from, self._layers = made_from, layers
        middle_m, half_width_m = _square(scene)
        eye_m = (middle_m[0], self._height_m, middle_m[2])
        self.link.start_job(
            JOB, sum_up, layers, glows, clear, eye_m, middle_m, half_width_m, size, role="awaited"
        )

    def _unless_unseen(self, layers: Layers) -> Layers:
        """The layers, or the earlier ones that look the same."""
        before, height_m = self._layers, self._height_m
        return {
            layer: before[layer]
            if layer in before and layer.looks_same(now, before[layer], height_m)
            else now
            for layer, now in layers.items()
        }

    def _seen_from(self, layers: Layers) -> float:
        """The eye's height, at least 0, or the earlier one where the difference is invisible."""
        needs, camera = self.link.last(SceneNeeds), self.link.last(MoveCamera)
        height_m = needs.eye_height_m if needs is not None else camera.eye_m[1] if camera else 0.0
        height_m = max(height_m, 0.0)
        levels_m = [level for layer, now in layers.items() for level in layer.levels_m(now)]
        if not levels_m:
            return 0.0
        distance_m = max(min(abs(level - height_m) for level in levels_m), _LEAST_DISTANCE_M)
        risen_m = abs(height_m - self._height_m)
        return self._height_m if risen_m < _UNSEEN_SHARE * distance_m else height_m

    def _post(self, message: SkyLightChanged) -> None:
        self.link.post(message)
        self.counters.did("sum")


def sum_up(
    layers: Layers,
    glows: tuple[Array, ...],
    clear: SkyLightChanged,
    eye_m: Vector,
    middle_m: Vector,
    half_width_m: float,
    size: int,
) -> SkyLightChanged:
    """The background job: glows lie behind all layers."""
    view, light = Viewpoint(eye_m, middle_m, half_width_m), clear
    for glow in glows:
        light = with_glow(light, glow, NAME)
    for layer, message in layers.items():
        light = layer.light_under(message, light, view, size, NAME)
    polarised = _behind(layers, clear, view) if layers else clear.polarisation
    return msgspec.structs.replace(light, polarisation=polarised)


def _behind(
    layers: Layers, clear: SkyLightChanged, view: Viewpoint
) -> SkyPolarisationChanged | None:
    """The clear sky's polarisation times the transmittance of the layers, if it is known.

    The transmittance is the radiance of an even sky that outshines the layers' own light.
    """
    polarised, radiance = clear.polarisation, clear.radiance
    if polarised is None or polarised.cube is None or radiance is None:
        return polarised
    size = polarised.cube.shape[2]
    even = Array(np.ones((6, size, size, 3), np.float16))
    light = msgspec.structs.replace(
        clear,
        background=msgspec.structs.replace(
            clear.background, cube=even, radiance_scale=_OUTSHINES, view=None
        ),
        radiance=msgspec.structs.replace(radiance, cube=even, radiance_scale=_OUTSHINES),
    )
    for layer, message in layers.items():
        light = layer.light_under(message, light, view, size, NAME)
    seen = light.background
    assert isinstance(seen.cube, Array)
    share = decode_float16(seen.cube.values, seen.radiance_scale / _OUTSHINES)
    cube = decode_float16(polarised.cube.values, polarised.radiance_scale)
    return polarisation_message(cube * share, NAME)


def _square(scene: SceneOpened | None) -> tuple[Vector, float]:
    """Middle, on the ground, and half the width (m) of the square that the scene stands in."""
    if scene is None:
        return (0.0, 0.0, 0.0), 0.0
    x, _, z = (0.5 * (low + high) for low, high in zip(scene.lower_m, scene.upper_m, strict=True))
    ground_m = scene.lower_m[1] if scene.ground is None else scene.ground.height_m
    half_width_m = 0.5 * max(scene.upper_m[i] - scene.lower_m[i] for i in (0, 2))
    return (x, max(ground_m, 0.0), z), half_width_m


def _parts(light: SkyLightChanged) -> tuple[Any, ...]:
    return light.background, light.key_light, light.ambient, light.radiance, light.polarisation


def _same(made_from: tuple[Any, ...], before: tuple[Any, ...]) -> bool:
    """Whether all parts are the same objects, or equal numbers."""
    return len(made_from) == len(before) and all(
        new is old or (isinstance(new, float | int) and new == old)
        for new, old in zip(made_from, before, strict=True)
    )
