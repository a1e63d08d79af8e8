"""The card's air in the light of sun, moon and glow beside the processor's, through the kernel."""

from concurrent.futures import wait

import numpy as np
import pytest
from bruneton_sky.module import BrunetonSky
from moon_on_bus import FULL_MOON, PlaceMoon, SkyUnderMoon

from vrut_lite.messages.air import AirVolume
from vrut_lite.messages.gpu_texture import GpuTexture
from vrut_lite.sky.air_volume import light_of

pytestmark = pytest.mark.gl
MOON = PlaceMoon(elevation_deg=40.0, azimuth_deg=-135.0, glow=3e-7)
DARK = PlaceMoon(elevation_deg=40.0, azimuth_deg=-135.0, glow=3e-7, share=1e-6 * FULL_MOON)
NONE = PlaceMoon(glow=3e-7)
SKIPPED = "air in a second light: dark"
# The processor rounds a body's air to half precision, and its share with the glow again.
OF_VALUE = 1.5e-3


class SkyOnCard(SkyUnderMoon):
    """The sky with a card, which makes the air before a method returns."""

    def __init__(self, owner, depth_550):
        from vrut_lite.render.gl_jobs import GlJobs

        self.owner, self._jobs = owner, None
        super().__init__(BrunetonSky, depth_550)
        self.kernel.add_module(GlJobs, owner=owner, inject=self.kernel.inject)
        self._jobs = self.kernel.seats["gl_jobs"].module
        self.set("cube_device", "gpu")

    def tell(self, *messages):
        super().tell(*messages)
        while self._jobs is not None and self._jobs.pending:
            wait(self._jobs.pending)
            self._jobs.pending = []
            self.kernel.pump_until_idle()


@pytest.fixture(scope="module")
def stages(gl_owner):
    """The same sky with a card and without one."""
    return SkyOnCard(gl_owner, 0.2), SkyUnderMoon(BrunetonSky, 0.2)


def by_card(sky: SkyOnCard, volume: AirVolume) -> list[np.ndarray]:
    """The light (3, slices, rows, columns, 3) of each body of a texture."""
    texture = volume.light
    assert isinstance(texture, GpuTexture)
    columns, rows, depth = texture.size
    values = np.frombuffer(sky.owner.call(lambda _: texture.opaque.read()), np.float32)
    bodies = 1 if volume.second is None else 2
    light = values.reshape(bodies, 3, depth // (3 * bodies), rows, columns, 4)[..., :3]
    assert volume.extinction.shape[0] == light.shape[2]
    return list(light * volume.radiance_scale)


def by_processor(volume: AirVolume) -> list[np.ndarray]:
    found = [light_of(volume).astype(float) * volume.radiance_scale]
    if volume.second is not None:
        found.append(volume.second.light.values.astype(float) * volume.second.radiance_scale)
    return found


def check(stages, sun_deg, moon, bodies):
    card, _ = stages
    made, expected = (stage.air(sun_deg, moon, -60.0) for stage in stages)
    pairs = list(zip(by_card(card, made), by_processor(expected), strict=True))
    assert len(pairs) == bodies
    for found, light in pairs:
        assert light.max() > 0.0
        # Much less than the brightest has fewer digits in half precision.
        assert np.all(np.abs(found - light) <= OF_VALUE * light + 1e-6 * light.max())
    assert made.sun_direction == expected.sun_direction
    if bodies == 2:
        assert made.second.direction == expected.second.direction
    assert made.extinction == expected.extinction


@pytest.mark.parametrize("sun_deg", [0.2, -0.3, -4.0, -10.0, -18.5])
def test_air_in_the_light_of_sun_and_moon_is_the_processors(stages, sun_deg):
    """Where the sun casts shadows and where the moon does; each has its own place, the glow is in
    the light of the first, and both are in one texture, which one job makes."""
    check(stages, sun_deg, MOON, bodies=2)


@pytest.mark.parametrize(("sun_deg", "moon"), [(-12.0, NONE), (-30.0, MOON), (5.0, MOON)])
def test_air_in_one_light_and_the_glow_is_the_processors(stages, sun_deg, moon):
    """After dusk without a moon, in a moonlit night, and by day."""
    check(stages, sun_deg, moon, bodies=1)


def test_a_second_light_that_is_dark_takes_no_work(stages):
    """On either device, and it is counted: with a sun that is up an eclipsed moon adds less than a
    thousandth, a full one is seen near its place."""

    def skipped():
        return [stage.counters.skipped[SKIPPED] for stage in stages]

    before = skipped()
    check(stages, 0.2, DARK, bodies=1)
    after = skipped()
    assert all(now > then for now, then in zip(after, before, strict=True))
    check(stages, 0.2, MOON, bodies=2)
    assert skipped() == after
