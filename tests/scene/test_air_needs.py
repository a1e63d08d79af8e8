"""The reach of air that a view needs, and the demand for air."""

import numpy as np
import pytest
import trimesh
from air.module import DrawnAir
from air_stage import volume_of

from vrut_lite.atmosphere.planet import GROUND_RADIUS_M
from vrut_lite.kernel.bus import Kernel
from vrut_lite.kernel.messages import ChooseSlot, EnableModule, SetSetting
from vrut_lite.kernel.module import Manifest, Module, handles
from vrut_lite.messages.air import AirChanged
from vrut_lite.messages.camera import MoveCamera
from vrut_lite.messages.picture import Resize
from vrut_lite.messages.scene import LoadScene, SceneNeeds
from vrut_lite.scene.manager import SceneManager
from vrut_lite.scene.needs import air_reach_m

LOWER, UPPER = (-3.0, 0.0, -4.0), (3.0, 5.0, 4.0)


def reach(eye, target, lower=LOWER, upper=UPPER, field_of_view_rad=0.8):
    camera = MoveCamera(
        eye_m=tuple(map(float, eye)),
        target_m=tuple(map(float, target)),
        vertical_field_of_view_rad=field_of_view_rad,
    )
    return air_reach_m(camera, 1.5, lower, upper, 0.0)


def horizon_m(height_m):
    return np.sqrt(height_m * (2 * GROUND_RADIUS_M + height_m))


@pytest.mark.parametrize("height_m", [0.1, 1.7, 100.0, 3e3, 1e5, 1e7])
def test_with_the_horizon_in_view_it_reaches_there(height_m):
    """sqrt(h (2 R + h)): 4.65 km for a person, 3,700 km for a satellite."""
    far = horizon_m(height_m)
    down = -np.arcsin(far / (GROUND_RADIUS_M + height_m))
    level = reach((0, height_m, 50), (0, height_m + np.tan(down + 1e-3), 49))
    # The scene itself is within 60 m.
    assert far * (1 - 1e-9) <= level <= max(far * (1 + 1e-9), 60.0)


def test_from_above_it_reaches_to_the_farthest_corner():
    """A table seen from 3 m above needs no air to the horizon: ground and corners are near."""
    assert reach((0, 8, 0), (0.1, 0, 0), field_of_view_rad=0.5) == pytest.approx(
        np.linalg.norm([3, 8, 4])
    )


def test_into_the_sky_alone_it_does_not_reach():
    """With neither scene nor ground in view no air is needed."""
    assert reach((0, 30, 0), (0, 60, -10)) == 0.0


def test_a_far_scene_counts_when_it_is_in_view():
    """A mountain beyond the horizon counts if it is in view, and not behind the camera."""
    lower, upper = (-1e3, 0.0, -51e3), (1e3, 2e3, -49e3)
    ahead = reach((0, 1.7, 0), (0, 2, -10), lower, upper)
    assert ahead == pytest.approx(np.linalg.norm([1e3, 2e3 - 1.7, 51e3]))
    assert reach((0, 1.7, 0), (0, 2, 10), lower, upper) == pytest.approx(horizon_m(1.7))


def test_it_grows_without_a_step_as_the_view_is_raised():
    """As the view rises from steeply down to the horizon the reach grows smoothly, then stays."""
    angles = np.linspace(-1.3, 0.3, 3000)
    found = [reach((0, 50, 0), (0, 50 + np.tan(a), -1)) for a in angles]
    assert np.all(np.diff(found) >= -1e-6)
    assert found[-1] == pytest.approx(horizon_m(50.0))


class Sky(Module):
    """Posts air when somebody wants it and the needs change."""

    manifest = Manifest(name="sky", title="Sky", version="1", provides=("sky",))

    @handles(SceneNeeds)
    def on_needs(self, message: SceneNeeds) -> None:
        if self.link.wanted(AirChanged) and self.link.holds("sky"):
            self.link.post(AirChanged(volume=volume_of(0.0, 0.0), source=self.manifest.name))


class OtherSky(Sky):
    """A sky without air."""

    manifest = Manifest(name="other_sky", title="Other sky", version="1", provides=("sky",))

    @handles(SceneNeeds)
    def on_needs(self, message: SceneNeeds) -> None:
        """Nothing to say."""


@pytest.fixture
def stage(tmp_path):
    """A kernel with a sky and an open scene; the scene manager."""
    kernel = Kernel()
    for module in (DrawnAir, Sky, OtherSky):
        kernel.add_module(module)
    kernel.add_module(SceneManager)
    path = tmp_path / "box.glb"
    trimesh.creation.box((2, 4, 2)).export(path)
    play(kernel, ChooseSlot(slot="sky", module="sky"), LoadScene(path=str(path)))
    yield kernel, kernel.seats["scene"].module
    kernel.close()


def play(kernel, *inputs):
    for message in inputs:
        kernel.inject(message)
        kernel.pump_until_idle()


def test_air_is_asked_for_and_handed_on(stage):
    """With a scene open the manager demands it, says how far it reaches and keeps it."""
    kernel, scene = stage
    assert kernel.wanted(AirChanged) is not None
    assert kernel.last(SceneNeeds).air_reach_m > 1000.0
    assert scene.state.shown(AirChanged) is kernel.last(AirChanged)


@pytest.mark.parametrize("by", ["setting", "module"])
def test_switched_off_air_is_not_demanded(stage, by):
    """By the scene's setting, which the counters count, or with the module: no demand, no reach, no
    air in the state; on again all return."""
    kernel, scene = stage
    for wanted in (False, True):
        setting = SetSetting(module="scene", name="air", value=wanted)
        play(kernel, setting if by == "setting" else EnableModule(module="air", enabled=wanted))
        play(kernel, Resize(width_px=64, height_px=32))
        assert (kernel.wanted(AirChanged) is not None) is wanted
        assert (kernel.last(SceneNeeds).air_reach_m > 0.0) is wanted
        assert (scene.state.shown(AirChanged) is not None) is wanted
    assert scene.counters.skipped["air: switched off"] == (2 if by == "setting" else 0)


def test_another_sky_does_not_inherit_the_air(stage):
    """A sky that makes none must not be seen through the air of the last."""
    kernel, scene = stage
    play(kernel, ChooseSlot(slot="sky", module="other_sky"))
    assert scene.state.shown(AirChanged) is None


def test_light_shafts_are_handed_on(stage):
    """Off until someone wants them."""
    kernel, scene = stage
    assert not scene.state.light_shafts
    play(kernel, SetSetting(module="scene", name="light_shafts", value=True))
    assert scene.state.light_shafts
