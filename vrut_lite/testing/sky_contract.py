"""The contract of every sky on the bus: tests for authors.

    class TestMySky(SkyContract):
        module_type = MySky

In a file that pytest collects, this runs each test below with `MySky` on a real kernel.
"""

import io
import math
from collections.abc import Iterator
from typing import Any, ClassVar

import numpy as np
import pytest

from vrut_lite.array import Array
from vrut_lite.geometry.cube_map import texel_directions, texel_solid_angles
from vrut_lite.geometry.encoding import decode_float16
from vrut_lite.geometry.spherical_harmonics import evaluate_irradiance
from vrut_lite.kernel.bus import Kernel
from vrut_lite.kernel.messages import ChooseSlot, Demand
from vrut_lite.kernel.module import Module
from vrut_lite.messages.air import AirChanged
from vrut_lite.messages.camera import MoveCamera
from vrut_lite.messages.gpu_job import GpuJob, GpuTexture
from vrut_lite.messages.place import SetPlace
from vrut_lite.messages.sky import (
    AmbientChanged,
    BackgroundChanged,
    LookAlong,
    SkyPolarisationChanged,
    SkyRadianceChanged,
    SpectrumSeen,
)
from vrut_lite.messages.sun import KeyLightChanged, SunMoved
from vrut_lite.messages.tolerance import DEFAULT_TOLERANCE, SetTolerance
from vrut_lite.numeric_types import FloatArray
from vrut_lite.recording.journal_reader import Journal
from vrut_lite.recording.recorder import Recorder
from vrut_lite.recording.replay import Replay
from vrut_lite.recording.replay_runner import ReplayRunner
from vrut_lite.sky.sky_module import PRODUCTS, SkyModule
from vrut_lite.testing.sky_on_bus import SkyOnBus, SunAndEye

LIGHT = (BackgroundChanged, KeyLightChanged, AmbientChanged)
SIZE = 32
# Deep night, twilight, the horizon, noon, zenith; and azimuths on both sides of the date line.
SUNS = ((-40.0, 0.0), (-6.0, 180.0), (-0.2, -180.0), (0.0, 90.0), (0.3, 0.0), (35.0, 180.0),
        (90.0, 0.0))  # fmt: skip


