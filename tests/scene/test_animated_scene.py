"""Animations in the host: at rest, at a time, by the clock; and on the command line."""

import sys
from datetime import UTC, datetime, timedelta

import numpy as np
import pytest
from loaded_scenes import add_array

from vrut_lite import cli
from vrut_lite.kernel.bus import Kernel
from vrut_lite.kernel.messages import SetClock, SetSetting
from vrut_lite.messages.camera import MoveCamera
from vrut_lite.messages.place import SetPlace
from vrut_lite.messages.scene import LoadScene, SceneOpened
from vrut_lite.project import Project, load_project, save_project, view_inputs
from vrut_lite.scene.backend import SceneView
from vrut_lite.scene.manager import SceneManager

MIDNIGHT = datetime(2026, 6, 20, 22, tzinfo=UTC)  # In Prague.


@pytest.fixture
def sliding(write_square):
    """A square that slides."""
    return str(write_square(slide))


def slide(document):
    """Let the first node slide by 1 m a second for ten seconds."""
    times = np.array([0, 10], "<f4")
    values = np.array([[0, 0, 0], [10, 0, 0]], "<f4")
    sampler = {"input": add_array(document, times), "output": add_array(document, values)}
    channel = {"sampler": 0, "target": {"node": 0, "path": "translation"}}
    document["animations"] = [{"channels": [channel], "samplers": [sampler]}]


@pytest.fixture
def stage(sliding):
    kernel = Kernel()
    view = SceneView()
    kernel.add_module(SceneManager, view=view)
    opened = []

    def note(message, sender):
        if isinstance(message, SceneOpened):
            opened.append(message)

    kernel.tap(note)

    def play(*inputs):
        before = len(opened)
        for message in inputs:
            kernel.inject(message)
            kernel.pump_until_idle()
        return [message.lower_m[0] for message in opened[before:]]

    return play, view, sliding


def _set(name, value):
    return SetSetting(module="scene", name=name, value=value)


def test_an_animation_rests_until_it_is_played(stage):
    """At rest the scene is told once, whatever the clock does; at a time it is told anew."""
    play, view, path = stage
    assert play(LoadScene(path=path), SetClock(instant=MIDNIGHT)) == [0.0]
    assert play(_set("animation_time_s", 2.5)) == []
    assert play(_set("animation", "time")) == [2.5]
    assert play(_set("animation_time_s", 13.0)) == [3.0]
    assert view.state.scene.lower_m[0] == 3.0
    assert play(_set("animation", "rest")) == [0.0]


def test_an_animation_follows_the_clock_of_the_place(stage):
    """A second of the day is one of the animation, from midnight there; the camera stays."""
    play, view, path = stage
    place = SetPlace(latitude_deg=50.0755, longitude_deg=14.4378)
    camera = MoveCamera(eye_m=(0.0, 1.0, 9.0), target_m=(0.0, 0.0, 0.0))
    play(
        place, SetClock(instant=MIDNIGHT), _set("animation", "clock"), LoadScene(path=path), camera
    )
    found = play(*(SetClock(instant=MIDNIGHT + timedelta(seconds=s)) for s in (1, 4, 24)))
    np.testing.assert_allclose(found, [1, 4, 4], atol=1e-6)
    assert view.state.moved_camera == camera


def test_ground_and_framing_stay_while_things_move(stage):
    """A rising scene moves neither the ground disc nor the camera."""
    play, view, path = stage
    play(LoadScene(path=path))
    ground, camera = view.state.scene.ground, view.state.camera
    play(_set("animation", "time"), _set("animation_time_s", 5.0))
    assert view.state.scene.lower_m[0] == 5.0
    assert (view.state.scene.ground, view.state.camera) == (ground, camera)


def test_who_looks_through_an_animated_camera_moves_with_it(stage, write_square):
    """The scene's own camera follows the clock until the user moves away from it."""
    play, view, _ = stage

    def edit(document):
        slide(document)
        document["cameras"] = [{"type": "perspective", "perspective": {"yfov": 1.0, "znear": 0.1}}]
        document["nodes"][0]["camera"] = 0

    play(LoadScene(path=str(write_square(edit))), _set("animation", "time"))
    for time_s in (2.0, 5.0):
        play(_set("animation_time_s", time_s))
        assert view.state.camera.eye_m[0] == time_s
    own = MoveCamera(eye_m=(0.0, 1.0, 9.0), target_m=(0.0, 0.0, 0.0))
    play(own, _set("animation_time_s", 7.0))
    assert view.state.camera == own


def test_a_scene_that_cannot_be_opened_leaves_the_old_one_moving(stage):
    """A camera that is not there refuses the file; the clock goes on moving the scene before it."""
    play, _, path = stage
    play(LoadScene(path=path), _set("animation", "time"))
    assert play(LoadScene(path=path, camera="roof")) == []
    assert play(_set("animation_time_s", 2.0)) == [2.0]


def test_a_scene_without_animations_is_never_told_again(stage, write_square):
    """What does not move costs nothing: neither clock nor setting opens it anew."""
    play, _, _ = stage
    path = str(write_square())
    play(_set("animation", "clock"), LoadScene(path=path))
    assert play(SetClock(instant=MIDNIGHT), _set("animation_time_s", 3.0)) == []


def test_the_project_keeps_the_time_of_the_animation(tmp_path, sliding):
    """A project says how its scene's animations stand."""
    project = Project(scene=sliding, animation="time", animation_time_s=4.0)
    save_project(tmp_path / "a.toml", project)
    again = load_project(tmp_path / "a.toml")
    said = {m.name: m.value for m in view_inputs(again) if isinstance(m, SetSetting)}
    assert (said["animation"], said["animation_time_s"]) == ("time", 4.0)


@pytest.mark.parametrize("wrong", ["soon", "-1", "1e9", "nan"])
def test_an_impossible_time_is_refused(monkeypatch, capsys, sliding, tmp_path, wrong):
    """--animation takes rest, clock or seconds, and says so in one line."""
    arguments = ["record", sliding, "-o", str(tmp_path / "a.mcap"), f"--animation={wrong}"]
    monkeypatch.setattr(sys, "argv", ["vrut-lite", *arguments])
    with pytest.raises(SystemExit) as end:
        cli.main()
    assert end.value.code == 2
    assert "animation" in capsys.readouterr().err
