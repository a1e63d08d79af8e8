"""DynamicSkyLight on the bus: from clock and place to the sun, from the sun to sky and light.

It may hold the slots `sun` and `sky`, either without the other; for a slot that it does not
hold it does nothing.

With the setting `cube_device` on "gpu" the cube map is a `GpuJob`, and the background follows
with its result, a transaction later than the light. The CPU makes it instead where nobody
demands GpuJobs (no GL owner in the kernel, as in `vrut-lite sky`), when a job has failed, and
at twilight, whose sky is not the formula's alone.

All six faces are made also when the camera sees two: glossy surfaces mirror the others, and the
message has other readers than the camera. Half of the sphere is ground and costs a fill.
"""

from collections.abc import Callable
from dataclasses import replace

import msgspec
import numpy as np

from dynamic_skylight import products
from dynamic_skylight.daylight import Daylight
from dynamic_skylight.products import NAME
from dynamic_skylight.settings import DynamicSkyLightSettings
from dynamic_skylight.sun_step import sun_step_rad
from dynamic_skylight.tolerance import Quality, quality_for
from vrut_lite.daylight.air import AirChanged
from vrut_lite.daylight.air_reach import rung_m
from vrut_lite.daylight.camera import MoveCamera
from vrut_lite.daylight.observer import eye_height_m
from vrut_lite.daylight.place import SetPlace
from vrut_lite.daylight.scene import SceneNeeds
from vrut_lite.daylight.sky import AmbientChanged, BackgroundChanged, LookAlong
from vrut_lite.daylight.sun import KeyLightChanged, SunMoved
from vrut_lite.daylight.tolerance import SetTolerance, tolerance_of
from vrut_lite.errors import UserError
from vrut_lite.gpu_job import GpuJob, GpuTexture
from vrut_lite.kernel.messages import ClockMoved, Demand, Derived, JobResult, SlotChanged
from vrut_lite.kernel.module import Link, Manifest, Module, handles

SKY = (BackgroundChanged, KeyLightChanged, AmbientChanged, AirChanged)
Recipe = tuple[object, ...]
# By how much an observer may rise or sink unseen, per share by which air may thin: haze thins by
# 1 % over 12 m.
_ALTITUDE_STEP_M = 500.0


