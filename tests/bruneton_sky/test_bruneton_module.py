"""The module on a kernel: what it solves, what it posts, and what it does not compute.

What it shares with every sky, tests/test_sky_contract.py holds.
"""

from typing import get_args

import numpy as np
import pytest
from bruneton_sky.atmosphere import Atmosphere
from bruneton_sky.module import BrunetonSky
from bruneton_sky.settings import BrunetonSkySettings, PresetName, atmosphere_of

from vrut_lite.geometry.colour import solar_irradiance
from vrut_lite.geometry.encoding import decode_float16
from vrut_lite.kernel.messages import EnableModule, JobResult
from vrut_lite.messages.camera import MoveCamera
from vrut_lite.messages.gpu_job import GpuJob
from vrut_lite.messages.sky import AmbientChanged, BackgroundChanged
from vrut_lite.messages.sun import KeyLightChanged
from vrut_lite.testing.sky_on_bus import SkyOnBus

LIGHT = (BackgroundChanged, KeyLightChanged, AmbientChanged)


@pytest.fixture
def sky() -> SkyOnBus:
    return SkyOnBus(BrunetonSky)


@pytest.fixture
def by_day(sky: SkyOnBus) -> SkyOnBus:
    """All light is wanted, and was posted for a sun at 30 degrees."""
    sky.want(*LIGHT, size=16)
    sky.sun(30.0)
    return sky


@pytest.fixture
def lit(sky: SkyOnBus) -> SkyOnBus:
    """Sunlight alone is wanted, and was posted for a sun at 30 degrees."""
    sky.want(KeyLightChanged)
    sky.sun(30.0)
    return sky


def blue(sky: SkyOnBus) -> list[float]:
    """The blue of each sunlight that was posted since last asked."""
    return [m.irradiance_rgb[2] for m in sky.taken() if isinstance(m, KeyLightChanged)]


def test_posts_what_is_wanted(by_day: SkyOnBus) -> None:
    """A background of the size asked for, a sun and an ambient light in their declared forms."""
    background, light, ambient = by_day.taken()
    assert isinstance(background, BackgroundChanged)
    assert background.cube.shape == (6, 16, 16, 3)  # type: ignore[union-attr]
    assert background.cube.dtype == np.float16  # type: ignore[union-attr]
    radiance = decode_float16(background.cube.values, background.radiance_scale)  # type: ignore[union-attr]
    assert 1.0 < radiance.max() < 1000.0
    assert isinstance(light, KeyLightChanged)
    assert light.irradiance_rgb[0] > light.irradiance_rgb[2] > 10.0
    assert isinstance(ambient, AmbientChanged)
    assert ambient.irradiance_sh_rgb.shape == (25, 3)
    assert ambient.irradiance_sh_rgb.dtype == np.float32


def test_solves_nothing_without_demand(sky: SkyOnBus) -> None:
    """Without demand or without the slot there is no job."""
    sky.sun(30.0)
    sky.lose_slot()
    sky.want(*LIGHT)
    sky.sun(31.0)
    assert not sky.counters.done


def test_one_table_serves_all_messages(sky: SkyOnBus) -> None:
    """A late consumer gets its message from the sky-view table that is there."""
    sky.want(AmbientChanged)
    sky.sun(30.0)
    assert sky.kinds_taken() == [AmbientChanged]
    sky.want(BackgroundChanged)
    assert sky.kinds_taken() == [BackgroundChanged]
    assert sky.last(BackgroundChanged).cube.shape[1] == 256  # type: ignore[union-attr]
    assert sky.counters.done["sky-view table"] == 1


def test_place_and_settings_make_a_new_sky(lit: SkyOnBus) -> None:
    """The ground's altitude and haze change the light."""
    lit.sun(30.0, ground_m=-400.0)
    lit.sun(30.0, ground_m=3000.0)
    lit.set("turbidity", 8.0)
    level, _, basin, _, high, _, hazy = blue(lit)
    assert basin < level
    assert high > 1.5 * level
    assert hazy < 0.95 * high


def test_the_old_sky_stays_until_the_new_one_is_there(lit: SkyOnBus) -> None:
    """While an atmosphere is solved the sun moves on under the one before, whole."""
    lit.holding = True
    lit.set("turbidity", 9.0)
    lit.sun(40.0)
    old, moved = blue(lit)
    assert moved > old
    lit.finish()
    _, hazy = blue(lit)
    assert hazy < old


