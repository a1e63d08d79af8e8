"""The module on its messages: what it posts, and what it does not compute."""

from collections.abc import Callable
from typing import Any, get_args

import msgspec
import numpy as np
import pytest
from bruneton_sky.atmosphere import Atmosphere
from bruneton_sky.module import BrunetonSky
from bruneton_sky.settings import BrunetonSkySettings, PresetName, atmosphere_of

from vrut_lite.daylight.camera import MoveCamera
from vrut_lite.daylight.place import SetPlace
from vrut_lite.daylight.scene import SceneNeeds
from vrut_lite.daylight.sky import AmbientChanged, BackgroundChanged
from vrut_lite.daylight.sun import KeyLightChanged, SunMoved
from vrut_lite.errors import UserError
from vrut_lite.geometry.colour import solar_irradiance
from vrut_lite.geometry.encoding import decode_float16
from vrut_lite.gpu_job import GpuJob, GpuTexture
from vrut_lite.kernel.bus import Kernel
from vrut_lite.kernel.job import JobControl
from vrut_lite.kernel.messages import Demand, Derived, JobResult, Message, SetSetting, SlotChanged
from vrut_lite.kernel.module import Manifest, Module, handles

PRODUCTS = (BackgroundChanged, KeyLightChanged, AmbientChanged)


class FakeLink:
    """A kernel's side without a kernel."""

    def __init__(self) -> None:
        self.posted: list[Derived] = []
        self.demands: dict[type[Message], Demand] = {}
        self.memory: dict[type[Message], Any] = {}
        self.holder = True
        self.jobs: dict[str, Callable[[], Any]] = {}
        self.started = 0

    def post(self, message: Derived) -> None:
        self.posted.append(message)

    def wanted(self, message_type: type[Message]) -> Demand | None:
        return self.demands.get(message_type)

    def holds(self, slot: str) -> bool:
        return self.holder and slot == "sky"

    def last(self, message_type: type[Message]) -> Any:
        return self.memory.get(message_type)

    def start_job(self, name: str, work: Callable[..., Any], *arguments: Any) -> None:
        self.started += 1
        control = JobControl(lambda _text: None)
        self.jobs[name] = lambda: work(*arguments, control=control)

    def cancel_job(self, name: str) -> None:
        self.jobs.pop(name, None)

    def finish(self, sky: BrunetonSky) -> None:
        """Let the waiting jobs bring their results, as the kernel would."""
        jobs, self.jobs = self.jobs, {}
        for name, run in jobs.items():
            sky.job_done(JobResult(module="bruneton_sky", job=name, value=run()))

    def want(self, *products: type[Message], size: int | None = 16) -> None:
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
    """Deliver a message as the kernel would: remember it, call the handler, let jobs finish."""
    link.memory[type(message)] = message
    for kind, method in sky.handlers():
        if kind is type(message):
            getattr(sky, method)(message)
    link.finish(sky)


def choose(sky: BrunetonSky, **values: Any) -> None:
    """Change settings as the kernel would."""
    for name, value in values.items():
        sky.settings = msgspec.structs.replace(sky.settings, **{name: value})
        sky.settings_changed(name)


def camera_at(height_m: float) -> MoveCamera:
    """A camera above the place."""
    return MoveCamera(eye_m=(0.0, height_m, 0.0), target_m=(0.0, height_m, -1.0))


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
    assert isinstance(light, KeyLightChanged)
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
    link.want(BackgroundChanged, size=None)
    tell(sky, link, link.demands[BackgroundChanged])
    assert link.posted[0].cube.shape[1] == 256  # type: ignore[attr-defined]
    assert link.taken() == [BackgroundChanged]
    assert sky.ledger.done["sky-view table"] == 1


def test_place_and_settings_make_a_new_sky(sky: BrunetonSky, link: FakeLink) -> None:
    """Altitude and haze change the light; a place at the same altitude does not."""
    link.want(KeyLightChanged)
    tell(sky, link, sun_at(30.0))
    tell(sky, link, SetPlace(latitude_deg=1.0, longitude_deg=0.0))
    assert len(link.posted) == 1
    tell(sky, link, SetPlace(latitude_deg=1.0, longitude_deg=0.0, altitude_m=-400.0))
    tell(sky, link, SetPlace(latitude_deg=1.0, longitude_deg=0.0, altitude_m=3000.0))
    choose(sky, turbidity=8.0)
    link.finish(sky)
    level, basin, high, hazy = (m.irradiance_rgb[2] for m in link.posted)  # type: ignore[attr-defined]
    assert basin < level
    assert high > 1.5 * level
    assert hazy < 0.95 * high


