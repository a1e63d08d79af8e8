"""The module that posts the complete light of the sky, for all consumers."""

from collections.abc import Callable
from typing import Any, NamedTuple, TypeVar

import msgspec
import numpy as np

from vrut_lite import __version__
from vrut_lite.array import Array
from vrut_lite.errors import UserError
from vrut_lite.geometry.encoding import decode_float16
from vrut_lite.kernel.messages import Demand, Derived, Encoding, JobResult, SlotChanged
from vrut_lite.kernel.module import Link, Manifest, Module, handles
from vrut_lite.messages.camera import MoveCamera
from vrut_lite.messages.gpu_job import GpuJob, GpuPass
from vrut_lite.messages.gpu_texture import GpuTexture
from vrut_lite.messages.renderer import RendererTried
from vrut_lite.messages.scene import SceneNeeds, SceneOpened
from vrut_lite.messages.sky import (
    AmbientChanged,
    BackgroundChanged,
    SkyPolarisationChanged,
    SkyRadianceChanged,
)
from vrut_lite.messages.sky_light import LIGHT, SkyGlowAdded, SkyLightChanged
from vrut_lite.messages.sun import KeyLightChanged
from vrut_lite.numeric_types import Vector, vector
from vrut_lite.sky.cube_sum import glow_pass
from vrut_lite.sky.device_choice import CARD_EDGES, CLOUDY_EDGES, DeviceChoice, choose_for_cube
from vrut_lite.sky.shader_text import floats, shader_source
from vrut_lite.sky.sky_glow import with_glow
from vrut_lite.sky.sky_jobs import AwaitedTextures
from vrut_lite.sky.sky_layer import SkyLayer, Viewpoint, sky_layers
from vrut_lite.sky.sky_of_hour import CUBE_JOB, polarisation_message

NAME = "sky_sum"
JOB = "sum"
# Edge of the summed cube map in texels, used when the consumer gives no size.
CUBE_SIZE = 64
# Layers that are seen from a place that has risen by less than this share of their distance look
# the same.
_UNSEEN_SHARE = 0.02
_LEAST_DISTANCE_M = 50.0
# Height (m) up to which an eye sees a glow as the ground does.
_GROUND_EYE_M = 100.0
# Work of a texel of the clear sky's part or of a glow, in trial pixels: timed on llvmpipe.
_GLOW_TRIALS = 0.25
# How much brighter than the small cube of the light a texel of a finer one may be, in half
# precision, to which reflections filter it.
_HEADROOM = 4.0
_GROUP = 8
_DARK: Vector = (0.0, 0.0, 0.0)
# Radiance of an even sky that outshines all layers, to measure how much of it they transmit.
_OUTSHINES = 2.0**24
Layers = dict[SkyLayer, Derived]
D = TypeVar("D", bound=Derived)


class SumOutdated(Derived, frozen=True, kw_only=True):
    """A source of the sum has changed; delivered after all messages of that change."""