class SkyContract:
    """Tests of one sky; `settings` are those that it is tested with."""

    module_type: ClassVar[type[SkyModule]]
    settings: ClassVar[dict[str, Any]] = {}

    @pytest.fixture
    def sky(self) -> Iterator[SkyOnBus]:
        """The sky on a kernel; every fault fails the test."""
        sky = SkyOnBus(self.module_type, **self.settings)
        yield sky
        sky.kernel.close()
        assert sky.faults == []

    @pytest.fixture
    def by_day(self, sky: SkyOnBus) -> SkyOnBus:
        """Light is wanted, and the sun stands at 35 degrees."""
        sky.want(*LIGHT, size=SIZE)
        sky.sun(35.0, 120.0)
        return sky

    def test_a_sky_without_a_sun_requires_one(self) -> None:
        """It gets its slot after the sun's, and safe mode does not keep it alone."""
        manifest = self.module_type.manifest
        assert "sun" in (*manifest.provides, *manifest.requires)

    # --- posted messages and their time --------------------------------------------------

    def test_posts_only_what_is_wanted(self, sky: SkyOnBus) -> None:
        """Without demand the sky posts nothing; with one demand it posts that message alone."""
        sky.sun(30.0)
        assert sky.taken() == []
        for kind in LIGHT:
            sky.want(kind, size=SIZE)
            assert sky.kinds_taken() == [kind]
            sky.want_no_more(kind)

    def test_posts_nothing_while_another_sky_is_shown(self, by_day: SkyOnBus) -> None:
        """Without the slot the sky computes nothing."""
        by_day.lose_slot()
        by_day.taken()
        done = by_day.counters.done.copy()
        by_day.sun(50.0)
        assert by_day.taken() == []
        assert by_day.counters.done == done

    def test_posts_all_again_when_the_slot_returns(self, by_day: SkyOnBus) -> None:
        """Another sky was shown in between: equal light is posted again."""
        before = by_day.taken()
        by_day.lose_slot()
        by_day.regain_slot()
        assert by_day.taken() == before

    def test_unchanged_inputs_post_nothing(self, by_day: SkyOnBus) -> None:
        """The same sun, demand or tolerance again posts nothing."""
        by_day.taken()
        by_day.sun(35.0, 120.0)
        by_day.tell(SetTolerance(tolerance=DEFAULT_TOLERANCE))
        by_day.want(*LIGHT, size=SIZE)
        by_day.want(SunMoved)
        assert by_day.taken() == []

    def test_a_moved_sun_posts_all_light(self, by_day: SkyOnBus) -> None:
        """Ten degrees later background, key light and ambient light are new, each once."""
        by_day.taken()
        by_day.sun(45.0, 120.0)
        assert by_day.kinds_taken() == list(LIGHT)

    def test_the_size_is_the_consumers_or_the_skys(self, sky: SkyOnBus) -> None:
        """A named size is obeyed; without one the sky chooses, and not a few texels."""
        sky.sun(30.0)
        for size in (24, 48):
            sky.want(BackgroundChanged, size=size)
            assert sky.last(BackgroundChanged).cube.shape == (6, size, size, 3)  # type: ignore[union-attr]
        sky.want(BackgroundChanged)
        assert sky.last(BackgroundChanged).cube.shape[1] >= 64  # type: ignore[union-attr]

    # --- the tolerance -------------------------------------------------------------------

    def test_a_tighter_tolerance_makes_a_larger_cube(self, sky: SkyOnBus) -> None:
        """Sizes follow the tolerance, but for a size that a consumer names."""
        sky.sun(30.0)
        sky.want(BackgroundChanged)
        sizes = []
        for tolerance in (1.0, 0.1, 0.05):
            sky.tell(SetTolerance(tolerance=tolerance))
            sizes.append(sky.last(BackgroundChanged).cube.shape[1])  # type: ignore[union-attr]
        assert sizes == sorted(sizes)
        assert sizes[0] < sizes[-1]
        sky.want(BackgroundChanged, size=SIZE)
        sky.tell(SetTolerance(tolerance=1.0))
        assert sky.last(BackgroundChanged).cube.shape[1] == SIZE  # type: ignore[union-attr]

    def test_unseen_moves_stay_within_the_tolerance(self, by_day: SkyOnBus) -> None:
        """While the sun creeps, the shown sky equals the present sun's sky within the tolerance."""
        fresh = SkyOnBus(self.module_type, **self.settings)
        fresh.want(*LIGHT, size=SIZE)
        for step in range(1, 9):
            azimuth_deg = 120.0 + 0.01 * step
            by_day.sun(35.0, azimuth_deg)
            fresh.sun(-20.0)
            fresh.sun(35.0, azimuth_deg)
            shown, exact = cube_of(by_day), cube_of(fresh)
            allowed = DEFAULT_TOLERANCE * np.maximum(exact, 0.01 * exact.max())
            assert np.all(np.abs(shown - exact) <= allowed)

    # --- light that makes sense ----------------------------------------------------------

    @pytest.mark.parametrize(("elevation_deg", "azimuth_deg"), SUNS)
    def test_light_is_finite_and_positive(
        self, sky: SkyOnBus, elevation_deg: float, azimuth_deg: float
    ) -> None:
        """At night, at the horizon, at the zenith and at the date line; night has no sun."""
        sky.want(*LIGHT, size=SIZE)
        sky.sun(elevation_deg, azimuth_deg)
        cube, light = cube_of(sky), sky.last(KeyLightChanged)
        assert np.isfinite(cube).all()
        assert cube.min() >= 0.0
        assert min(light.irradiance_rgb) >= 0.0
        assert light.direction == sky.last(SunMoved).direction
        assert np.isfinite(sky.last(AmbientChanged).irradiance_sh_rgb.values).all()
        if elevation_deg < -1.0:
            assert light.irradiance_rgb == (0.0, 0.0, 0.0)

    def test_a_full_turn_is_no_turn(self, sky: SkyOnBus) -> None:
        """The sun at 180 and at -180 degrees makes one sky."""
        sky.want(*LIGHT, size=SIZE)
        cubes = []
        for azimuth_deg in (180.0, 0.0, -180.0):
            sky.sun(30.0, azimuth_deg)
            cubes.append(cube_of(sky))
        np.testing.assert_allclose(cubes[0], cubes[2], rtol=2e-3)

    def test_the_sky_turns_with_the_sun(self, sky: SkyOnBus) -> None:
        """Sun in the east or in the north: a quarter turn of the same sky, to a percent."""
        sky.want(*LIGHT, size=SIZE)
        faces = []
        # North is the face -Z, east +X.
        for azimuth_deg, face in ((0.0, 5), (90.0, 0)):
            sky.sun(30.0, azimuth_deg)
            faces.append(cube_of(sky)[face])
        north, east = faces
        np.testing.assert_allclose(east, north, rtol=0.01, atol=0.01 * north.max())

    def test_below_the_horizon_is_the_ground(self, by_day: SkyOnBus) -> None:
        """The lower half holds the ground's radiance: at most all of the light on it."""
        background, cube = by_day.last(BackgroundChanged), cube_of(by_day)
        ground = np.array(background.ground_radiance_rgb)
        if not background.ground_through_air:
            below = cube[texel_directions(SIZE)[..., 1] < 0.0]
            np.testing.assert_allclose(below, np.broadcast_to(ground, below.shape), rtol=2e-3)
        light = by_day.last(KeyLightChanged)
        falls = np.array(light.irradiance_rgb) * light.direction[1] + irradiance(cube, UP)
        assert np.all(ground * math.pi <= 1.02 * falls)

    def test_ambient_light_is_that_of_the_cube(self, sky: SkyOnBus) -> None:
        """Harmonics against a sum over all texels: 4 % of the largest irradiance at most."""
        sky.want(*LIGHT, size=64)
        for elevation_deg in (35.0, 8.0):
            sky.sun(elevation_deg, 120.0)
            cube = cube_of(sky)
            exact = np.array([irradiance(cube, normal) for normal in NORMALS])
            harmonics = sky.last(AmbientChanged).irradiance_sh_rgb.values
            error = np.abs(evaluate_irradiance(harmonics, NORMALS) - exact)
            assert error.max() <= 0.04 * exact.max()

    def test_radiance_on_the_ground_is_what_lights_the_scene(self, sky: SkyOnBus) -> None:
        """Its irradiance is the ambient light's, and an eye that rises does not change it."""
        sky.want(AmbientChanged, SkyRadianceChanged, size=64)
        sky.sun(35.0, 120.0)
        ground = sky.last(SkyRadianceChanged)
        ground.check_arrays()
        cube = decode_float16(ground.cube.values, ground.radiance_scale).astype(float)
        exact = np.array([irradiance(cube, normal) for normal in NORMALS])
        harmonics = sky.last(AmbientChanged).irradiance_sh_rgb.values
        error = np.abs(evaluate_irradiance(harmonics, NORMALS) - exact)
        assert error.max() <= 0.04 * exact.max()
        sky.taken()
        sky.eye(9000.0)
        assert sky.taken() == []

    def test_polarisation_is_no_more_than_the_light(self, sky: SkyOnBus) -> None:
        """Where the sky knows it, under any sun: at most the radiance, to 1 % of the brightest
        texel, and none below the horizon."""
        sky.want(BackgroundChanged, SkyPolarisationChanged, size=SIZE)
        for sun in SUNS:
            sky.sun(*sun)
            found = sky.last(SkyPolarisationChanged)
            found.check_arrays()
            if found.cube is not None:
                cube, light = found.cube.values.astype(float) * found.radiance_scale, cube_of(sky)
                assert not cube[:, texel_directions(SIZE)[..., 1] < 0.0].any()
                assert np.all(np.hypot(*cube) <= light + 0.01 * light.max())

    # --- air and spectrum ----------------------------------------------------------------

    def test_air_is_posted_where_things_stand_in_it(self, sky: SkyOnBus) -> None:
        """No air before a scene has surfaces; then one valid volume or none."""
        sky.sun(30.0)
        sky.want(AirChanged)
        assert sky.taken() == []
        sky.eye(2.0, reach_m=20_000.0)
        (air,) = sky.taken()
        air.check()
        air.check_arrays()
        sky.eye(2.0, reach_m=19_900.0)
        assert sky.taken() == []

    def test_a_spectrum_answers_every_question_once(self, by_day: SkyOnBus) -> None:
        """As many values as wavelengths, none of them negative; the ground has none."""
        by_day.taken()
        for height in (1.0, -1.0):
            by_day.tell(LookAlong(direction=(0.0, height, 0.0)))
            (seen,) = by_day.taken()
            assert isinstance(seen, SpectrumSeen)
            assert seen.direction == (0.0, height, 0.0)
            assert len(seen.radiance) == len(seen.wavelength_nm)
            assert min(seen.radiance, default=0.0) >= 0.0
            assert height > 0.0 or seen.radiance == ()

    # --- the GPU -------------------------------------------------------------------------

    @pytest.fixture
    def on_gpu(self) -> Iterator[SkyOnBus]:
        """A kernel whose GPU a test plays; the sun stands at 30 degrees."""
        if "cube_device" not in self.module_type.settings_type.__struct_fields__:
            pytest.skip("this sky has no setting cube_device")
        sky = SkyOnBus(self.module_type, cube_device="gpu", **self.settings)
        sky.want(GpuJob)
        sky.want(BackgroundChanged, size=SIZE)
        sky.sun(30.0)
        yield sky
        sky.kernel.close()

    def test_the_gpus_texture_is_posted(self, on_gpu: SkyOnBus) -> None:
        """The job first, and with its texture the background; a late texture is not shown."""
        (job,) = on_gpu.taken()
        assert isinstance(job, GpuJob)
        on_gpu.sun(50.0)
        (newer,) = on_gpu.taken()
        assert isinstance(newer, GpuJob)
        on_gpu.answer(newer)
        (background,) = on_gpu.taken()
        assert isinstance(background, BackgroundChanged)
        assert isinstance(background.cube, GpuTexture)
        assert background.cube.recipe == newer.recipe
        on_gpu.answer(job)
        assert on_gpu.taken() == []
        assert on_gpu.faults == []

    def test_radiance_on_the_ground_is_the_cpus(self, on_gpu: SkyOnBus) -> None:
        """Consumers of light get an array, wherever the background is made."""
        on_gpu.taken()
        on_gpu.want(SkyRadianceChanged, size=SIZE)
        (ground,) = on_gpu.taken()
        assert isinstance(ground, SkyRadianceChanged)
        assert ground.cube.shape == (6, SIZE, SIZE, 3)

    def test_the_cpu_serves_when_the_gpu_fails(self, on_gpu: SkyOnBus) -> None:
        """One sentence names the setting to change; this sky and the next are the CPU's."""
        (job,) = on_gpu.taken()
        assert isinstance(job, GpuJob)
        on_gpu.answer(job, error="out of memory")
        assert on_gpu.faults == [
            "the GPU could not make the sky (out of memory): set cube_device to cpu"
        ]
        on_gpu.sun(50.0)
        cubes = [m.cube for m in on_gpu.taken() if isinstance(m, BackgroundChanged)]
        assert [type(cube) for cube in cubes] == [Array, Array]

    def test_the_cpu_serves_where_nobody_runs_gpu_jobs(self, on_gpu: SkyOnBus) -> None:
        """As in a kernel without OpenGL."""
        on_gpu.taken()
        on_gpu.want_no_more(GpuJob)
        assert on_gpu.kinds_taken() == [BackgroundChanged]
        assert isinstance(on_gpu.last(BackgroundChanged).cube, Array)

    # --- replay --------------------------------------------------------------------------

    def test_a_recorded_session_replays(self, tmp_path: Any) -> None:
        """The same inputs give the same messages, in the same order."""
        known: list[type[Module]] = [SunAndEye, self.module_type]
        kernel, stream = Kernel(runner=ReplayRunner()), io.BytesIO()
        for module in known:
            kernel.add_module(module)
        recorder = Recorder(kernel, stream)
        demands = [Demand(consumer="test", message=k.__name__, size=8) for k in PRODUCTS]
        suns = [SetPlace(latitude_deg=e, longitude_deg=0.0) for e in (30.0, 40.0, -3.0, 40.0)]
        eye = MoveCamera(eye_m=(0.0, 2.0, 0.0), target_m=(0.0, 2.0, -5000.0))
        chosen = ChooseSlot(slot="sky", module=self.module_type.manifest.name)
        for message in (chosen, *demands, *suns, eye, LookAlong(direction=(0.0, 1.0, 0.0))):
            kernel.inject(message)
            kernel.pump_until_idle()
        recorder.close()
        kernel.close()
        path = tmp_path / "session.mcap"
        path.write_bytes(stream.getvalue())
        outcome = Replay(Journal(path), known).run()
        assert outcome.difference is None
        assert outcome.messages > len(demands)


UP = np.array([0.0, 1.0, 0.0])
NORMALS = np.concatenate([np.eye(3), -np.eye(3), np.array([[0.6, 0.0, 0.8], [0.0, 0.6, -0.8]])])


def cube_of(sky: SkyOnBus) -> FloatArray:
    """Radiance (6, size, size, 3) of the background that was posted last."""
    background = sky.last(BackgroundChanged)
    assert isinstance(background.cube, Array)
    return decode_float16(background.cube.values, background.radiance_scale).astype(float)


def irradiance(cube: FloatArray, normal: FloatArray) -> FloatArray:
    """Irradiance (3,) of a plane by every texel of a cube map."""
    size = cube.shape[1]
    weight = np.maximum(texel_directions(size) @ normal, 0.0)
    return np.einsum("fij,fijc->c", weight * texel_solid_angles(size), cube)