def test_the_old_sky_stays_until_the_new_one_is_there(sky: BrunetonSky, link: FakeLink) -> None:
    """While an atmosphere is solved the sun moves on under the one before, whole."""
    link.want(KeyLightChanged)
    tell(sky, link, sun_at(30.0))
    choose(sky, turbidity=9.0)
    link.memory[SunMoved] = sun_at(40.0)
    sky.light_changed(sun_at(40.0))
    old, moved = (m.irradiance_rgb[2] for m in link.posted)  # type: ignore[attr-defined]
    assert moved > old
    link.finish(sky)
    assert link.posted[-1].irradiance_rgb[2] < old  # type: ignore[attr-defined]


def test_dragging_a_slider_leaves_one_job(sky: BrunetonSky, link: FakeLink) -> None:
    """The latest wish replaces those before; back at the start nothing is left to do."""
    link.want(KeyLightChanged)
    tell(sky, link, sun_at(30.0))
    for turbidity in (4.0, 5.0, 6.0):
        choose(sky, turbidity=turbidity)
    assert len(link.jobs) == 1
    assert sky.ledger.skipped["atmosphere overtaken by a newer one"] == 2
    choose(sky, turbidity=None)
    assert link.jobs == {}
    assert len(link.posted) == 1


def test_where_a_sky_is_computed_is_no_new_air(sky: BrunetonSky, link: FakeLink) -> None:
    """The device changes no light: nothing is solved again."""
    link.want(KeyLightChanged)
    tell(sky, link, sun_at(30.0))
    choose(sky, cube_device="gpu")
    assert link.started == 1


def test_an_impossible_atmosphere_is_refused_once(sky: BrunetonSky, link: FakeLink) -> None:
    """One sentence; the sky stays, and a moved sun does not repeat the complaint."""
    link.want(KeyLightChanged)
    tell(sky, link, sun_at(30.0))
    link.memory[SetPlace] = SetPlace(latitude_deg=0.0, longitude_deg=0.0, altitude_m=8e4)
    with pytest.raises(UserError, match=r"no such atmosphere: a ground at 80000 m lies outside"):
        sky.light_changed(link.memory[SetPlace])
    tell(sky, link, sun_at(50.0))
    assert link.taken() == [KeyLightChanged] * 2


def test_what_was_refused_is_refused_again(sky: BrunetonSky, link: FakeLink) -> None:
    """After a good atmosphere in between; or the settings would say what is not shown."""
    link.want(KeyLightChanged)
    tell(sky, link, sun_at(30.0))
    high = SetPlace(latitude_deg=0.0, longitude_deg=0.0, altitude_m=30_000.0)
    for _ in range(2):
        link.memory[SetPlace] = high
        choose(sky, top_altitude_m=40_000.0)
        with pytest.raises(UserError, match="no such atmosphere"):
            choose(sky, top_altitude_m=20_000.0)


def test_a_scene_s_own_camera_takes_the_observer_along(sky: BrunetonSky, link: FakeLink) -> None:
    """No MoveCamera tells of it: SceneNeeds does, and counts more than an older camera."""
    link.want(BackgroundChanged)
    tell(sky, link, camera_at(2.0))
    tell(sky, link, sun_at(30.0))
    on_ground = link.posted[-1]
    needs = SceneNeeds(
        sky_in_view=True, visible_faces=(0,), receives_light=True, eye_height_m=24_000.0
    )
    tell(sky, link, needs)
    aloft = link.posted[-1]
    assert aloft is not on_ground
    assert aloft.ground_through_air
    assert not on_ground.ground_through_air


def test_a_job_that_fails_leaves_the_sky(sky: BrunetonSky, link: FakeLink) -> None:
    """The kernel tells the fault; the module goes on with what it has and does not try again."""
    link.want(KeyLightChanged)
    tell(sky, link, sun_at(30.0))
    choose(sky, turbidity=9.0)
    sky.job_done(JobResult(module="bruneton_sky", job="solve", error="out of memory"))
    started = link.started
    link.jobs.clear()
    tell(sky, link, sun_at(50.0))
    assert link.started == started
    assert link.taken() == [KeyLightChanged] * 2


