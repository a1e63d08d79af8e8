"""The scene manager: what it keeps for a picture, and what it asks for."""

from datetime import UTC, datetime

import numpy as np
import pytest
import trimesh
from light_messages import light_messages

from vrut_lite.kernel.bus import Kernel
from vrut_lite.kernel.messages import Fault, SetClock, SetSetting
from vrut_lite.kernel.module import Manifest, Module, handles
from vrut_lite.messages.camera import MoveCamera, frame_bounds, look_at, perspective
from vrut_lite.messages.ground import SetGround
from vrut_lite.messages.picture import Resize, SetExposure
from vrut_lite.messages.scene import LoadScene, SceneNeeds, SceneOpened
from vrut_lite.messages.section import SectionChanged
from vrut_lite.messages.sky import AmbientChanged, BackgroundChanged
from vrut_lite.messages.sun import KeyLightChanged
from vrut_lite.scene.manager import SceneManager
from vrut_lite.scene.needs import visible_faces
from vrut_lite.sky.ground_albedo import ground_albedo

SKY = np.full((6, 8, 8, 3), 4.0)
SKY[3] = 1.5


class Sky(Module):
    """Posts one fixed light when the picture's size is set."""

    manifest = Manifest(name="sky", title="Sky", version="1", provides=("sky",))

    @handles(Resize)
    def on_resize(self, message: Resize) -> None:
        for post in light_messages(SKY, sun_irradiance=(10.0, 9.0, 8.0)):
            self.link.post(post)


@pytest.fixture
def box(tmp_path):
    path = tmp_path / "box.glb"
    trimesh.creation.box((2, 4, 2)).export(path)
    return str(path)


@pytest.fixture
def stage():
    """What a kernel with a scene manager says to inputs, and the scene manager."""
    kernel, heard = Kernel(), []
    kernel.tap(lambda message, sender: heard.append(message))
    kernel.add_module(Sky)
    kernel.add_module(SceneManager)
    kernel.pump()

    def play(*inputs):
        heard.clear()
        for message in inputs:
            kernel.inject(message)
        kernel.pump()
        return heard

    return play, kernel.seats["scene"].module


def only(heard, kind):
    return [message for message in heard if isinstance(message, kind)]


def test_an_opened_scene_has_ground_and_camera(stage, box):
    """One LoadScene: it is told with the ground under it, and looked at."""
    play, scene = stage
    heard = play(LoadScene(path=box))
    (opened,) = only(heard, SceneOpened)
    assert scene.state.scene is opened
    assert opened.triangles == 12
    assert opened.ground.height_m < -2.0
    assert opened.upper_m == (1.0, 2.0, 1.0)
    assert only(heard, SceneNeeds)[-1].receives_light
    assert scene.state.camera.eye_m[1] > opened.ground.height_m


def test_light_is_kept(stage, box):
    """Background, key light and ambient are in the state as they were posted."""
    play, scene = stage
    assert scene.state.missing == ("scene", "background", "key_light", "ambient", "camera")
    heard = play(LoadScene(path=box), Resize(width_px=64, height_px=64))
    assert [scene.state.background] == only(heard, BackgroundChanged)
    assert [scene.state.key_light] == only(heard, KeyLightChanged)
    assert [scene.state.ambient] == only(heard, AmbientChanged)
    assert scene.state.size_px == (64, 64)
    assert scene.state.missing == ()


def test_the_ground_gets_the_albedo_of_the_skys_lower_half(stage, box):
    """pi L / E: sky 4 above, ground 1.5 below, sun 10 overhead: E = 4 pi + 10, both by hand."""
    play, scene = stage
    play(LoadScene(path=box), Resize(width_px=64, height_px=64))
    expected = np.pi * 1.5 / (4 * np.pi + np.array([10.0, 9.0, 8.0]))
    # E comes from 25 harmonics, which miss the edge of the darker nadir by 1 %.
    np.testing.assert_allclose(scene.state.ground_albedo_rgb, expected, rtol=0.015)


def test_without_a_ground_there_is_no_disc(stage, box):
    """Also for a scene that is opened then; another ground lays the disc again."""
    play, scene = stage
    play(LoadScene(path=box))
    disc = scene.state.scene.ground
    assert disc is not None
    assert only(play(SetGround(ground="none")), SceneOpened)[0].ground is None
    assert only(play(LoadScene(path=box)), SceneOpened)[0].ground is None
    assert only(play(SetGround(ground="snow")), SceneOpened)[0].ground == disc
    assert not only(play(SetGround(ground="grass")), SceneOpened)


