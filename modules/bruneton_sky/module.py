"""The module: answers the sun's moves with a background, sun light, ambient light and air.

A changed atmosphere is solved by a background job; until its result is there the sky is that
of the one before. A moved sun or camera needs no such job: the sky-view table is made on the
spot. No 4-D table is ever made here, since one observer's altitude is shown.

With the setting `cube_device` on "gpu" the table is laid onto the cube map, and the air filled with
light, by a `GpuJob` each, and background and air follow with the results; where nobody runs such
jobs, or one has failed, the CPU does.
"""

from typing import ClassVar

import msgspec

from bruneton_sky import products
from bruneton_sky.awaited import Awaited
from bruneton_sky.background import Surroundings, surroundings
from bruneton_sky.recipe import AirKey, Recipe, light_recipe, recipe_of, unless_seen
from bruneton_sky.settings import (
    BrunetonSkySettings,
    atmosphere_at,
    atmosphere_of,
    spectral_atmosphere_of,
)
from bruneton_sky.solving import SOLVE, Solving
from bruneton_sky.spectrum import SPECTRUM_NM, sky_spectrum
from bruneton_sky.tolerance import TABLES, Quality, quality_for
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
from vrut_lite.kernel.messages import Demand, Derived, JobResult, SlotChanged
from vrut_lite.kernel.module import Link, Manifest, Module, handles

SPECTRUM = "spectrum"
PRODUCTS: tuple[type[Derived], ...] = (
    BackgroundChanged,
    KeyLightChanged,
    AmbientChanged,
    AirChanged,
)
ON_GPU = (BackgroundChanged, AirChanged)
# Settings that say where a sky is computed, not what it is.
_NOT_AIR = {"cube_device": "cpu"}


