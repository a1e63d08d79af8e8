"""`SkyModule`: the common part of all skies, between the bus and the light of an hour.

It handles the inputs of light, calls the sky for the demanded results, and posts those that have
changed: background, key light, ambient light, radiance on the ground, polarisation and air, in this
order. Sizes follow demand, else the tolerance; invisible moves of sun and eye cost nothing; when
the slot returns, all is posted again; a long computation runs as a background job, and the previous
sky stays until it ends. The setting `cube_device` says where cube map and air are computed, "auto"
by the renderer's trial (`device_choice`). The CPU computes them where a demand names the encoding,
for its consumer reads the numbers, where the host runs no GPU jobs, after one has failed, and where
the sky requires it.

The counters count messages by type name, posted ("BackgroundChanged") or skipped
("BackgroundChanged unwanted", "BackgroundChanged unchanged").
"""

from collections.abc import Callable
from typing import Any, ClassVar

import msgspec
import numpy as np

from vrut_lite.array import Array
from vrut_lite.atmosphere.ground_reflectance import GroundReflectance
from vrut_lite.atmosphere.refraction import dip_rad, eye_aloft_m, seen_from_aloft
from vrut_lite.errors import UserError
from vrut_lite.kernel.messages import ClockMoved, Demand, Derived, JobResult, SlotChanged
from vrut_lite.kernel.module import Link, Module, handles
from vrut_lite.messages.air import AirChanged
from vrut_lite.messages.camera import MoveCamera
from vrut_lite.messages.gpu_job import GpuJob, TexelFormat
from vrut_lite.messages.gpu_texture import GpuTexture
from vrut_lite.messages.ground import SetGround, ground_of
from vrut_lite.messages.haze import SetHaze, haze_of
from vrut_lite.messages.night import NO_ECLIPSE, MoonLight, NightLightChanged
from vrut_lite.messages.night import SLOT as NIGHT
from vrut_lite.messages.place import SetPlace
from vrut_lite.messages.renderer import RendererTried
from vrut_lite.messages.scene import SceneNeeds, SceneOpened
from vrut_lite.messages.sky import (
    AmbientChanged,
    BackgroundChanged,
    LookAlong,
    LookAround,
    SkyPolarisationChanged,
    SkyRadianceChanged,
    SkySpectraSeen,
    SpectrumSeen,
)
from vrut_lite.messages.sun import KeyLightChanged, SunMoved
from vrut_lite.messages.tolerance import SetTolerance, tolerance_of
from vrut_lite.numeric_types import Vector
from vrut_lite.sky.air_reach import rung_m
from vrut_lite.sky.device_choice import DeviceChoice, DeviceSetting, choose, choose_for_cube
from vrut_lite.sky.eye import eye_height_m
from vrut_lite.sky.sky_at_night import SkyAtNight, key_body, night_share, sun_share
from vrut_lite.sky.sky_jobs import SOLVE, AwaitedTextures, Preparation
from vrut_lite.sky.sky_of_hour import (
    AIR_JOB,
    CUBE_JOB,
    Quality,
    Sky,
    SkyInputs,
    Work,
    polarisation_message,
)

SPECTRUM, SPECTRA = "spectrum", "spectra"
Kinds = tuple[type[Derived], ...]
PRODUCTS: Kinds = (
    BackgroundChanged,
    KeyLightChanged,
    AmbientChanged,
    SkyRadianceChanged,
    SkyPolarisationChanged,
    AirChanged,
)
# Edge of the cube that lights the scene, used when the consumer gives no size.
LIGHT_SIZE = 64
# Edge of the cubes of Q and U, used when the consumer gives no size: they are smooth.
_POLARISATION_SIZE = 32
_USUAL_SIZES = {SkyRadianceChanged: LIGHT_SIZE, SkyPolarisationChanged: _POLARISATION_SIZE}
# Change of moonlight, as a share, that keeps the moon where it was: that of the phase in an hour.
_UNSEEN_MOONLIGHT = 0.005
# Messages that depend on the eye's place.
SEEN: Kinds = (BackgroundChanged, SkyPolarisationChanged, AirChanged)