def test_a_draft_of_another_air_stands_in_by_day(by_day: SkyOnBus) -> None:
    """It is the same to the eye and comes in a fifth of the time; in twilight it is darker."""

    def ambient() -> list[np.ndarray]:
        found = [m for m in by_day.taken() if isinstance(m, AmbientChanged)]
        return [message.irradiance_sh_rgb.values[0] for message in found]

    by_day.taken()
    by_day.set("turbidity", 5.0)
    draft, solved = ambient()
    assert np.any(draft != solved)
    np.testing.assert_allclose(draft, solved, rtol=5e-3)
    by_day.sun(-3.0)
    by_day.taken()
    by_day.set("turbidity", 4.0)
    assert len(ambient()) == 1


def test_dragging_a_slider_leaves_one_job(lit: SkyOnBus) -> None:
    """The latest wish replaces those before; back at the start nothing is left to do."""
    lit.taken()
    lit.holding = True
    for turbidity in (4.0, 5.0, 6.0):
        lit.set("turbidity", turbidity)
    assert lit.held == ["solve"]
    assert lit.counters.skipped["preparation overtaken by a newer one"] == 2
    lit.set("turbidity", None)
    assert lit.held == []
    assert lit.taken() == []


def test_a_drag_shows_air_that_it_passes(lit: SkyOnBus) -> None:
    """The air that is being solved is shown, then the latest: a drag that never rests would show
    none if each move gave up the one before."""
    lit.taken()
    lit.holding = True
    for turbidity in (4.0, 6.0, 9.0):
        lit.set("turbidity", turbidity)
    lit.finish()
    passed, *_, last = blue(lit)
    lit.holding = False
    lit.set("turbidity", 4.0)
    assert passed in blue(lit)
    assert passed != last


def test_where_a_sky_is_computed_is_no_new_air(lit: SkyOnBus) -> None:
    """The device changes no light: nothing is solved again."""
    lit.set("cube_device", "gpu")
    assert lit.counters.done["preparation"] == 1


def test_an_impossible_atmosphere_is_refused_once(lit: SkyOnBus) -> None:
    """One sentence; the sky stays, and a moved sun does not repeat the complaint."""
    lit.sun(30.0, ground_m=1.3e5)
    lit.sun(50.0, ground_m=1.3e5)
    (said,) = lit.faults
    assert "no such atmosphere: a ground at 130000 m lies outside" in said
    lit.sun(50.0)
    assert len(blue(lit)) == 2


def test_what_was_refused_is_refused_again(lit: SkyOnBus) -> None:
    """After a good atmosphere in between; or the settings would say what is not shown."""
    lit.sun(30.0, ground_m=30_000.0)
    for _ in range(2):
        lit.set("top_altitude_m", 40_000.0)
        lit.set("top_altitude_m", 20_000.0)
    assert len(lit.faults) == 2
    assert all("no such atmosphere" in said for said in lit.faults)


def test_a_job_that_fails_leaves_the_sky(lit: SkyOnBus) -> None:
    """The kernel tells the fault; the module goes on with what it has and does not try again."""
    lit.holding = True
    lit.set("turbidity", 9.0)
    lit.tell(JobResult(module="bruneton_sky", job="solve", error="out of memory"))
    lit.sun(50.0)
    assert lit.held == []
    assert len(blue(lit)) == 2


def test_the_eye_of_the_view_that_is_shown_counts(sky: SkyOnBus) -> None:
    """A camera is followed where no scene manager tells of the eye, and only there."""
    sky.want(BackgroundChanged, size=16)
    sky.sun(30.0)
    sky.tell(EnableModule(module="sun_and_eye", enabled=False))
    aloft = MoveCamera(eye_m=(0.0, 24_000.0, 0.0), target_m=(0.0, 24_000.0, -1.0))
    sky.tell(aloft)
    assert [m.ground_through_air for m in sky.taken()] == [False, True]  # type: ignore[attr-defined]
    sky.tell(EnableModule(module="sun_and_eye"))
    sky.sun(30.0)
    sky.eye(2.0)
    sky.tell(EnableModule(module="sun_and_eye", enabled=False), aloft)
    assert not sky.last(BackgroundChanged).ground_through_air


def test_the_eye_takes_the_observer_along(by_day: SkyOnBus) -> None:
    """From 10 km the sky darkens; the light on the scene, which stays below, does not change: it
    is neither made nor posted again, and the counters count that."""
    for height_m in (10_000.0, 20_000.0, 0.0):
        by_day.eye(height_m)
    posted = by_day.taken()
    backgrounds = [m for m in posted if isinstance(m, BackgroundChanged)]
    zenith = [
        decode_float16(m.cube.values, m.radiance_scale)[2, 8, 8, 2]  # type: ignore[union-attr]
        for m in backgrounds
    ]
    assert zenith[1] < 0.7 * zenith[0]
    assert zenith[2] < 0.7 * zenith[1]
    assert zenith[3] == zenith[0]
    assert len({m.ground_radiance_rgb for m in backgrounds}) == 1
    for kind in (KeyLightChanged, AmbientChanged):
        assert sum(isinstance(m, kind) for m in posted) == 1
    assert by_day.counters.skipped["light on the scene: only the observer moved"] == 3