def test_the_camera_takes_the_observer_along(sky: BrunetonSky, link: FakeLink) -> None:
    """From 10 km the sky darkens; the light on the scene, which stays below, does not change: it
    is neither made nor told again, and the ledger counts that."""
    link.want(*PRODUCTS)
    tell(sky, link, sun_at(30.0))
    for height_m in (10_000.0, 20_000.0, 0.0):
        tell(sky, link, camera_at(height_m))
    backgrounds = [m for m in link.posted if isinstance(m, BackgroundChanged)]
    zenith = [decode_float16(m.cube.values, m.radiance_scale)[2, 8, 8, 2] for m in backgrounds]
    assert zenith[1] < 0.7 * zenith[0]
    assert zenith[2] < 0.7 * zenith[1]
    assert zenith[3] == zenith[0]
    assert len({m.ground_radiance_rgb for m in backgrounds}) == 1
    for product in (KeyLightChanged, AmbientChanged):
        assert sum(isinstance(m, product) for m in link.posted) == 1
        assert sky.ledger.skipped[f"{product.__name__}: nothing changed"] == 3
    assert sky.ledger.skipped["light on the scene: only the observer moved"] == 3


def test_light_does_not_depend_on_who_looks(link: FakeLink) -> None:
    """Under one sun an observer aloft lights the scene as one on the ground does: within 0.2 %,
    what the small table that is made aloft adds to the error of the large one."""
    lights = []
    for height_m in (0.0, 5_000.0, 4e5):
        sky = BrunetonSky(link, BrunetonSkySettings())
        link.want(AmbientChanged, KeyLightChanged)
        link.memory[MoveCamera] = camera_at(height_m)
        tell(sky, link, sun_at(30.0))
        lights.append(link.posted[-2:])
    sun, ambient = lights[0]
    for other_sun, other_ambient in lights[1:]:
        assert other_sun == sun
        ours = other_ambient.irradiance_sh_rgb.values  # type: ignore[attr-defined]
        theirs = ambient.irradiance_sh_rgb.values  # type: ignore[attr-defined]
        np.testing.assert_allclose(ours, theirs, atol=2e-3 * np.abs(theirs).max())


def test_a_walk_and_a_second_of_time_are_unseen(sky: BrunetonSky, link: FakeLink) -> None:
    """Below what anyone sees nothing is computed, and the ledger counts it."""
    link.want(*PRODUCTS)
    tell(sky, link, sun_at(30.0))
    link.posted.clear()
    tell(sky, link, camera_at(1.7))
    tell(sky, link, sun_at(30.004))
    assert link.posted == []
    assert sky.ledger.skipped["sun or observer moved unseen"] == 2


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
    """Deep in the planet's shadow less is left than starlight, 1e-6 W m^-2 sr^-1, and no NaN."""
    link.want(*PRODUCTS)
    tell(sky, link, sun_at(-60.0, visible=0.0))
    background, light, ambient = link.posted
    radiance = decode_float16(background.cube.values, background.radiance_scale)  # type: ignore[attr-defined]
    assert np.isfinite(radiance).all()
    assert radiance.max() < 1e-7
    assert light.irradiance_rgb == (0.0, 0.0, 0.0)  # type: ignore[attr-defined]
    assert np.abs(ambient.irradiance_sh_rgb.values).max() < 1e-6  # type: ignore[attr-defined]


def test_settings_make_the_atmosphere() -> None:
    """Default haze is AOD(550) 0.20, under the host's one solar spectrum; each setting counts."""
    air = atmosphere_of(BrunetonSkySettings())
    depth = np.asarray(air.mie_extinction) * air.mie_scale_height_m
    assert np.interp(550.0, air.wavelength_nm[::-1], depth[::-1]) == pytest.approx(0.2009, abs=6e-3)
    assert air.solar_irradiance == pytest.approx(solar_irradiance(air.wavelength_nm))
    other = atmosphere_of(BrunetonSkySettings(turbidity=1.0, albedo=0.4, ozone_du=0.0, mie_g=0.5))
    assert set(other.ground_albedo) == {0.4}
    assert not any(other.absorption_extinction)
    assert other.mie_g == 0.5
    assert other.mie_extinction[1] * 1200.0 == pytest.approx(0.0, abs=1e-3)


@pytest.mark.parametrize("preset", get_args(PresetName))
def test_every_preset_makes_an_atmosphere(preset: PresetName) -> None:
    """What is left open is the preset's own; a moved layer keeps its matter per square metre, also
    one as high as the air, of which the top cuts a third off."""
    for top_m, height_m in ((None, 5000.0), (20_000.0, 20_000.0)):
        air, moved = (
            atmosphere_of(
                BrunetonSkySettings(preset=preset, top_altitude_m=top_m, **heights)
            )
            for heights in (
                {}, {"rayleigh_scale_height_m": height_m, "mie_scale_height_m": 0.1 * height_m},
            )
        )  # fmt: skip
        for column, same in zip(_columns(air), _columns(moved), strict=True):
            np.testing.assert_allclose(column, same, rtol=1e-6)