class DynamicSkyLight(Module):
    """The sun's position and the Hosek-Wilkie sky.

    The ledger counts, for each message type by name: done, and skipped as "unwanted" or
    "unchanged" (the inputs are those of what was posted last). "sun within tolerance" counts
    moves of the sun that nobody would see; what follows from them is unchanged.
    """

    manifest = Manifest(
        name=NAME, title="DynamicSkyLight", version="0.1.0", provides=("sun", "sky")
    )
    settings_type = DynamicSkyLightSettings
    settings: DynamicSkyLightSettings

    def __init__(self, link: Link, settings: DynamicSkyLightSettings):
        super().__init__(link, settings)
        self._posted: dict[type[Derived], Recipe] = {}
        self._shown: tuple[Daylight, SunMoved] | None = None
        self._awaited: dict[str, BackgroundChanged] = {}
        self._gpu_failed = False
        # Altitude and reach of the air that is shown.
        self._air: tuple[float, float] = (0.0, 0.0)

    @handles(ClockMoved)
    @handles(SetPlace)
    def inputs_changed(self, _message: ClockMoved | SetPlace) -> None:
        """The hour or the place changed: so may the sun."""
        self._move_sun()

    @handles(SlotChanged)
    def slot_changed(self, message: SlotChanged) -> None:
        """Another holder's messages came between: say everything of the slot again."""
        if message.name == "sun":
            self._posted.pop(SunMoved, None)
            self._move_sun()
        elif message.name == "sky":
            for kind in SKY:
                self._posted.pop(kind, None)
            self._light_sky()

    @handles(SunMoved)
    @handles(Demand)
    @handles(SetTolerance)
    def sky_needed(self, _message: SunMoved | Demand | SetTolerance) -> None:
        """The sun moved, or someone wants what nobody wanted before, or wants it finer."""
        self._light_sky()

    @handles(MoveCamera)
    @handles(SceneNeeds)
    def view_changed(self, _message: MoveCamera | SceneNeeds) -> None:
        """The eye is elsewhere, or other things are in view: so may other air be."""
        if self._shown is not None and self.link.holds("sky"):
            self._fill_air(*self._shown)

    @handles(JobResult)
    def cube_done(self, result: JobResult) -> None:
        """The GPU made a cube map: show it, unless a later one is shown already.

        Raises:
            UserError: it could not; from now on the CPU does.
        """
        if result.error:
            self._gpu_failed = True
            self._posted.pop(BackgroundChanged, None)
            self._light_sky()
            raise UserError(
                f"the GPU could not make the sky ({result.error}): set cube_device to cpu"
            )
        texture = GpuTexture.of(result.value)
        if texture.recipe not in self._awaited:
            self.ledger.skip("GpuJob outdated")
            return
        for recipe in tuple(self._awaited):
            background = self._awaited.pop(recipe)
            if recipe == texture.recipe:
                self._post(msgspec.structs.replace(background, cube=texture))
                return

    @handles(LookAlong)
    def looked_along(self, message: LookAlong) -> None:
        """Someone asks for the spectrum of a direction."""
        if self._shown is not None and self.link.holds("sky"):
            self._post(products.spectrum(self._shown[0], message.direction))

    def settings_changed(self, name: str) -> None:
        """A setting has a new value: work out again what depends on it."""
        if name == "sun_method":
            self._move_sun()
            return
        if name == "cube_device":
            self._gpu_failed = False
        self._light_sky()

    def _move_sun(self) -> None:
        clock, place = self.link.last(ClockMoved), self.link.last(SetPlace)
        if clock is None or place is None or not self.link.holds("sun"):
            return
        method = self.settings.sun_method
        self._post_if_new(
            SunMoved, (clock, place, method), lambda: products.sun_moved(clock, place, method)
        )

    def _light_sky(self) -> None:
        sun = self.link.last(SunMoved)
        if sun is None or not self.link.holds("sky"):
            return
        daylight, sun = self._daylight_of(sun)
        demand = self._demand(BackgroundChanged)
        if demand is not None:
            self._paint(daylight, demand.size or self._quality.cube_size)
        if self._demand(KeyLightChanged) is not None:
            self._post_if_new(
                KeyLightChanged,
                (daylight, sun.direction),
                lambda: products.sun_light(daylight, sun.direction),
            )
        if self._demand(AmbientChanged) is not None:
            self._post_if_new(AmbientChanged, (daylight,), lambda: products.ambient(daylight))
        self._fill_air(daylight, sun)

    def _fill_air(self, daylight: Daylight, sun: SunMoved) -> None:
        if self._demand(AirChanged) is None:
            return
        altitude_m, reach_m = self._air = self._air_around()
        if not reach_m:
            self.ledger.skip("AirChanged without things in it")
            return
        self._post_if_new(
            AirChanged,
            (daylight, sun.direction, altitude_m, reach_m),
            lambda: products.air(daylight, sun.direction, altitude_m, reach_m),
        )

    def _air_around(self) -> tuple[float, float]:
        """The observer's altitude and the reach of the air; those of before if they still serve."""
        needs = self.link.last(SceneNeeds)
        shown_m, reach_m = self._air
        altitude_m = eye_height_m(self.link)
        step_m = self._quality.altitude_change * (_ALTITUDE_STEP_M + shown_m)
        stays = abs(altitude_m - shown_m) <= step_m
        needed_m = needs.air_reach_m if needs is not None else 0.0
        return shown_m if stays else altitude_m, rung_m(needed_m, reach_m)

    def _paint(self, daylight: Daylight, size: int) -> None:
        """Make the background, or have it made."""
        on_gpu = self._gpu_serves(daylight)
        make = self._asked_of_gpu if on_gpu else self._made_here
        self._post_if_new(BackgroundChanged, (daylight, size, on_gpu), lambda: make(daylight, size))

    def _made_here(self, daylight: Daylight, size: int) -> BackgroundChanged:
        # What the GPU still works on would come too late.
        self._awaited.clear()
        return products.background(daylight, size)

    def _asked_of_gpu(self, daylight: Daylight, size: int) -> GpuJob:
        job, background = products.gpu_background(daylight, size)
        self._awaited.pop(job.recipe, None)
        self._awaited[job.recipe] = background
        return job

    def _gpu_serves(self, daylight: Daylight) -> bool:
        if self.settings.cube_device == "cpu":
            return False
        hindrances = {
            "nobody runs GPU jobs": self.link.wanted(GpuJob) is None,
            "the GPU failed": self._gpu_failed,
            "twilight": daylight.model is None,
        }
        hindrance = next((name for name, hinders in hindrances.items() if hinders), None)
        if hindrance is not None:
            self.ledger.skip(f"GpuJob: {hindrance}")
        return hindrance is None

    def _daylight_of(self, sun: SunMoved) -> tuple[Daylight, SunMoved]:
        """The hour's light and its sun; those of before if nobody would see a difference."""
        x, _, z = sun.direction
        daylight = Daylight(
            turbidity=self.settings.turbidity,
            albedo=self.settings.albedo,
            sun_colour=self.settings.sun_colour,
            apparent_elevation_rad=sun.apparent_elevation_rad,
            sun_azimuth_rad=float(np.arctan2(x, -z)),
            visible_disc_fraction=sun.visible_disc_fraction,
            light_size=self._quality.light_size,
        )
        change = self._quality.sun_change
        if self._shown is None or not _alike(*self._shown, daylight, sun, change):
            self._shown = (daylight, sun)
        elif self._shown[0] != daylight:
            self.ledger.skip("sun within tolerance")
        return self._shown

    @property
    def _quality(self) -> Quality:
        return quality_for(tolerance_of(self.link))

    def _demand(self, kind: type[Derived]) -> Demand | None:
        demand = self.link.wanted(kind)
        if demand is None:
            self.ledger.skip(f"{kind.__name__} unwanted")
        return demand

    def _post_if_new(
        self, kind: type[Derived], recipe: Recipe, make: Callable[[], Derived]
    ) -> None:
        if self._posted.get(kind) == recipe:
            self.ledger.skip(f"{kind.__name__} unchanged")
            return
        self._post(make())
        self._posted[kind] = recipe

    def _post(self, message: Derived) -> None:
        self.link.post(message)
        self.ledger.did(type(message).__name__)


def _alike(
    shown: Daylight, shown_sun: SunMoved, now: Daylight, sun: SunMoved, change: float
) -> bool:
    """Whether nothing but the sun has moved, and that changes no texel by more than `change`.

    While the disc crosses the horizon its visible share tells every move apart.
    """
    moved_back = replace(
        now,
        apparent_elevation_rad=shown.apparent_elevation_rad,
        sun_azimuth_rad=shown.sun_azimuth_rad,
    )
    chord = float(np.linalg.norm(np.subtract(sun.direction, shown_sun.direction)))
    return moved_back == shown and chord <= sun_step_rad(shown.apparent_elevation_rad, change)
