"""The module on its messages: what it posts, and what it does not compute."""

from typing import Any

import msgspec
import numpy as np
import pytest
from bruneton_sky.module import DEFAULT_SIZE, BrunetonSky
from bruneton_sky.settings import BrunetonSkySettings, atmosphere_of

from vrut_lite.geometry.colour import solar_irradiance
from vrut_lite.geometry.encoding import decode_float16
from vrut_lite.kernel.bus import Kernel
from vrut_lite.kernel.messages import (
    AmbientChanged,
    BackgroundChanged,
    Demand,
    Derived,
    Message,
    SetPlace,
    SetSetting,
    SlotChanged,
    SunLightChanged,
    SunMoved,
)
from vrut_lite.kernel.module import Manifest, Module, handles

PRODUCTS = (BackgroundChanged, SunLightChanged, AmbientChanged)


class FakeLink:
    """A kernel's side without a kernel."""

    def __init__(self) -> None:
        self.posted: list[Derived] = []
        self.demands: dict[type[Message], Demand] = {}
        self.memory: dict[type[Message], Any] = {}
        self.holder = True

    def post(self, message: Derived) -> None:
        self.posted.append(message)

    def wanted(self, message_type: type[Message]) -> Demand | None:
        return self.demands.get(message_type)

    def holds(self, slot: str) -> bool:
        return self.holder and slot == "sky"

    def last(self, message_type: type[Message]) -> Any:
        return self.memory.get(message_type)

    def want(self, *products: type[Message], size: int = 16) -> None:
        for product in products:
            self.demands[product] = Demand(consumer="test", message=product.__name__, size=size)

    def taken(self) -> list[type[Derived]]:
        kinds = [type(message) for message in self.posted]
        self.posted.clear()
        return kinds


def sun_at(elevation_deg: float, visible: float = 1.0) -> SunMoved:
    """A sun in the north."""
    e = float(np.radians(elevation_deg))
    return SunMoved(
        direction=(0.0, float(np.sin(e)), -float(np.cos(e))),
        azimuth_rad=0.0,
        elevation_rad=e,
        apparent_elevation_rad=e,
        visible_disc_fraction=visible,
    )


@pytest.fixture
def link() -> FakeLink:
    return FakeLink()


@pytest.fixture
def sky(link: FakeLink) -> BrunetonSky:
    return BrunetonSky(link, BrunetonSkySettings())


def tell(sky: BrunetonSky, link: FakeLink, message: Message) -> None:
    """Deliver a message as the kernel would: remember it, then call the handler."""
    link.memory[type(message)] = message
    for kind, method in sky.handlers():
        if kind is type(message):
            getattr(sky, method)(message)


def test_posts_what_is_wanted(sky: BrunetonSky, link: FakeLink) -> None:
    """A background of the size asked for, a sun and an ambient light in their declared forms."""
    link.want(*PRODUCTS)
    tell(sky, link, sun_at(30.0))
    background, light, ambient = link.posted
    assert isinstance(background, BackgroundChanged)
    assert background.cube.shape == (6, 16, 16, 3)
    assert background.cube.dtype == np.float16
    radiance = decode_float16(background.cube.values, background.radiance_scale)
    assert 1.0 < radiance.max() < 1000.0
    assert isinstance(light, SunLightChanged)
    assert light.direction == sun_at(30.0).direction
    assert light.irradiance_rgb[0] > light.irradiance_rgb[2] > 10.0
    assert isinstance(ambient, AmbientChanged)
    assert ambient.irradiance_sh_rgb.shape == (25, 3)
    assert ambient.irradiance_sh_rgb.dtype == np.float32


def test_computes_nothing_that_nobody_wants(sky: BrunetonSky, link: FakeLink) -> None:
    """No demand, no slot or no sun: no work, and the ledger says so."""
    tell(sky, link, SetPlace(latitude_deg=0.0, longitude_deg=0.0))
    tell(sky, link, sun_at(30.0))
    link.holder = False
    link.want(*PRODUCTS)
    tell(sky, link, sun_at(31.0))
    assert link.posted == []
    assert not sky.ledger.done
    assert sky.ledger.skipped["BackgroundChanged: nobody wants it"] == 1
    assert sky.ledger.skipped["sky: no sun, or another sky is shown"] == 2


def test_skips_what_did_not_change(sky: BrunetonSky, link: FakeLink) -> None:
    """Equal sun, equal sky: the second telling costs nothing; one table serves all products."""
    link.want(*PRODUCTS)
    tell(sky, link, sun_at(30.0))
    link.posted.clear()
    tell(sky, link, sun_at(30.0))
    assert link.posted == []
    assert sky.ledger.skipped["AmbientChanged: nothing changed"] == 1
    assert sky.ledger.done["sky-view table"] == 1


