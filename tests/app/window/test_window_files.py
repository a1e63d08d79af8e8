"""Projects saved and opened, and files that are none."""

import msgspec
import pytest
from window_driver import NOON, SCENES

from vrut_lite.kernel.messages import ChooseSlot, Demand, SetClock, SetSetting, SettingChanged
from vrut_lite.messages.camera import MoveCamera
from vrut_lite.messages.haze import DEFAULT_HAZE, SetHaze
from vrut_lite.messages.picture import Resize, SetExposure
from vrut_lite.messages.place import SetPlace
from vrut_lite.messages.scene import LoadScene, SceneNeeds, SceneOpened
from vrut_lite.messages.view_light import StillAsked
from vrut_lite.project import (
    CameraView,
    Exposure,
    Haze,
    Project,
    load_project,
    project_text,
    save_project,
)


@pytest.fixture
def driver(shared_headless_window):
    return shared_headless_window


def test_a_project_survives_its_file(tmp_path):
    """Texts with quotes, none, numbers of any size: what is written is what is read."""
    project = Project(
        scene=str(tmp_path / 'a "scene" \\ of ours.glb'),
        place="-33.87,151.21,40",
        at="2026-06-21T11:00:00+00:00",
        north_offset_deg=-12.5,
        slots={"sky": "bruneton_sky"},
        settings={"bruneton_sky": {"turbidity": None, "orders": 7, "rayleigh_factor": 1e-5}},
        camera=CameraView(eye_m=(1.0, 2.0, 3e6), target_m=(0.0, 0.0, 0.0)),
        exposure=Exposure(mode="manual", ev100=9.25),
        size=(640, 480),
        air=False,
    )
    save_project(tmp_path / "p.toml", project)
    read = load_project(tmp_path / "p.toml")
    expected = {"bruneton_sky": {"turbidity": "none", "orders": 7, "rayleigh_factor": 1e-5}}
    assert read == msgspec.structs.replace(project, settings=expected)


def test_what_the_window_shows_is_saved_and_comes_back(driver, tmp_path):
    """Place, hour, sky, settings, exposure and camera, changed and reopened elsewhere."""
    driver.session.send(
        SetPlace(latitude_deg=-33.87, longitude_deg=151.21, altitude_m=40.0, north_offset_rad=0.5),
        SetClock(instant=NOON),
        ChooseSlot(slot="sky", module="bruneton_sky"),
        SetHaze(optical_depth_550=0.3),
        SetSetting(module="dynamic_skylight", name="turbidity", value=4.5),
        SetSetting(module="scene", name="light_shafts", value=True),
        SetExposure(mode="manual", ev100=12.0),
        MoveCamera(eye_m=(5.0, 6.0, 7.0), target_m=(0.0, 1.0, 0.0)),
    )
    driver.settled()
    driver.window.files.save(str(tmp_path / "kept.toml"))
    assert "Saved" in driver.window.news.text()
    kept = load_project(tmp_path / "kept.toml")
    assert kept.settings == {"dynamic_skylight": {"turbidity": 4.5}}
    assert kept.haze == Haze(0.3)
    assert kept.slots["sky"] == "bruneton_sky"
    assert (kept.exposure.mode, kept.exposure.ev100, kept.light_shafts) == ("manual", 12.0, True)
    assert kept.camera.eye_m == (5.0, 6.0, 7.0)
    assert kept.where() == (-33.87, 151.21, 40.0)
    assert kept.instant() == NOON
    driver.window.files.open_path(str(SCENES / "sundial.toml"))
    driver.until_heard(SettingChanged, lambda m: (m.name, m.value) == ("turbidity", None))
    driver.until_heard(SetHaze, lambda m: m == DEFAULT_HAZE)
    driver.heard.clear()
    driver.window.files.open_path(str(tmp_path / "kept.toml"))
    driver.until_heard(SettingChanged, lambda m: (m.name, m.value) == ("turbidity", 4.5))
    driver.until_heard(SetHaze, lambda m: m.optical_depth_550 == 0.3)
    driver.settled()
    assert driver.project.camera.eye_m == (5.0, 6.0, 7.0)
    assert driver.session.last(SetPlace).altitude_m == 40.0


def test_sensors_of_a_project_survive_the_window(driver, tmp_path):
    """The window shows none, and must not lose them for `vrut-lite daylight`."""
    scene, sensors = SCENES / "sundial.glb", tmp_path / "desks.csv"
    save_project(tmp_path / "p.toml", Project(scene=str(scene), sensors=str(sensors)))
    driver.window.files.open_path(str(tmp_path / "p.toml"))
    driver.settled()
    driver.window.files.save(str(tmp_path / "kept.toml"))
    assert load_project(tmp_path / "kept.toml").sensors == str(sensors)


def test_a_broken_scene_leaves_the_old_one(driver, tmp_path):
    """One line that names the file; scene, title and picture stay, and nothing is waited for."""
    before = driver.session.last(SceneOpened)
    title = driver.window.windowTitle()
    broken = tmp_path / "broken.glb"
    broken.write_bytes(b"glTF but not really")
    driver.window.files.open_path(str(broken))
    driver.until(lambda: bool(driver.problems))
    assert "broken.glb" in driver.window.news.text()
    assert "\n" not in driver.window.news.text()
    assert driver.session.last(SceneOpened) is before
    assert driver.window.windowTitle() == title
    driver.until(lambda: not driver.window.desk.viewport.loading.is_on)
    driver.session.send(LoadScene(path=str(SCENES / "spheres.glb")))
    driver.until_heard(SceneOpened)


def test_a_broken_project_is_told_in_one_line(driver, tmp_path):
    """Invalid TOML, an unknown field or a missing scene leaves the present project unchanged."""
    texts = ("scene = ", "scene = 'a.glb'\nspeed = 3\n", "place = '1,2'\n")
    for number, text in enumerate(texts):
        path = tmp_path / f"broken_{number}.toml"
        path.write_text(text)
        driver.window.files.open_path(str(path))
        assert path.name in driver.window.news.text()
    driver.settled()
    # Docks that come late may change the picture's size: the scene needs other light, another still
    # is asked for, and then the light of its points.
    of_size = {Resize, SceneNeeds, StillAsked, Demand}
    assert {type(message) for message in driver.heard} <= of_size


def test_a_project_with_a_module_that_is_not_there_is_refused_whole(driver, tmp_path):
    """The scene that it names is not opened either."""
    path = tmp_path / "other.toml"
    path.write_text(f"scene = '{SCENES / 'pavilion.gltf'}'\n[settings.no_such_module]\nx = 1\n")
    driver.window.files.open_path(str(path))
    driver.until(lambda: "no_such_module" in driver.window.news.text())
    driver.settled()
    assert not any(isinstance(message, SceneOpened) for message in driver.heard)


def test_the_text_is_for_people_too():
    """A line a value, tables for what belongs together."""
    text = project_text(Project(scene="a.glb", settings={"m": {"x": 1.5}}))
    assert 'scene = "a.glb"\n' in text
    assert "\n[settings.m]\nx = 1.5\n" in text