def _columns(air: Atmosphere) -> list[np.ndarray]:
    """Depth of scattering by molecules and aerosol, summed over fine layers up to the top."""
    edges = np.linspace(0.0, air.top_altitude_m, 200_001)
    middle, thickness = 0.5 * (edges[1:] + edges[:-1]), edges[1]
    return [
        np.asarray(scattering) * (np.exp(-middle / height_m).sum() * thickness)
        for scattering, height_m in (
            (air.rayleigh_scattering, air.rayleigh_scale_height_m),
            (air.mie_scattering, air.mie_scale_height_m),
        )
    ]


def test_ozone_is_measured_in_dobson_units() -> None:
    """The standard 300 DU are the preset's own ozone; Mars can be given some."""
    earth = atmosphere_of(BrunetonSkySettings())
    assert atmosphere_of(BrunetonSkySettings(ozone_du=300.0)) == earth
    mars = atmosphere_of(BrunetonSkySettings(preset="mars-like", ozone_du=300.0))
    assert mars.absorption_extinction == earth.absorption_extinction


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
    kernel.pump_until_idle()
    first = kernel.last(BackgroundChanged)
    assert first is not None
    assert kernel.last(AmbientChanged) is None
    kernel.inject(SetSetting(module="bruneton_sky", name="turbidity", value=5.0))
    kernel.pump_until_idle()
    assert kernel.last(BackgroundChanged) != first
    assert kernel.last_fault("bruneton_sky") is None


@pytest.fixture
def gpu_sky(link: FakeLink) -> BrunetonSky:
    """With the GPU chosen, somebody to run its jobs, and the sun 30 degrees up."""
    sky = BrunetonSky(link, BrunetonSkySettings(cube_device="gpu"))
    link.want(GpuJob, BackgroundChanged, size=None)
    tell(sky, link, sun_at(30.0))
    return sky


def texture_of(job: GpuJob) -> GpuTexture:
    return GpuTexture(size=job.size, format=job.format, recipe=job.recipe)


def test_the_gpu_makes_the_cube_map(gpu_sky: BrunetonSky, link: FakeLink) -> None:
    """A job of 256 texels unless a size is asked for; its texture becomes the background."""
    (job,) = link.posted
    assert isinstance(job, GpuJob)
    assert (job.size, job.read_back) == (256, False)
    result = JobResult(module="bruneton_sky", job=job.job, value=texture_of(job))
    gpu_sky.job_done(result)
    background = link.posted[-1]
    assert isinstance(background, BackgroundChanged)
    assert background.cube == texture_of(job)
    assert min(background.ground_radiance_rgb) > 0.0


def test_a_texture_that_comes_late_is_not_shown(gpu_sky: BrunetonSky, link: FakeLink) -> None:
    """The sun moved on: the newer job's texture is the one to show."""
    tell(gpu_sky, link, sun_at(31.0))
    old, new = link.posted
    gpu_sky.job_done(JobResult(module="bruneton_sky", job="cube", value=texture_of(new)))  # type: ignore[arg-type]
    gpu_sky.job_done(JobResult(module="bruneton_sky", job="cube", value=texture_of(old)))  # type: ignore[arg-type]
    assert len(link.posted) == 3
    assert gpu_sky.ledger.skipped["GpuJob outdated"] == 1


def test_where_the_gpu_fails_the_cpu_goes_on(gpu_sky: BrunetonSky, link: FakeLink) -> None:
    """One sentence that tells what to do, and the sky is there all the same."""
    with pytest.raises(UserError, match="set cube_device to cpu"):
        gpu_sky.job_done(JobResult(module="bruneton_sky", job="cube", error="out of memory"))
    assert isinstance(link.posted[-1], BackgroundChanged)
    tell(gpu_sky, link, sun_at(35.0))
    assert isinstance(link.posted[-1], BackgroundChanged)
    assert gpu_sky.ledger.skipped["GpuJob: the GPU failed"] == 2


def test_without_a_gpu_the_cpu_makes_it(link: FakeLink) -> None:
    """In a kernel without GL nobody wants jobs."""
    sky = BrunetonSky(link, BrunetonSkySettings(cube_device="gpu"))
    link.want(BackgroundChanged)
    tell(sky, link, sun_at(30.0))
    assert isinstance(link.posted[-1], BackgroundChanged)
    assert sky.ledger.skipped["GpuJob: nobody runs GPU jobs"] == 1