def test_a_black_night_has_a_black_ground_and_no_nan():
    """Nothing divided by nothing must not reach the picture."""
    albedo = ground_albedo(*light_messages(np.zeros((6, 8, 8, 3))))
    np.testing.assert_array_equal(albedo, 0.0)


def test_a_scene_without_animations_or_a_section_costs_no_work_for_them(stage, box):
    """The clock opens no pose anew, and a plane is told once for each change of it."""
    play, _ = stage
    heard = play(LoadScene(path=box))
    assert only(heard, SectionChanged) == []
    heard = play(SetClock(instant=datetime(2026, 6, 21, 12, tzinfo=UTC)))
    assert only(heard, SceneOpened) == only(heard, SectionChanged) == []

    def told(name, value):
        heard = play(SetSetting(module="scene", name=name, value=value))
        return [message.section for message in only(heard, SectionChanged)]

    assert told("section_at", 0.25) == []
    assert told("section", "y") == [((0.0, 1.0, 0.0), -1.0)]
    assert told("air", False) == []
    assert told("section", "off") == [None]


def test_a_bad_scene_is_told_and_the_old_one_stays(stage, box, tmp_path):
    """A mistyped name must not cost the scene that is open, nor suspend the manager."""
    play, scene = stage
    play(LoadScene(path=box))
    before = scene.state
    for _ in range(4):
        faults = only(play(LoadScene(path=str(tmp_path / "none.glb"))), Fault)
        assert faults[0].for_user
        assert not faults[0].suspended
    assert scene.state is before
    assert only(play(LoadScene(path=box)), SceneOpened)


def test_a_new_scene_brings_its_own_view(stage, box):
    """A camera that was moved in one scene would look at nothing in the next."""
    play, scene = stage
    moved = MoveCamera(eye_m=(9.0, 9.0, 9.0), target_m=(0.0, 0.0, 0.0))
    play(LoadScene(path=box), moved)
    assert scene.state.camera == moved
    play(LoadScene(path=box))
    assert scene.state.camera != moved


def test_the_eye_s_height_is_told_also_of_a_scene_s_own_camera(stage, box):
    """Who computes the sky for the observer's altitude hears of no other camera."""
    play, scene = stage
    heard = play(LoadScene(path=box))
    assert only(heard, SceneNeeds)[-1].eye_height_m == scene.state.camera.eye_m[1]


def test_exposure_is_kept(stage):
    """The manager does not interpret it."""
    play, scene = stage
    wish = SetExposure(mode="manual", ev100=7.0)
    play(wish)
    assert scene.state.exposure == wish


@pytest.mark.parametrize("size", [(1.0, 1.0, 1.0), (30.0, 2.0, 4.0), (0.5, 80.0, 0.5)])
@pytest.mark.parametrize("aspect", [0.5, 1.0, 2.4])
def test_the_framing_camera_holds_the_bounds_and_fills_the_picture(size, aspect):
    """All corners inside the picture, and the outermost beyond 80 % of its half width or height."""
    half = 0.5 * np.array(size)
    camera = frame_bounds(-half, half, aspect)
    signs = np.array(list(np.ndindex(2, 2, 2))) * 2.0 - 1.0
    corners = np.concatenate([signs * half, np.ones((8, 1))], axis=1)
    projection = perspective(camera.vertical_field_of_view_rad, aspect, 0.01)
    clip = corners @ (projection @ look_at(camera.eye_m, camera.target_m)).T
    xy = np.abs(clip[:, :2] / clip[:, 3:])
    assert 0.8 < xy.max() <= 1.0


@pytest.mark.parametrize(
    ("target", "faces", "sky"),
    [
        ((1, 0, 0), {0}, True),
        ((0, 1, 0), {2}, True),
        ((0, -1, 0), {3}, False),
        ((0, 0, -1), {5}, True),
    ],
)
def test_a_narrow_view_needs_one_face(target, faces, sky):
    """A producer that asks first computes only these."""
    camera = MoveCamera(
        eye_m=(0.0,) * 3, target_m=tuple(map(float, target)), vertical_field_of_view_rad=0.3
    )
    assert (set(visible_faces(camera, 1.0)[0]), visible_faces(camera, 1.0)[1]) == (faces, sky)


def test_a_corner_view_needs_three_faces():
    """Along (1, 1, -1) the cube's corner is in the middle of the picture."""
    camera = MoveCamera(eye_m=(0.0,) * 3, target_m=(1.0, 1.0, -1.0))
    assert visible_faces(camera, 1.5)[0] == (0, 2, 5)