def test_light_does_not_depend_on_the_observer() -> None:
    """Under one sun an observer aloft lights the scene as one on the ground does: within 0.2 %,
    what the small table that is made aloft adds to the error of the large one. The sun itself is
    seen through less air, lower or higher by arc minutes."""
    lights = []
    for height_m in (0.0, 5_000.0, 4e5):
        sky = SkyOnBus(BrunetonSky)
        sky.eye(height_m)
        sky.want(KeyLightChanged, AmbientChanged)
        sky.sun(30.0)
        lights.append((sky.last(KeyLightChanged), sky.last(AmbientChanged)))
    sun, ambient = lights[0]
    for other_sun, other_ambient in lights[1:]:
        assert other_sun.irradiance_rgb == sun.irradiance_rgb
        np.testing.assert_allclose(other_sun.direction, sun.direction, atol=np.radians(0.02))
        ours = other_ambient.irradiance_sh_rgb.values
        theirs = ambient.irradiance_sh_rgb.values
        np.testing.assert_allclose(ours, theirs, atol=2e-3 * np.abs(theirs).max())


def test_a_walk_and_a_second_of_time_are_unseen(by_day: SkyOnBus) -> None:
    """Moves too small to be seen cause no work, and the counters count them."""
    by_day.taken()
    by_day.eye(1.7)
    by_day.sun(30.004)
    assert by_day.taken() == []
    assert by_day.counters.skipped["sun or eye moved unseen"] >= 2


def test_night_is_finite_and_dark(sky: SkyOnBus) -> None:
    """Deep in the planet's shadow less is left than starlight, 1e-6 W m^-2 sr^-1."""
    sky.want(*LIGHT, size=16)
    sky.sun(-60.0)
    background, light, ambient = sky.taken()
    radiance = decode_float16(background.cube.values, background.radiance_scale)  # type: ignore[attr-defined]
    assert np.isfinite(radiance).all()
    assert radiance.max() < 1e-7
    assert light.irradiance_rgb == (0.0, 0.0, 0.0)  # type: ignore[attr-defined]
    assert np.abs(ambient.irradiance_sh_rgb.values).max() < 1e-6  # type: ignore[attr-defined]


def test_the_gpu_makes_the_cube_map() -> None:
    """A job of 256 texels unless a size is asked for; nothing is read back, and the ground is
    known at once."""
    sky = SkyOnBus(BrunetonSky, cube_device="gpu")
    sky.want(GpuJob)
    sky.want(BackgroundChanged)
    sky.sun(30.0)
    (job,) = sky.taken()
    assert isinstance(job, GpuJob)
    assert (job.size, job.read_back) == (256, False)
    sky.answer(job)
    assert min(sky.last(BackgroundChanged).ground_radiance_rgb) > 0.0


def test_settings_make_the_atmosphere() -> None:
    """Default haze is AOD(550) 0.20, under the host's one solar spectrum; each setting counts."""
    air = atmosphere_of(BrunetonSkySettings())
    depth = air.aerosol_depth()
    assert np.interp(550.0, air.wavelength_nm[::-1], depth[::-1]) == pytest.approx(0.2009, abs=6e-3)
    assert air.solar_irradiance == pytest.approx(solar_irradiance(air.wavelength_nm))
    other = atmosphere_of(BrunetonSkySettings(turbidity=1.0, albedo=0.4, ozone_du=0.0, mie_g=0.5))
    assert set(other.ground_albedo) == {0.4}
    assert not any(other.absorption_extinction)
    assert other.mie_g == 0.5
    assert other.aerosol_depth()[1] == pytest.approx(0.0, abs=1e-3)


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
    depth = {
        kind.name: kind.scattering * (kind.density(middle).sum() * thickness)
        for kind in air.scatterers()
    }
    return [depth.pop("molecules"), np.sum(list(depth.values()), axis=0)]


def test_ozone_is_measured_in_dobson_units() -> None:
    """The standard 300 DU are the preset's own ozone; Mars can be given some."""
    earth = atmosphere_of(BrunetonSkySettings())
    assert atmosphere_of(BrunetonSkySettings(ozone_du=300.0)) == earth
    mars = atmosphere_of(BrunetonSkySettings(preset="mars-like", ozone_du=300.0))
    assert mars.absorption_extinction == earth.absorption_extinction
