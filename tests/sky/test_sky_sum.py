"""The module that sums, on the bus: nothing without layers, and one sum with them."""

from datetime import UTC, datetime, timedelta

import msgspec
import numpy as np
import pytest
from cloud_stage import clouds_of, rough_layer
from clouds.sky_layer import CloudsBeforeSky
from light_messages import clear_sky_light, light_messages, radiance_of

from vrut_lite.array import Array
from vrut_lite.daylight_kernel import daylight_kernel
from vrut_lite.geometry.cube_map import texel_directions
from vrut_lite.geometry.encoding import decode_float16
from vrut_lite.kernel.bus import Kernel
from vrut_lite.kernel.messages import Demand, Input, JobResult, SetClock, SetSetting
from vrut_lite.kernel.module import Manifest, Module, handles
from vrut_lite.messages.camera import MoveCamera
from vrut_lite.messages.clouds import CloudLayer
from vrut_lite.messages.place import SetPlace
from vrut_lite.messages.sky import AmbientChanged, BackgroundChanged
from vrut_lite.messages.sky_light import SkyLightChanged
from vrut_lite.messages.sun import KeyLightChanged
from vrut_lite.sky.sky_of_hour import polarisation_message
from vrut_lite.sky.sky_sum import SkySum, sum_up

NOON = datetime(2026, 6, 21, 10, 30, tzinfo=UTC)
SUN = (0.6, 0.8, 0.0)


class Say(Input, frozen=True, kw_only=True):
    """Let the sky shine so bright, or the clouds be so."""

    radiance: float | None = None
    clouds: CloudLayer | None = None


class ToySky(Module):
    """A sky and clouds that say what a test tells them."""

    manifest = Manifest(name="toy_sky", title="Toy", version="1", provides=("sky",))

    @handles(Say)
    def say(self, message):
        if message.radiance is None:
            self.link.post(clouds_of(message.clouds))
            return
        wanted = self.link.wanted(BackgroundChanged)
        cube = np.full((6, wanted.size or 32, wanted.size or 32, 3), message.radiance)
        parts = light_messages(cube, SUN, (90.0, 80.0, 70.0))
        for part in (*parts, radiance_of(parts[0])):
            self.link.post(part)


class Stage:
    def __init__(self):
        self.kernel, self.heard = Kernel(), []
        for module in (ToySky, SkySum):
            self.kernel.add_module(module)
        self.kernel.tap(lambda message, sender: self.heard.append(message))

    def say(self, *messages):
        for message in messages:
            self.kernel.inject(message)
            self.kernel.pump_until_idle()

    def want(self, size=None):
        self.say(Demand(consumer="test", message="SkyLightChanged", size=size))

    @property
    def sums(self):
        return [message for message in self.heard if isinstance(message, SkyLightChanged)]

    @property
    def counters(self):
        return self.kernel.seats["sky_sum"].module.counters


@pytest.fixture
def stage():
    return Stage()


def test_without_layers_the_sum_is_the_clear_sky(stage):
    """The very same messages, once for all three, and no work: the numbers cannot differ."""
    stage.want()
    stage.say(Say(radiance=4.0))
    (light,) = stage.sums
    last = stage.kernel.last
    assert light.background is last(BackgroundChanged)
    assert light.key_light is last(KeyLightChanged)
    assert light.ambient is last(AmbientChanged)
    assert light.layers == ()
    assert stage.counters.skipped["sum: no layers"] >= 1
    assert stage.kernel.wanted(BackgroundChanged).encoding == ""


def test_without_demand_nothing_is_summed(stage):
    """Without demand neither sky nor clouds are wanted, and no sum is made."""
    stage.say(Say(clouds=rough_layer()))
    assert stage.sums == []
    assert stage.kernel.wanted(BackgroundChanged) is None
    stage.want()
    assert stage.kernel.wanted(BackgroundChanged) is not None
    stage.want(0)
    assert stage.kernel.wanted(BackgroundChanged) is None


def test_parts_of_two_hours_are_never_summed(stage):
    """A sky says its parts one after the other: after a night the sum of the day's sky and the
    night's light had ground of 2e11 W m^-2 sr^-1, which is refused. One change is one sum."""
    stage.want(16)
    stage.say(Say(clouds=rough_layer(base_m=900.0)), Say(radiance=1e-9))
    del stage.heard[:]
    stage.say(Say(radiance=4.0))
    ends = [
        message
        for message in stage.heard
        if isinstance(message, JobResult) and message.module == "sky_sum"
    ]
    assert [message.error for message in ends] == [""]
    assert len(stage.sums) == 1