class SkySum(Module):
    """Posts `SkyLightChanged` where it is demanded.

    Without layers its parts are the clear sky's own messages, in the same transaction; with a
    layer (`SkyLayer`) or a glow (`SkyGlowAdded`) a background job sums. Where the card has the
    clear sky's cube and a program for each layer, and is fast enough (`device_choice`), it makes
    the background's cube, as seen from the ground; numbers are the job's on either device. The
    counters count "sum" posted, and skips "sum: no layers", "sum: unwanted", "sum: no change to be
    seen", "sum: its cube is on the card" and "GpuJob outdated".
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
        # The card's additions to the clear sky's cube, once its numbers are summed.
        self._on_card: CardSum | None = None
        self._textures = AwaitedTextures()
        self._card_failed = False
        # Where the sum's cube was computed last, by the type's name; for the profiler.
        self.devices: dict[str, DeviceChoice] = {}

    # --- sources -------------------------------------------------------------------------

    @handles(Demand)
    def on_demand(self, message: Demand) -> None:
        """Pass demands for the sum on to the sky and its layers; a card may come or go."""
        if message.message == GpuJob.__name__:
            self.link.post(SumOutdated())
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
    @handles(RendererTried)
    def parts_changed(self, _message: Any) -> None:
        """Sum when all parts of this change were heard: parts of two hours have no sum."""
        self.link.post(SumOutdated())

    @handles(SumOutdated)
    def all_heard(self, _message: SumOutdated) -> None:
        """Sum if a source changed."""
        self._update()

    @handles(JobResult)
    def summed(self, result: JobResult) -> None:
        """Post a sum; the kernel posts a Fault for a failed job.

        Raises:
            UserError: the card could not make its cube; from now on the processor does.
        """
        if result.job == CUBE_JOB:
            self._texture_made(result)
        elif result.error:
            self._made_from = ()
        elif isinstance(result.value, CardSum):
            self._on_card = result.value
            self._ask_card()
        else:
            self._post(result.value)

    def _texture_made(self, result: JobResult) -> None:
        if result.error:
            self._card_failed = True
            self._forget()
            self._want_sky()
            self.link.post(SumOutdated())
            raise UserError(
                f"the card could not add clouds to the sky ({result.error}): the processor does"
            )
        message = self._textures.next(CUBE_JOB, GpuTexture.of(result.value))
        if isinstance(message, SkyLightChanged):
            self._post(message)
        else:
            self.counters.skip("GpuJob outdated")

    # --- summing -------------------------------------------------------------------------

    def _want_sky(self) -> None:
        """Demand the clear sky: as an array where the processor sums, for nothing is read back."""
        wanted, layers = self._wanted, self._there()
        exact = bool(layers or self._glows) and wanted is not None
        encoding: Encoding = "float16" if exact and not self._choice(layers).on_card else ""
        for kind in LIGHT:
            self.link.demand(kind, 0 if wanted is None else wanted.size, encoding)
        self.link.demand(SkyRadianceChanged, None if exact else 0)

    def _choice(self, layers: Layers) -> DeviceChoice:
        """The device that makes the cube of a sum, where the clear sky's is on the card."""
        assert self._wanted is not None
        height_m = self._eye_height_m()
        trials = [layer.card_trials(now, height_m) for layer, now in layers.items()]
        known = [each for each in trials if each is not None]
        if len(known) < len(trials) or (self._glows and height_m > _GROUND_EYE_M):
            return DeviceChoice(False, "the card has no program for it")
        work = sum(known) + _GLOW_TRIALS * (1 + len(self._glows))
        edges = CLOUDY_EDGES if layers else CARD_EDGES
        chosen = choose_for_cube("auto", self.link.last(RendererTried), work, edges)
        if not chosen.on_card:
            return chosen
        if self._wanted.encoding:
            return DeviceChoice(False, "its numbers are read here")
        if self.link.wanted(GpuJob) is None:
            return DeviceChoice(False, "nobody runs GPU jobs")
        if self._card_failed:
            return DeviceChoice(False, "the card failed")
        return chosen

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
            return
        self._want_sky()
        chosen = self._choice(layers)
        has_texture = isinstance(background.cube, GpuTexture)
        if radiance is None or has_texture > chosen.on_card:
            # The clear sky follows as it was demanded.
            return
        if chosen.on_card and not has_texture:
            chosen = DeviceChoice(False, "the clear sky is an array")
        self.devices["sky with clouds"] = chosen
        self._start(layers, clear, chosen.edge)

    def _last_wanted(self, kind: type[D]) -> D | None:
        """The last message, if anybody wants it: else nobody updates it."""
        return None if self.link.wanted(kind) is None else self.link.last(kind)

    def _forget(self) -> None:
        self.link.cancel_job(JOB)
        self._made_from = ()
        self._leave_card()

    def _leave_card(self) -> None:
        """Show no texture that is still to come."""
        self._on_card, self._textures = None, AwaitedTextures()

    def _post_clear(self, clear: SkyLightChanged) -> None:
        """Without layers the sum is the clear sky."""
        self.devices.clear()
        if _same(_parts(clear), self._made_from):
            return
        self.counters.skip("sum: no layers")
        self._forget()
        self._made_from = _parts(clear)
        self._post(clear)

    def _start(self, layers: Layers, clear: SkyLightChanged, card_edge: int) -> None:
        """Sum in the background, unless the change is invisible.

        `card_edge`: of the cube by the card, where it makes one; else 0.
        """
        assert self._wanted is not None
        layers, scene = self._unless_unseen(layers), self.link.last(SceneOpened)
        self._height_m = self._seen_from(layers)
        size = self._wanted.size or card_edge or CUBE_SIZE
        glows = tuple(glow.glow_rgb for glow in self._glows.values() if glow.glow_rgb is not None)
        parts = _parts(clear)[1:] if card_edge else _parts(clear)
        made_from = (*parts, *layers.values(), scene, self._height_m, size, card_edge, *glows)
        if _same(made_from, self._made_from):
            self.counters.skip("sum: no change to be seen")
            # The clear sky's texture may be another.
            self._ask_card()
            return
        self._made_from, self._layers, self._on_card = made_from, layers, None
        if not card_edge:
            self._leave_card()
        middle_m, half_width_m = _square(scene)
        eye_m = (middle_m[0], self._height_m, middle_m[2])
        function = sum_for_card if card_edge else sum_up
        self.link.start_job(
            JOB, function, layers, glows, clear, eye_m, middle_m, half_width_m, size, role="awaited"
        )

    def _ask_card(self) -> None:
        """Have the card add to the clear sky's texture, unless it has or does."""
        background, added = self.link.last(BackgroundChanged), self._on_card
        if background is None or added is None or not isinstance(background.cube, GpuTexture):
            return
        job, light = added.over(background, self.manifest.name)
        if self._textures.awaits(CUBE_JOB, job) or _shows(self.link.last(SkyLightChanged), job):
            self.counters.skip("sum: its cube is on the card")
            return
        self.link.await_result(CUBE_JOB)
        self.link.post(self._textures.first(CUBE_JOB, job, light))

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
        height_m = self._eye_y_m()
        levels_m = [level for layer, now in layers.items() for level in layer.levels_m(now)]
        if not levels_m:
            return 0.0
        distance_m = max(min(abs(level - height_m) for level in levels_m), _LEAST_DISTANCE_M)
        risen_m = abs(height_m - self._height_m)
        return self._height_m if risen_m < _UNSEEN_SHARE * distance_m else height_m

    def _eye_y_m(self) -> float:
        needs, camera = self.link.last(SceneNeeds), self.link.last(MoveCamera)
        height_m = needs.eye_height_m if needs is not None else camera.eye_m[1] if camera else 0.0
        return max(height_m, 0.0)

    def _eye_height_m(self) -> float:
        """The eye's height above the scene's ground."""
        return self._eye_y_m() - _square(self.link.last(SceneOpened))[0][1]

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


