"""The module: answers the sun's moves with a background, a sun light and an ambient light."""

from typing import ClassVar

import msgspec

from bruneton_sky.background import (
    Surroundings,
    ambient_coefficients,
    background_cube,
    surroundings,
)
from bruneton_sky.settings import BrunetonSkySettings, atmosphere_of
from bruneton_sky.sun_light import limb_darkening_rgb
from vrut_lite.geometry.encoding import encode_float16
from vrut_lite.kernel.array import Array
from vrut_lite.kernel.messages import (
    AmbientChanged,
    BackgroundChanged,
    Demand,
    Derived,
    SetPlace,
    SlotChanged,
    SunLightChanged,
    SunMoved,
    Vector,
)
from vrut_lite.kernel.module import Link, Manifest, Module, handles

DEFAULT_SIZE = 256
PRODUCTS: tuple[type[Derived], ...] = (BackgroundChanged, SunLightChanged, AmbientChanged)


class Recipe(msgspec.Struct, frozen=True):
    """All that the light depends on: equal recipes make equal light."""

    settings: BrunetonSkySettings
    sun_direction: Vector
    visible_disc_fraction: float
    altitude_m: float


class BrunetonSky(Module):
    """Single scattering of a spherical atmosphere, for the sun that SunMoved tells of."""

    manifest: ClassVar[Manifest] = Manifest(
        name="bruneton_sky",
        title="Bruneton sky",
        version="0.1.0",
        provides=("sky",),
        requires=("sun",),
    )
    settings_type: ClassVar[type[msgspec.Struct]] = BrunetonSkySettings

    def __init__(self, link: Link, settings: BrunetonSkySettings):
        super().__init__(link, settings)
        self._posted: dict[type[Derived], tuple[Recipe, int]] = {}
        self._made: tuple[Recipe, Surroundings] | None = None

    @handles(SunMoved)
    @handles(SetPlace)
    @handles(Demand)
    def light_changed(self, _message: SunMoved | SetPlace | Demand) -> None:
        """Post what is wanted and new."""
        self._update()

    @handles(SlotChanged)
    def slot_changed(self, message: SlotChanged) -> None:
        """Another sky may have been shown in between: everything is to be told again."""
        if message.name != "sky":
            return
        self._posted.clear()
        self._update()

    def settings_changed(self, name: str) -> None:
        """Post the sky of the new settings."""
        self._update()

    def _update(self) -> None:
        sun = self.link.last(SunMoved)
        if sun is None or not self.link.holds("sky"):
            self.ledger.skip("sky: no sun, or another sky is shown")
            return
        recipe = self._recipe(sun)
        for product in PRODUCTS:
            demand = self.link.wanted(product)
            if demand is None:
                self.ledger.skip(f"{product.__name__}: nobody wants it")
                continue
            wish = (recipe, self._size(product, demand))
            if self._posted.get(product) == wish:
                self.ledger.skip(f"{product.__name__}: nothing changed")
                continue
            self.link.post(self._make(product, *wish))
            self._posted[product] = wish
            self.ledger.did(product.__name__)

    def _recipe(self, sun: SunMoved) -> Recipe:
        place = self.link.last(SetPlace)
        altitude_m = place.altitude_m if place is not None else 0.0
        top_m = atmosphere_of(self.settings).top_altitude_m
        # Land below sea level has no place in a sphere of air above the sea.
        altitude_m = min(max(altitude_m, 0.0), top_m)
        return Recipe(self.settings, sun.direction, sun.visible_disc_fraction, altitude_m)

    def _size(self, product: type[Derived], demand: Demand) -> int:
        if product is not BackgroundChanged:
            return 0
        # A demand of 1 is the default of a consumer that leaves the size to the sky.
        return demand.size if demand.size > 1 else DEFAULT_SIZE

    def _make(self, product: type[Derived], recipe: Recipe, size: int) -> Derived:
        around = self._surroundings(recipe)
        source = self.manifest.name
        if product is BackgroundChanged:
            values, scale = encode_float16(background_cube(around, size))
            ground_red, ground_green, ground_blue = around.ground_radiance_rgb.tolist()
            return BackgroundChanged(
                cube=Array(values),
                radiance_scale=scale,
                ground_radiance_rgb=(ground_red, ground_green, ground_blue),
                source=source,
            )
        if product is AmbientChanged:
            harmonics = Array(ambient_coefficients(around))
            return AmbientChanged(irradiance_sh_rgb=harmonics, source=source)
        red, green, blue = around.sun_irradiance_rgb.tolist()
        return SunLightChanged(
            direction=recipe.sun_direction,
            irradiance_rgb=(red, green, blue),
            angular_radius_rad=atmosphere_of(recipe.settings).sun_angular_radius_rad,
            limb_darkening_rgb=limb_darkening_rgb(),
            source=source,
        )

    def _surroundings(self, recipe: Recipe) -> Surroundings:
        if self._made is not None and self._made[0] == recipe:
            return self._made[1]
        made = surroundings(
            atmosphere_of(recipe.settings),
            recipe.altitude_m,
            recipe.sun_direction,
            recipe.visible_disc_fraction,
        )
        self._made = (recipe, made)
        self.ledger.did("sky-view table")
        return made