def test_clouds_come_into_the_sum_and_go(stage):
    """With clouds: an array is asked for, less sun, another cube; without them the clear sky."""
    stage.want(16)
    stage.say(Say(radiance=4.0), Say(clouds=rough_layer(base_m=900.0)))
    assert stage.kernel.wanted(BackgroundChanged).encoding == "float16"
    light = stage.sums[-1]
    assert light.layers == ("cloud layer",)
    assert light.background.cube.shape == (6, 16, 16, 3)
    assert light.key_light.irradiance_rgb[0] <= 90.0
    brighter = stage.kernel.last(AmbientChanged).irradiance_sh_rgb.values
    assert not np.allclose(light.ambient.irradiance_sh_rgb.values, brighter, rtol=0.01)
    stage.say(Say(clouds=None))
    assert stage.sums[-1].layers == ()
    assert stage.sums[-1].background is stage.kernel.last(BackgroundChanged)


def test_invisible_changes_are_not_summed_again(stage):
    """A drift by a metre, a step upwards: the same sum. A kilometre of drift: another."""
    layer = rough_layer()
    stage.want(16)
    stage.say(Say(radiance=4.0), Say(clouds=layer))
    made = len(stage.sums)
    stage.say(Say(clouds=rough_layer(drift_m=(0.6, 0.8))))
    stage.say(MoveCamera(eye_m=(3.0, 1.7, 0.0), target_m=(0.0, 0.0, 0.0)))
    assert len(stage.sums) == made
    stage.say(Say(clouds=rough_layer(drift_m=(800.0, 600.0))))
    assert len(stage.sums) == made + 1


@pytest.mark.long
def test_the_real_clouds_darken_the_real_sky():
    """Coverage 1 in the product's kernel: the sun goes, the light falls to a third, so the ground.

    Kasten and Czeplak (1980) measured a quarter under eight octas, all genera together.
    """
    kernel, _ = daylight_kernel()
    for message in (
        SetPlace(latitude_deg=50.0, longitude_deg=14.0),
        SetClock(instant=NOON),
        Demand(consumer="test", message="SkyLightChanged", size=16),
    ):
        kernel.inject(message)
    kernel.pump_until_idle()
    clear = kernel.last(SkyLightChanged)
    kernel.inject(SetSetting(module="clouds", name="coverage", value=1.0))
    kernel.pump_until_idle()
    under = kernel.last(SkyLightChanged)
    kernel.inject(SetClock(instant=NOON + timedelta(seconds=1)))
    kernel.pump_until_idle()
    assert kernel.last(SkyLightChanged) is under
    kernel.close()
    assert clear.layers == ()
    assert under.layers == ("cloud layer",)
    assert max(under.key_light.irradiance_rgb) < 0.01 * max(clear.key_light.irradiance_rgb)
    share = np.divide(under.background.ground_radiance_rgb, clear.background.ground_radiance_rgb)
    assert np.all((share > 0.1) & (share < 0.45))


@pytest.mark.parametrize("density", [1e-4, 0.03])
def test_clouds_transmit_polarised_light_and_add_none(density):
    """Q and U behind clouds are those before them times the transmittance, which is the change of
    the sum's radiance by a change of the clear sky's."""
    clouds = clouds_of(msgspec.structs.replace(rough_layer(base_m=900.0), extinction_per_m=density))
    rng, above = np.random.default_rng(1), texel_directions(16)[..., 1] > 0.0
    cube = rng.uniform(-1.0, 1.0, (2, 6, 16, 16, 3)).astype(np.float32)
    clear = clear_sky_light(*light_messages(np.full((6, 16, 16, 3), 4.0), SUN, (90.0, 80.0, 70.0)))
    lit = []
    for radiance in (400.0, 800.0):
        texels = Array(np.full((6, 16, 16, 3), radiance, np.float16))
        sky = msgspec.structs.replace(
            clear,
            background=msgspec.structs.replace(clear.background, cube=texels),
            radiance=msgspec.structs.replace(clear.radiance, cube=texels),
            polarisation=polarisation_message(cube, "test"),
        )
        origin = (0.0, 0.0, 0.0)
        lit.append(sum_up({CloudsBeforeSky(): clouds}, (), sky, origin, origin, 10.0, 16))
    seen = [decode_float16(o.background.cube.values, o.background.radiance_scale) for o in lit]
    transmitted = (seen[1] - seen[0]) / 400.0
    found = lit[0].polarisation
    ours = decode_float16(found.cube.values, found.radiance_scale)
    difference = np.abs(ours - cube * transmitted)[:, above]
    assert difference.max() < 0.02
    assert transmitted[above].min() < 0.97
