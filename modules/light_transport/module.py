"""Light transport on the bus: a light map that grows finer while nothing changes.

It listens to the opened scene and its light. It works only while a module demands
`SurfaceLightChanged`. A scene is laid out and baked in background jobs, in rounds of rays that
double; each hour is a job beside the rounds, by the present rays. A scene that takes long to lay
out is lit by probes until the first rays of its map are traced.
"""

from typing import TYPE_CHECKING, NamedTuple

from light_transport.messages import CARD_JOB, NAME, BakeGrown, no_light_map
from light_transport.settings import LightTransportSettings
from light_transport.tolerance import TransportQuality, TransportSizes, looks_like, quality_for
from vrut_lite import __version__
from vrut_lite.errors import UserError
from vrut_lite.kernel.messages import Demand, JobResult
from vrut_lite.kernel.module import Link, Manifest, Module, handles
from vrut_lite.lazy import lazy
from vrut_lite.messages.gpu_job import GpuJob
from vrut_lite.messages.light_map import BESIDE_POINTS, SLOT, LightMapLaid, SurfaceLightChanged
from vrut_lite.messages.renderer import RendererTried
from vrut_lite.messages.scene import SceneOpened
from vrut_lite.messages.sky import SkyRadianceChanged
from vrut_lite.messages.sky_light import SkyLightChanged
from vrut_lite.messages.tolerance import SetTolerance, tolerance_of
from vrut_lite.messages.view_light import StillAsked, ViewLightChanged
from vrut_lite.sky.device_choice import DeviceChoice, choose

if TYPE_CHECKING:
    from light_transport.jobs import (
        Laid,
        LaidProbes,
        PreparedSurfaces,
        TransportRound,
        Unwritten,
    )

# Imported at the first job: rays take a tenth of a second to import.
_jobs = lazy("light_transport.jobs")
PROBES, LAYOUT, RAYS, HOUR, VIEW = "probes", "layout", "rays", "hour", "view"
# Work of an hour on a graphics card, in the renderer's trial pixels a ray, measured on llvmpipe.
_TRIALS_A_RAY = 0.2
# Charts of more triangles take longer than half a second.
_MANY_TRIANGLES = 30_000
# Edge of the sky's cube to ask for: its texels are finer than the nodes of the table.
SKY_SIZE = 64
# Number of points of a finished still that get rays, as a share of the map's texels.
_POINTS_A_TEXEL = 2.0 / 3.0


class _Asked(NamedTuple):
    """The sources of the present light, and of light under way."""

    hour: SkyLightChanged
    layout_key: str
    rays: int
    on_card: bool