class SkyModule(Module):
    """Base of the modules that provide the slot "sky": override `light` and other methods."""

    # Whether a spectrum takes so long that it needs a background job.
    spectrum_is_slow: ClassVar[bool] = False
    # Whether the light follows `SunMoved`: a photograph's does not, nor can it keep the contract.
    follows_sun: ClassVar[bool] = True

    def __init__(self, link: Link, settings: Any):
        super().__init__(link, settings)
        # Sources of the last posted sun, of a sky that provides the sun too.
        self._sun_of: tuple[object, ...] | None = None
        # The sources of each message that was posted last.
        self._posted: dict[type[Derived], tuple[object, ...]] = {}
        # The latest sky, and the hour that it shows.
        self._sky: Sky | None = None
        self._hour: SkyInputs | None = None
        # The moon that lights the sky, and its hour.
        self._moon: tuple[MoonLight, SkyInputs] | None = None
        self._has_night = False
        self._ground = self.ground
        # Height of the eye (m) and reach of its air (m).
        self._view = (0.0, 0.0)
        self._preparation = Preparation(link, self.counters)
        self._refused: tuple[object, ...] = ()
        self._textures = AwaitedTextures()
        self._gpu_failed = False
        # Where sky and air were computed last; for the profiler.
        self.devices: dict[str, DeviceChoice] = {}

    # --- the sky -------------------------------------------------------------------------

    def quality(self, tolerance: float) -> Quality:
        """Sizes and thresholds for a tolerance of radiance, a share above 0."""
        raise NotImplementedError

    def prepare(self, ground_altitude_m: float, quality: Any) -> Work | None:
        """The computation that the settings need before light can be made, or None.

        It runs as a background job, once for equal work.

        Raises:
            ValueError: the settings describe no atmosphere above that ground.
        """
        return None

    def light(self, hour: SkyInputs, quality: Any, prepared: Any) -> Sky:
        """The sky of an hour, by `self.settings` and the last preparation (`Prepared`).

        Called often, also without a change: the sky's methods must do the computing.
        """
        raise NotImplementedError

    @property
    def haze(self) -> SetHaze:
        """The place's haze, for a sky whose settings do not override it."""
        return haze_of(self.link)

    @property
    def ground(self) -> GroundReflectance:
        """The ground around the scene, for a sky whose settings do not override it."""
        return ground_of(self.link)

    def ground_unless(self, albedo: float | None) -> GroundReflectance:
        """The same, or a grey ground of an albedo of the sky's own."""
        return self.ground if albedo is None else GroundReflectance.grey(albedo)

    # --- changes -------------------------------------------------------------------------

    @handles(SunMoved)
    @handles(SetPlace)
    @handles(Demand)
    @handles(SetTolerance)
    @handles(SetHaze)
    @handles(SetGround)
    @handles(NightLightChanged)
    @handles(RendererTried)
    def light_changed(
        self,
        message: SunMoved
        | SetPlace
        | Demand
        | SetTolerance
        | SetHaze
        | SetGround
        | NightLightChanged
        | RendererTried,
    ) -> None:
        """Post the demanded messages that have changed."""
        if isinstance(message, SunMoved) and self._night_will_follow():
            self.counters.skip("sky: the night of this hour follows")
            return
        self._update()

    @handles(SceneOpened)
    def scene_opened(self, _message: SceneOpened) -> None:
        """The ground at another scene's border may be another; animations leave it."""
        if self.ground != self._ground:
            self._update()

    @handles(MoveCamera)
    @handles(SceneNeeds)
    def view_changed(self, _message: MoveCamera | SceneNeeds) -> None:
        """The eye's height or the reach of the scene changed."""
        if self._present_view() != self._view:
            self._update(SEEN)

    @handles(SlotChanged)
    def slot_changed(self, message: SlotChanged) -> None:
        """Another sky may have been shown in between: post everything again."""
        if message.name == NIGHT:
            self._has_night = message.holder != ""
            self._update()
        elif message.name == "sky":
            self._posted.clear()
            self._update()
        elif message.name == "sun":
            self._sun_of = None
            self.move_sun()

    def move_sun(self) -> None:
        """Post the sun's direction by `_post_sun`, in a sky that provides the slot "sun" too."""

    def _post_sun(self, made_from: tuple[object, ...], made: Callable[[], SunMoved]) -> None:
        """Post the sun, made if it is from other sources than the last one."""
        if made_from == self._sun_of:
            self.counters.skip("SunMoved unchanged")
            return
        self._post(made())
        self._sun_of = made_from

    def settings_changed(self, name: str) -> None:
        """Post the sky of the new settings."""
        if name == "cube_device":
            self._gpu_failed = False
        self._update()

    @handles(LookAlong)
    def looked_along(self, message: LookAlong) -> None:
        """Someone asks for the spectrum of a direction."""
        if not self.link.holds("sky") or (sky := self._present_sky()) is None:
            return
        asked = sky, message.direction, self.manifest.name
        if self.spectrum_is_slow:
            self.link.start_job(SPECTRUM, _spectrum_seen, *asked)
        else:
            self._post(_spectrum_seen(*asked))

    @handles(LookAround)
    def looked_around(self, message: LookAround) -> None:
        """Someone asks for the spectra of all directions."""
        if not self.link.holds("sky") or (sky := self._present_sky()) is None:
            return
        asked = sky, message.size, message.wavelength_nm, self.manifest.name
        if self.spectrum_is_slow:
            self.link.start_job(SPECTRA, _spectra_seen, *asked)
        else:
            self._post(_spectra_seen(*asked))

    @handles(JobResult)
    def job_done(self, result: JobResult) -> None:
        """An atmosphere is solved, a spectrum found, or a texture made.

        Raises:
            UserError: the GPU could not make cube map or air; from now on the CPU does.
        """
        if result.job == SOLVE:
            if self._preparation.take(result):
                self._update()
        elif result.job in (SPECTRUM, SPECTRA):
            if not result.error:
                self._post(result.value)
        elif result.job in (CUBE_JOB, AIR_JOB):
            self._texture_made(result)

    def _texture_made(self, result: JobResult) -> None:
        if result.error:
            self._gpu_failed = True
            # Also where it is not wanted now, since a later demand may use it.
            for kind in SEEN:
                self._posted.pop(kind, None)
            self._update()
            raise UserError(
                f"the GPU could not make the sky ({result.error}): set cube_device to cpu"
            )
        message = self._textures.next(result.job, GpuTexture.of(result.value))
        if message is None:
            self.counters.skip("GpuJob outdated")
        else:
            self._post(message)

    # --- posting -------------------------------------------------------------------------

    def _update(self, kinds: Kinds = PRODUCTS) -> None:
        if self.link.last(SunMoved) is None or not self.link.holds("sky"):
            self.counters.skip("sky: no sun, or another sky is shown")
            return
        self._view, self._ground = self._present_view(), self.ground
        wanted = {kind: demand for kind in kinds if (demand := self._demand(kind)) is not None}
        if not wanted or (sky := self._present_sky()) is None:
            return
        assert self._hour is not None
        for kind, demand in wanted.items():
            self._post_if_new(kind, sky, self._hour, demand)

    @property
    def _quality(self) -> Quality:
        return self.quality(tolerance_of(self.link))

    def _present_sky(self) -> Sky | None:
        """The sky of the present hour, or of one that looks like it; None while it is prepared."""
        sun, place, quality = self.link.last(SunMoved), self.link.last(SetPlace), self._quality
        if sun is None:
            return None
        altitude_m = 0.0 if place is None else place.altitude_m
        self._prepare(altitude_m, quality)
        if not self._preparation.ready:
            return None
        night = self._present_night(sun)
        hour = now = SkyInputs(sun, altitude_m, self._view[0], night_apart=night is not None)
        if self._sky is not None and self._hour is not None:
            hour = self._hour.unless_unseen(now, self._sky.unseen(self._hour, quality))
            if night is not None and sun_share(sun) == sun_share(self._hour.sun) == 0.0:
                hour = msgspec.structs.replace(hour, sun=self._hour.sun)
            if hour != now:
                self.counters.skip("sun or eye moved unseen")
        self._hour = hour
        sky = self.light(hour, quality, self._preparation.latest)
        if night is not None:
            sky = self._at_night(sky, night, hour, quality)
        # An equal earlier sky has its results cached.
        if self._sky is None or sky != self._sky:
            self._sky = sky
        return self._sky

    def _night_will_follow(self) -> bool:
        """Whether the known night is of another hour: a sum with it would be made twice."""
        night, clock = self.link.last(NightLightChanged), self.link.last(ClockMoved)
        if not self._has_night or night is None or clock is None:
            return False
        tells = night.moon is not None or night.glow_rgb is not None
        return tells and night.instant != clock.instant

    def _present_night(self, sun: SunMoved) -> NightLightChanged | None:
        """The night's light from another module; None by day."""
        night = self.link.last(NightLightChanged) if self._has_night else None
        if night is None or (night.moon is None and night.glow_rgb is None):
            return None
        if night_share(sun) <= 0.0 and night.sun_left_rgb == NO_ECLIPSE:
            self.counters.skip("night: outshone by the sun")
            return None
        return night

    def _at_night(
        self, by_sun: Sky, night: NightLightChanged, hour: SkyInputs, quality: Any
    ) -> Sky:
        """The sky of the hour with the night's light in it."""
        moon, by_moon, share = night.moon, None, night_share(hour.sun)
        if moon is not None and share > 0.0:
            of_moon = now = msgspec.structs.replace(hour, sun=moon.place, body="moon")
            # In an eclipse its light changes faster than its place.
            if self._moon is not None and _as_bright(self._moon[0], moon):
                before, then = self._moon
                unseen = self.light(then, quality, self._preparation.latest).unseen(then, quality)
                of_moon = then.unless_unseen(now, unseen)
                if of_moon.sun is then.sun:
                    moon = before
            self._moon = moon, of_moon
            by_moon = self.light(of_moon, quality, self._preparation.latest)
        return SkyAtNight(
            by_sun=by_sun,
            by_moon=by_moon,
            moon=moon if share > 0.0 else None,
            glow=night.glow_rgb,
            share=share,
            key=key_body(hour.sun, moon, hour.eye_height_m),
            sun_share=sun_share(hour.sun),
            sun_left_rgb=night.sun_left_rgb,
            horizon_rad=-dip_rad(eye_aloft_m(hour.eye_height_m)),
            lamps=night.lamps_rgb,
        )

    def _demand(self, kind: type[Derived]) -> Demand | None:
        demand = self.link.wanted(kind)
        if demand is None:
            self.counters.skip(f"{kind.__name__} unwanted")
        elif kind is AirChanged and not self._view[1]:
            self.counters.skip("AirChanged without things in it")
            return None
        return demand

    def _present_view(self) -> tuple[float, float]:
        """The eye's height and the air's reach; the earlier reach where it suffices."""
        needs = self.link.last(SceneNeeds)
        reach_m = 0.0 if needs is None else rung_m(needs.air_reach_m, self._view[1])
        return eye_height_m(self.link), reach_m

    def _prepare(self, ground_altitude_m: float, quality: Quality) -> None:
        """Start the sky's preparation.

        Raises:
            UserError: the settings describe no atmosphere; posted once for the same settings.
        """
        asked = self.settings, self.haze, self.ground, ground_altitude_m, quality
        try:
            work = self.prepare(ground_altitude_m, quality)
        except ValueError as error:
            self._preparation.drop()
            if asked != self._refused:
                self._refused = asked
                name = self.manifest.name
                raise UserError(f"{name} has no such atmosphere: {error}") from error
        else:
            self._refused = ()
            self._preparation.ask(work)

    def _post_if_new(self, kind: type[Derived], sky: Sky, hour: SkyInputs, demand: Demand) -> None:
        """Post a message whose sources differ from the last one's."""
        size = demand.size or _USUAL_SIZES.get(kind) or self._quality.cube_size
        name, direction, eye_m = self.manifest.name, hour.sun.direction, hour.eye_height_m
        made_from: tuple[object, ...] = sky.on_scene(), direction
        chosen = self._chosen(kind, sky, demand)
        if kind is BackgroundChanged:
            made_from = sky, size, chosen.on_card, chosen.edge
        elif kind is SkyRadianceChanged:
            made_from = *made_from, size
        elif kind is SkyPolarisationChanged:
            made_from = sky, size
        elif kind is AirChanged:
            made_from = sky, eye_m, self._view[1], chosen.on_card
        if self._posted.get(kind) == made_from:
            self.counters.skip(f"{kind.__name__} unchanged")
            return
        if kind is BackgroundChanged:
            self._post(self._background(sky, size, demand.size, chosen))
        elif kind is AirChanged:
            self._post(self._air(sky, eye_m, self._view[1], chosen))
        elif kind is KeyLightChanged:
            seen = seen_from_aloft(direction, hour.sun.elevation_rad, eye_m)
            self._post(sky.sun().message(seen, name))
        elif kind is SkyRadianceChanged:
            self._post(sky.background_on_ground(size).light_message(name))
        elif kind is SkyPolarisationChanged:
            self._post(polarisation_message(sky.polarisation(size), name))
        else:
            harmonics = Array(np.asarray(sky.ambient(), dtype=np.float32))
            lamps_rgb = sky.lamps_rgb()
            self._post(
                AmbientChanged(irradiance_sh_rgb=harmonics, lamps_rgb=lamps_rgb, source=name)
            )
        self._posted[kind] = made_from

    def _post(self, message: Derived) -> None:
        self.link.post(message)
        self.counters.did(type(message).__name__)

    def _background(
        self, sky: Sky, size: int, demanded: int | None, chosen: DeviceChoice
    ) -> Derived:
        asked = None
        if chosen.on_card:
            # A card that was not tried, as in earlier journals, gets the processor's size.
            format: TexelFormat = "rgba32f" if chosen.edge else "rgba16f"
            asked = sky.gpu_background(demanded or chosen.edge or size, format)
            if asked is None:
                self.counters.skip("GpuJob: an hour for the CPU")
                chosen = DeviceChoice(False, "an hour for the processor")
        self.devices["sky"] = chosen
        job, made = (None, sky.background(size)) if asked is None else asked
        return self._first(CUBE_JOB, job, made.message(self.manifest.name))

    def _air(self, sky: Sky, eye_height_m: float, reach_m: float, chosen: DeviceChoice) -> Derived:
        self.devices["air"] = chosen
        asked = sky.gpu_air(eye_height_m, reach_m) if chosen.on_card else None
        job, volume = (None, sky.air(eye_height_m, reach_m)) if asked is None else asked
        if isinstance(sky, SkyAtNight) and sky.has_dark_body:
            self.counters.skip("air in a second light: dark")
        message = AirChanged(volume=volume, source=self.manifest.name)
        return self._first(AIR_JOB, job, message)

    def _first(
        self, name: str, job: GpuJob | None, message: BackgroundChanged | AirChanged
    ) -> Derived:
        """The message to post now, or the job that makes its texture."""
        if job is not None:
            self.link.await_result(name)
        return self._textures.first(name, job, message)

    def _chosen(self, kind: type[Derived], sky: Sky, demand: Demand) -> DeviceChoice:
        """The device of background or air; all else is the processor's."""
        made_by = {BackgroundChanged: "gpu_background", AirChanged: "gpu_air"}.get(kind)
        if made_by is None or not sky.card_makes(made_by):
            return DeviceChoice(False, "the card has no program for it")
        setting: DeviceSetting = getattr(self.settings, "cube_device", "cpu")
        tried = self.link.last(RendererTried)
        if kind is BackgroundChanged:
            chosen = choose_for_cube(setting, tried, sky.card_cube_trials())
        else:
            chosen = choose(setting, tried, sky.card_air_trials())
        if not chosen.on_card:
            return chosen
        if demand.encoding:
            return DeviceChoice(False, "its numbers are read here")
        if self.link.wanted(GpuJob) is None:
            self.counters.skip("GpuJob: nobody runs GPU jobs")
            return DeviceChoice(False, "nobody runs GPU jobs")
        if self._gpu_failed:
            self.counters.skip("GpuJob: the GPU failed")
            return DeviceChoice(False, "the card failed")
        return chosen


def _as_bright(before: MoonLight, now: MoonLight) -> bool:
    """Whether the difference of two moonlights is invisible."""
    one, other = np.array(before.of_sunlight_rgb), np.array(now.of_sunlight_rgb)
    return bool(np.all(np.abs(other - one) <= _UNSEEN_MOONLIGHT * one))


def _spectrum_seen(sky: Sky, direction: Vector, source: str) -> SpectrumSeen:
    wavelength_nm, radiance = sky.spectrum(direction)
    return SpectrumSeen(
        direction=direction, wavelength_nm=wavelength_nm, radiance=radiance, source=source
    )


def _spectra_seen(
    sky: Sky, size: int, wavelength_nm: tuple[float, ...], source: str
) -> SkySpectraSeen:
    found = sky.spectra(size, wavelength_nm)
    if found is not None:
        return found.message(wavelength_nm, source)
    return SkySpectraSeen(
        wavelength_nm=(),
        cube=None,
        sun_irradiance=(),
        ground_radiance=(),
        ground_albedo=(),
        source=source,
    )