class CardSum(NamedTuple):
    """A sum whose cube the card is to make of the clear sky's.

    Attributes:
        light: the sum, its background from the ground and as small as its radiance.
        ground_share: (3,) of the clear sky's light on the ground.
        steps: the programs that add glows and layers to the clear sky.
        size: edge of the cube.
        scale: of its texels, a power of two.
    """

    light: SkyLightChanged
    ground_share: Vector
    steps: tuple[GpuPass, ...]
    size: int
    scale: float

    def over(self, clear: BackgroundChanged, module: str) -> tuple[GpuJob, SkyLightChanged]:
        """The card's job over a clear sky on the card, and the light without its texture."""
        assert isinstance(clear.cube, GpuTexture)
        groups = -(-self.size // _GROUP)
        job = GpuJob(
            module=module,
            job=CUBE_JOB,
            compute_shader=shader_source("clear_sky.comp").replace(
                "CLEAR_FORMAT", clear.cube.format
            ),
            uniforms={
                "ground_share": floats(self.ground_share),
                "clear_scale": clear.radiance_scale / self.scale,
            },
            output="cube",
            size=self.size,
            format="rgba32f",
            groups=(groups, groups, 6),
            then=self.steps,
            scratch=2,
            reads=clear.cube,
        )
        seen = msgspec.structs.replace(self.light.background, radiance_scale=self.scale)
        return job, msgspec.structs.replace(self.light, background=seen)


def sum_for_card(
    layers: Layers,
    glows: tuple[Array, ...],
    clear: SkyLightChanged,
    eye_m: Vector,
    middle_m: Vector,
    half_width_m: float,
    size: int,
) -> CardSum:
    """The background job where the card makes the background's cube: its numbers and programs."""
    radiance = clear.radiance
    assert radiance is not None
    view = Viewpoint(eye_m, middle_m, half_width_m)
    # As bright as the sum may be: known before the programs' scale.
    small = radiance.cube.shape[1]
    below = _seen_from_ground(clear)
    where = below, eye_m, middle_m, half_width_m, small
    summed = sum_up(layers, glows, *where)
    assert summed.radiance is not None
    scale = _HEADROOM * summed.radiance.radiance_scale
    before = np.asarray(radiance.ground_radiance_rgb)
    after = np.asarray(summed.radiance.ground_radiance_rgb)
    share = np.where(before > 0.0, after / np.where(before > 0.0, before, 1.0), 1.0)
    steps: list[GpuPass] = []
    light = below
    for glow in glows:
        steps.append(glow_pass(glow, size, _DARK, 1.0, scale))
        light = with_glow(light, glow, NAME)
    for layer, message in layers.items():
        steps += layer.card_passes(message, light, view, size, scale)
        light = layer.light_under(message, light, view, small, NAME)
    for step in steps:
        for _, array in step.buffers:
            # For the recipe, which the kernel's thread needs.
            _ = array.digest
    return CardSum(summed, vector(share), tuple(steps), size, scale)


def _seen_from_ground(clear: SkyLightChanged) -> SkyLightChanged:
    """The clear light with its radiance on the ground as the background: numbers, no texture."""
    radiance = clear.radiance
    assert radiance is not None
    background = BackgroundChanged(
        cube=radiance.cube,
        radiance_scale=radiance.radiance_scale,
        ground_radiance_rgb=radiance.ground_radiance_rgb,
        source=clear.background.source,
    )
    return msgspec.structs.replace(clear, background=background)


def _shows(light: SkyLightChanged | None, job: GpuJob) -> bool:
    """Whether a light has the cube of a job."""
    cube = None if light is None else light.background.cube
    return isinstance(cube, GpuTexture) and cube.recipe == job.recipe


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