class BrunetonSky(Module):
    """Multiple scattering in a spherical atmosphere, for the sun that SunMoved tells of."""

    manifest: ClassVar[Manifest] = Manifest(
        name=products.NAME,
        title="Bruneton sky",
        version="0.2.0",
        provides=("sky",),
        requires=("sun",),
        # Kernels that sum in any order: compiled anew they round otherwise than from the cache.
        exact_digits=False,
    )
    settings_type: ClassVar[type[msgspec.Struct]] = BrunetonSkySettings
    settings: BrunetonSkySettings

    def __init__(self, link: Link, settings: BrunetonSkySettings):
        super().__init__(link, settings)
        # Recipe, size or reach, whether the GPU works on it.
        self._posted: dict[type[Derived], tuple[Recipe, float, bool]] = {}
        self._shown: Recipe | None = None
        self._made: tuple[Recipe, Surroundings] | None = None
        self._reach_m = 0.0
        self._solving = Solving(link, self.ledger)
        self._awaited = Awaited()
        self._gpu_failed = False

    @handles(SunMoved)
    @handles(SetPlace)
    @handles(MoveCamera)
    @handles(Demand)
    @handles(SetTolerance)
    def light_changed(
        self, _message: SunMoved | SetPlace | MoveCamera | Demand | SetTolerance
    ) -> None:
        """Post what is wanted and new."""
        self._update()

    @handles(SceneNeeds)
    def needs_changed(self, _message: SceneNeeds) -> None:
        """Things stand farther off, or nearer: so must air be made. The eye may have moved."""
        moved = self._shown is not None and eye_height_m(self.link) != self._shown.altitude_m
        if moved or self._air_reach_m() != self._reach_m:
            self._update()

    @handles(SlotChanged)
    def slot_changed(self, message: SlotChanged) -> None:
        """Another sky may have been shown in between: everything is to be told again."""
        if message.name != "sky":
            return
        self._posted.clear()
        self._update()

    @handles(LookAlong)
    def looked_along(self, message: LookAlong) -> None:
        """Someone asks for the spectrum of a direction: of more wavelengths than are solved."""
        if self._shown is None or not self.link.holds("sky"):
            return
        air = self._shown.air
        self.link.start_job(
            SPECTRUM,
            sky_spectrum,
            atmosphere_at(SPECTRUM_NM, air.settings, air.ground_altitude_m),
            air.settings.orders,
            self._shown.altitude_m,
            message.direction,
            self._shown.sun_direction,
        )

    @handles(JobResult)
    def job_done(self, result: JobResult) -> None:
        """An atmosphere is solved, or a texture made.

        Raises:
            UserError: the GPU could not make cube map or air; from now on the CPU does.
        """
        if result.job == SOLVE:
            if self._solving.take(result):
                self._update()
        elif result.job == SPECTRUM:
            if not result.error:
                self._post(products.spectrum(result.value))
        else:
            self._texture_made(result)

    def _texture_made(self, result: JobResult) -> None:
        if result.error:
            self._gpu_failed = True
            # Of what nobody wants just now too, for somebody may come back to it.
            for product in ON_GPU:
                self._posted.pop(product, None)
            self._update()
            raise UserError(
                f"the GPU could not make the sky ({result.error}): set cube_device to cpu"
            )
        message = self._awaited.next(result.job, GpuTexture.of(result.value))
        if message is None:
            self.ledger.skip("GpuJob outdated")
        else:
            self._post(message)

    def settings_changed(self, name: str) -> None:
        """Post the sky of the new settings."""
        if name == "cube_device":
            self._gpu_failed = False
        self._update()

    def _update(self) -> None:
        sun = self.link.last(SunMoved)
        if sun is None or not self.link.holds("sky"):
            self.ledger.skip("sky: no sun, or another sky is shown")
            return
        wishes = {product: self.link.wanted(product) for product in PRODUCTS}
        for product in (product for product, demand in wishes.items() if demand is None):
            self.ledger.skip(f"{product.__name__}: nobody wants it")
        wanted = {product: demand for product, demand in wishes.items() if demand is not None}
        self._reach_m = self._air_reach_m()
        if AirChanged in wanted and not self._reach_m:
            self.ledger.skip("AirChanged: nothing stands in it")
            del wanted[AirChanged]
        if wanted:
            self._solve_if_new()
        if wanted and self._solving.solved is not None:
            self._show(self._recipe(sun, self._solving.solved[0]), wanted)

    def _show(self, recipe: Recipe, wanted: dict[type[Derived], Demand]) -> None:
        self._shown = recipe
        for product, demand in wanted.items():
            on_gpu = product in ON_GPU and self._gpu_serves()
            wish = (recipe_of(product, recipe), self._size(product, demand), on_gpu)
            if self._posted.get(product) == wish:
                self.ledger.skip(f"{product.__name__}: nothing changed")
                continue
            self._post(self._make(product, recipe, *wish[1:]))
            self._posted[product] = wish

    def _post(self, message: Derived) -> None:
        self.link.post(message)
        self.ledger.did(type(message).__name__)

    def _gpu_serves(self) -> bool:
        if self.settings.cube_device == "cpu":
            return False
        hindrances = {
            "nobody runs GPU jobs": self.link.wanted(GpuJob) is None,
            "the GPU failed": self._gpu_failed,
        }
        hindrance = next((name for name, hinders in hindrances.items() if hinders), None)
        if hindrance is not None:
            self.ledger.skip(f"GpuJob: {hindrance}")
        return hindrance is None

    def _solve_if_new(self) -> None:
        """Have the atmosphere of today's settings solved."""
        place = self.link.last(SetPlace)
        self._solving.ask(
            AirKey(
                settings=msgspec.structs.replace(self.settings, **_NOT_AIR),
                ground_altitude_m=place.altitude_m if place is not None else 0.0,
                rung=self._quality.solver,
            )
        )

    def _recipe(self, sun: SunMoved, air: AirKey) -> Recipe:
        """What is to be shown: that of before if nobody would see a difference."""
        height_m, quality = eye_height_m(self.link), self._quality
        now = Recipe(air, sun.direction, sun.visible_disc_fraction, height_m, quality.table)
        if self._shown is None:
            return now
        kept = unless_seen(now, self._shown, quality)
        if kept != now:
            self.ledger.skip("sun or observer moved unseen")
        return kept

    def _air_reach_m(self) -> float:
        """How far the air is to be made: what the scene needs, or the rung that still serves."""
        needs = self.link.last(SceneNeeds)
        return rung_m(needs.air_reach_m, self._reach_m) if needs is not None else 0.0

    def _size(self, product: type[Derived], demand: Demand) -> float:
        if product is not BackgroundChanged:
            return self._reach_m if product is AirChanged else 0
        return demand.size or self._quality.cube_size

    @property
    def _quality(self) -> Quality:
        return quality_for(tolerance_of(self.link))

    def _make(self, product: type[Derived], recipe: Recipe, size: float, on_gpu: bool) -> Derived:
        if product is AirChanged:
            assert self._solving.solved is not None
            field, height_m, sun = self._solving.solved[1], recipe.altitude_m, recipe.sun_direction
            air = products.air(field, height_m, sun, size, on_gpu)
            return self._awaited.first(products.AIR_JOB, *air)
        around = self._surroundings(recipe)
        if product is AmbientChanged:
            return products.ambient(around)
        if product is KeyLightChanged:
            radius_rad = atmosphere_of(recipe.air.settings).sun_angular_radius_rad
            return products.sun_light(around, recipe.sun_direction, radius_rad)
        if on_gpu:
            return self._awaited.first(
                products.CUBE_JOB, *products.gpu_background(around, int(size))
            )
        return self._awaited.first(products.CUBE_JOB, None, products.background(around, int(size)))

    def _surroundings(self, recipe: Recipe) -> Surroundings:
        known = None
        if self._made is not None:
            before, around = self._made
            if before == recipe:
                return around
            if light_recipe(before) == light_recipe(recipe):
                self.ledger.skip("light on the scene: only the observer moved")
                known = around
        assert self._solving.solved is not None
        made = surroundings(
            self._solving.solved[1],
            recipe.altitude_m,
            recipe.sun_direction,
            recipe.visible_disc_fraction,
            spectral_atmosphere_of(recipe.air.settings, recipe.air.ground_altitude_m),
            known,
            TABLES[recipe.table],
        )
        self._made = (recipe, made)
        self.ledger.did("sky-view table")
        return made