def test_a_new_demand_is_served_from_the_present_sky(sky: BrunetonSky, link: FakeLink) -> None:
    """A late joiner gets its message without a new table; a larger picture is filled anew."""
    link.want(AmbientChanged)
    tell(sky, link, sun_at(30.0))
    assert link.taken() == [AmbientChanged]
    link.want(BackgroundChanged, size=1)
    tell(sky, link, link.demands[BackgroundChanged])
    assert link.posted[0].cube.shape[1] == DEFAULT_SIZE  # type: ignore[attr-defined]
    assert link.taken() == [BackgroundChanged]
    assert sky.ledger.done["sky-view table"] == 1


def test_place_and_settings_make_a_new_sky(sky: BrunetonSky, link: FakeLink) -> None:
    """Altitude and haze change the light; a place at the same altitude does not."""
    link.want(SunLightChanged)
    tell(sky, link, sun_at(30.0))
    tell(sky, link, SetPlace(latitude_deg=1.0, longitude_deg=0.0, altitude_m=-400.0))
    assert len(link.posted) == 1
    tell(sky, link, SetPlace(latitude_deg=1.0, longitude_deg=0.0, altitude_m=3000.0))
    sky.settings = msgspec.structs.replace(sky.settings, turbidity=8.0)
    sky.settings_changed("turbidity")
    low, high, hazy = (message.irradiance_rgb[2] for message in link.posted)  # type: ignore[attr-defined]
    assert high > 1.5 * low
    assert hazy < 0.95 * high


def test_tells_everything_again_when_it_gets_the_sky_slot(sky: BrunetonSky, link: FakeLink) -> None:
    """Another sky may have been shown; a change of the sun's slot is none of its business."""
    link.want(*PRODUCTS)
    tell(sky, link, sun_at(30.0))
    link.posted.clear()
    tell(sky, link, SlotChanged(name="sun", holder="other"))
    assert link.posted == []
    tell(sky, link, SlotChanged(name="sky", holder="bruneton_sky"))
    assert link.taken() == list(PRODUCTS)


def test_night_is_finite_and_dark(sky: BrunetonSky, link: FakeLink) -> None:
    """Deep night is exactly dark in single scattering, and encodes without a NaN."""
    link.want(*PRODUCTS)
    tell(sky, link, sun_at(-60.0, visible=0.0))
    background, light, ambient = link.posted
    assert not background.cube.values.any()  # type: ignore[attr-defined]
    assert light.irradiance_rgb == (0.0, 0.0, 0.0)  # type: ignore[attr-defined]
    assert not ambient.irradiance_sh_rgb.values.any()  # type: ignore[attr-defined]


def test_settings_make_the_atmosphere() -> None:
    """Default haze is AOD(550) 0.20, under the host's one solar spectrum; each setting counts."""
    air = atmosphere_of(BrunetonSkySettings())
    assert air.mie_extinction[1] * air.mie_scale_height_m == pytest.approx(0.2009, abs=1e-4)
    assert air.solar_irradiance == pytest.approx(solar_irradiance([680.0, 550.0, 440.0]))
    other = atmosphere_of(BrunetonSkySettings(turbidity=1.0, albedo=0.4, ozone=False, mie_g=0.5))
    assert other.ground_albedo == (0.4,) * 3
    assert other.absorption_extinction == (0.0,) * 3
    assert other.mie_g == 0.5


class SunStub(Module):
    """Holds the sun's slot and answers a SetPlace with a sun."""

    manifest = Manifest(name="a_sun", title="Sun", version="1", provides=("sun",))

    @handles(SetPlace)
    def place_set(self, place: SetPlace) -> None:
        self.link.post(sun_at(place.latitude_deg))


def test_lives_in_the_kernel() -> None:
    """With the real kernel: demand, place and setting each bring the light they should."""
    kernel = Kernel()
    kernel.add_module(SunStub)
    kernel.add_module(BrunetonSky)
    kernel.inject(Demand(consumer="test", message="BackgroundChanged", size=16))
    kernel.inject(SetPlace(latitude_deg=30.0, longitude_deg=0.0))
    kernel.pump()
    first = kernel.last(BackgroundChanged)
    assert first is not None
    assert kernel.last(AmbientChanged) is None
    kernel.inject(SetSetting(module="bruneton_sky", name="turbidity", value=5.0))
    kernel.pump()
    assert kernel.last(BackgroundChanged) != first
    assert kernel.last_fault("bruneton_sky") is None