class LightTransport(Module):
    """Posts `LightMapLaid` once a scene and `SurfaceLightChanged` after each round and hour.

    A scene of many triangles has two layouts: one of probes alone, and its map's, which is posted
    with the map's first light. A demand that names a number of rays makes light wait for so many.

    Switched off, it posts a layout of no scene, and the frame is lit by the open sky.

    With a demand for it, it lights each view of a finished still by `ViewLightChanged`.

    The counters count "probes", "layout", "round", "hour" and "view", and skips: unwanted or
    switched off, an hour that looks like the one before, one that a newer overtook, a view of a
    scene with lamps.
    """

    # Its settings are no options of commands: `--on` would say nothing.
    manifest = Manifest(
        name=NAME,
        title="Light between surfaces",
        version=__version__,
        provides=(SLOT,),
        requires=("sky",),
        auxiliary=True,
    )
    speaks = (BakeGrown,)
    settings_type = LightTransportSettings
    settings: LightTransportSettings

    def __init__(self, link: Link, settings: LightTransportSettings):
        super().__init__(link, settings)
        self._works = False
        # The inputs of the layout, and its result.
        self._sizes_laid: TransportSizes | None = None
        self._probes: LaidProbes | None = None
        self._laid: Laid | None = None
        self._round: TransportRound | None = None
        # Whether all rays are traced, until a demand wants more.
        self._is_baked = False
        # The layout that was posted last.
        self._posted: LightMapLaid | None = None
        self._asked: _Asked | None = None
        self._hours_under_way = 0
        self._card_failed = False
        # Where the light of the last hour was computed; for the profiler.
        self.devices: dict[str, DeviceChoice] = {}

    # --- whether there is anything to do --------------------------------------------------

    @handles(Demand)
    def on_demand(self, message: Demand) -> None:
        """Begin with the first demand for light on surfaces, and end with the last."""
        if message.message == SurfaceLightChanged.__name__:
            self._consider()
            self._choose_again()
            if self._is_baked:
                self._next_round()
        elif message.message == GpuJob.__name__:
            self._choose_again()
        elif message.message == ViewLightChanged.__name__:
            self._light_view()

    @handles(StillAsked)
    def on_still(self, message: StillAsked) -> None:
        """Another view."""
        self._light_view()

    def settings_changed(self, name: str) -> None:
        """Switch on or off, or begin again in other sizes."""
        if name == "on":
            self._consider()
        elif name == "device":
            self._card_failed = False
            self._choose_again()
        else:
            self._sizes_changed()

    @handles(SetTolerance)
    def on_tolerance(self, message: SetTolerance) -> None:
        """Other sizes, unless they are named."""
        self._sizes_changed()

    @handles(RendererTried)
    def on_renderer(self, message: RendererTried) -> None:
        """Another renderer may compute the light, or may not."""
        self._choose_again()

    @handles(SceneOpened)
    def on_scene(self, message: SceneOpened) -> None:
        """Another scene."""
        self._begin()

    def _consider(self) -> None:
        works = self.settings.on and self.link.wanted(SurfaceLightChanged) is not None
        if works == self._works:
            return
        self._works = works
        self.link.demand(SkyRadianceChanged, SKY_SIZE if works else 0)
        self.link.demand(SkyLightChanged, None if works else 0)
        if not works and self._posted is not None:
            self.link.post(no_light_map())
        self._begin()

    def _sizes_changed(self) -> None:
        """Begin again where the layout is another, else trace the missing rays."""
        if self._laid is None or self._sizes != self._sizes_laid:
            self._begin()
        else:
            self._next_round()

    @property
    def _sizes(self) -> TransportSizes:
        quality, texel_m = self._quality, self.settings.texel_m
        texels = quality.texels if texel_m is None else 0
        return TransportSizes(texel_m, texels, quality.patch_texels, quality.bounces_left)

    @property
    def _quality(self) -> TransportQuality:
        return quality_for(tolerance_of(self.link), self.settings.quality)

    @property
    def _named_rays(self) -> int:
        """Rays that a demand names, 0 if none does."""
        wanted = self.link.wanted(SurfaceLightChanged)
        return 0 if wanted is None else wanted.size or 0

    @property
    def _rays(self) -> int:
        """Rays of a texel in a finished bake.

        Half as many are enough beside the points of a still: these take bounces from patches of
        many texels, and only reflections and thin things show texels. Lamps light the map alone.
        """
        scene, rays = self.link.last(SceneOpened), self._quality.rays
        has_points = scene is not None and scene.lamps is None
        return rays // 2 if has_points and self._named_rays == BESIDE_POINTS else rays

    @property
    def _least_rays(self) -> int:
        """Minimum rays of light that is shown."""
        return min(self._named_rays, self._rays)

    # --- the bake -------------------------------------------------------------------------

    def _begin(self) -> None:
        """Drop the present layout and all jobs, and lay out the scene."""
        for job in (PROBES, LAYOUT, RAYS, HOUR, VIEW):
            self.link.cancel_job(job)
        self._sizes_laid = self._probes = self._laid = self._round = self._posted = None
        self._asked = None
        self._is_baked = False
        self._hours_under_way = 0
        scene = self.link.last(SceneOpened)
        if not self._works:
            self.counters.skip("light map: unwanted or switched off")
        elif scene is not None and not scene.triangles and scene.ground is None:
            self.counters.skip("light map: a scene without surfaces")
        elif scene is not None:
            self._sizes_laid = self._sizes
            if scene.triangles > _MANY_TRIANGLES and not self._least_rays:
                self.link.start_job(PROBES, _jobs.laid_probes, scene, role="awaited")
            else:
                self._lay_out(scene, None)

    @handles(JobResult)
    def job_done(self, result: JobResult) -> None:
        """A layout, a round or an hour; the kernel posts a Fault for a failed job.

        Raises:
            UserError: a card could not compute an hour's light; from now on the processor does.
        """
        if result.job == HOUR:
            self._hours_under_way -= 1
        if result.job == CARD_JOB:
            self._card_failed = True
            self._choose_again()
            raise UserError(f"{result.error}: the processor computes the light from now on")
        if result.error:
            if result.job == HOUR:
                self._asked = None
        elif result.job == PROBES:
            self._take_probes(result.value)
        elif result.job == LAYOUT:
            self._take_layout(result.value)
        elif result.job == RAYS:
            self._take_round(result.value)
        elif result.job == VIEW:
            if result.value is not None:
                self.link.post(result.value)
                self.counters.did("view")
        else:
            self._take_hour(result.value)

    def _take_probes(self, probes: "LaidProbes") -> None:
        scene = self.link.last(SceneOpened)
        if probes.round is None:
            self.counters.skip("probes: all lie inside bodies")
        else:
            self._probes, self._round = probes, probes.round
            self._post_layout(probes.message)
            self.counters.did("probes")
            self._light()
        if scene is not None:
            self._lay_out(scene, probes.prepared)

    def _lay_out(self, scene: SceneOpened, prepared: "Unwritten[PreparedSurfaces] | None") -> None:
        rays, of_still = self._rays, self._least_rays > 0
        asked = scene, self._sizes_laid, rays, prepared, of_still
        self.link.start_job(LAYOUT, _jobs.laid_out, *asked, role="awaited")

    def _take_layout(self, laid: "Laid") -> None:
        self._laid = laid
        # It holds the whole scene.
        self._probes = None
        self.counters.did("layout")
        if laid.message.mirrors is None:
            self.counters.skip("mirrors: nothing in the scene is glossy")
        self._take_round(laid.round)

    def _take_hour(self, light: SurfaceLightChanged) -> None:
        # The light of probes, or of the open sky, stands until that of the map is there: a frame
        # takes as long to learn of a layout as of its light.
        if self._laid is not None and light.layout_key == self._laid.message.layout_key:
            self._post_layout(self._laid.message)
        self.link.post(light)
        self.counters.did("hour")
        self._light_view()

    def _post_layout(self, laid: LightMapLaid) -> None:
        if laid is not self._posted:
            self._posted = laid
            self.link.post(laid)

    def _next_round(self) -> None:
        """Trace as many rays as there are, or all that light waits for, until there are enough."""
        if self._laid is None or self._round is None:
            return
        done = self._round
        count = max(done.rays, self._least_rays - done.rays)
        count = min(count, self._rays - done.rays)
        self._is_baked = count <= 0
        if not self._is_baked:
            wanted, of_still = self._rays, self._least_rays > 0
            asked = done.transport, count, wanted, of_still
            self.link.start_job(RAYS, _jobs.with_rays, *asked, role="refines")

    def _take_round(self, done: "TransportRound") -> None:
        assert self._laid is not None
        self._round = done
        self.counters.did("round")
        self.link.post(
            BakeGrown(
                layout_key=self._laid.message.layout_key,
                texels=done.texels,
                rays=done.rays,
                rays_wanted=self._rays,
                table_bytes=done.table_bytes,
            )
        )
        self._light()
        self._next_round()

    # --- the hour -------------------------------------------------------------------------

    @handles(SkyLightChanged)
    def on_light(self, message: SkyLightChanged) -> None:
        """Light the scene by the present rays."""
        if self._works:
            self._light()

    def _light(self) -> None:
        hour, laid = self._present_hour(), self._laid or self._probes
        if laid is None or self._round is None or hour is None:
            return
        if self._round.rays < self._least_rays:
            self.counters.skip("hour: more rays are awaited")
            return
        layout_key, of_still = laid.message.layout_key, self._least_rays > 0
        chosen = self.devices["light"] = self._chosen(self._round)
        asked = layout_key, self._round.rays, chosen.on_card
        if self._asked is not None and self._asked[1:] == asked:
            quality = self._quality
            if looks_like(hour, self._asked.hour, quality.hour_change, quality.sun_rad):
                self.counters.skip("hour: it looks like the one before")
                return
        self._asked = _Asked(hour, *asked)
        if self._hours_under_way == 2:
            self.counters.skip("hour: a newer one overtook it")
        else:
            self._hours_under_way += 1
        inputs = self._round.transport, layout_key, hour
        if chosen.on_card:
            self.link.start_job(HOUR, _jobs.lit_by_card, *inputs, role="awaited")
        else:
            self.link.start_job(HOUR, _jobs.lit, *inputs, of_still, role="awaited")

    def _choose_again(self) -> None:
        """Light the scene again where another device should."""
        asked, done = self._asked, self._round
        if asked is None or done is None or self._chosen(done).on_card == asked.on_card:
            return
        self._light()

    def _chosen(self, done: "TransportRound") -> DeviceChoice:
        """The device of an hour's light."""
        trials = _TRIALS_A_RAY * done.texels * done.rays
        chosen = choose(self.settings.device, self.link.last(RendererTried), trials)
        if not chosen.on_card:
            return chosen
        why = ""
        if self._least_rays:
            why = "a still's light is kept on disk"
        elif self._laid is None or done.rays < self._rays:
            why = "the bake goes on"
        elif self.link.wanted(GpuJob) is None:
            why = "nobody draws with OpenGL"
        elif self._card_failed:
            why = "the card failed"
        return DeviceChoice(False, why) if why else chosen

    def _light_view(self) -> None:
        """Light the points that a finished still shows, by the last rays, if somebody wants it."""
        self.link.cancel_job(VIEW)
        asked, scene = self.link.last(StillAsked), self.link.last(SceneOpened)
        if asked is None or self.link.wanted(ViewLightChanged) is None:
            return
        if self._laid is None or self._round is None or self._asked is None or scene is None:
            return
        if self._hours_under_way or self._asked.rays < self._rays:
            return
        if scene.lamps is not None:
            key, rays = self._laid.message.layout_key, self._asked.rays
            self.link.post(ViewLightChanged.without_points(asked, key, rays, NAME))
            self.counters.skip("view: lamps light the map by themselves")
            return
        key, points = self._laid.message.layout_key, int(_POINTS_A_TEXEL * self._quality.texels)
        transport, hour = self._round.transport, self._asked.hour
        sizes = points, self._quality.rays
        self.link.start_job(
            VIEW, _jobs.view_lit, transport, key, hour, asked, *sizes, role="refines"
        )

    def _present_hour(self) -> SkyLightChanged | None:
        light = self.link.last(SkyLightChanged)
        return None if light is None or light.radiance is None else light
