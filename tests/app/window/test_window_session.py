"""What was open comes back: the session, the window's shape, the files opened lately."""

import json
import os
from base64 import b64decode, b64encode
from pathlib import Path

import msgspec
import pytest
from click.testing import CliRunner
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from PySide6.QtCore import Qt
from window_driver import NOON, SCENES, HeadlessStage, WindowDriver

from vrut_lite.app.panels.presets import PresetStore
from vrut_lite.app.window.kept import Kept, NamedProject, WindowShape
from vrut_lite.commands.run import run
from vrut_lite.errors import UserError
from vrut_lite.kernel.messages import ClockMoved, EnableModule, SetClock, SetSetting
from vrut_lite.messages.camera import MoveCamera
from vrut_lite.messages.place import SetPlace
from vrut_lite.messages.scene import SceneOpened
from vrut_lite.messages.tolerance import DEFAULT_TOLERANCE, SetTolerance
from vrut_lite.project import Project, load_project, save_project


@pytest.fixture
def open_window(qtbot, tmp_path):
    """A function that opens a window of one and the same user."""
    drivers = []

    def opened():
        drivers.append(WindowDriver(qtbot, HeadlessStage, tmp_path))
        return drivers[-1]

    yield opened
    for driver in drivers:
        driver.close()


@pytest.fixture
def kept(tmp_path):
    return Kept(tmp_path / "kept")


def test_what_was_open_when_the_window_closed_comes_back(open_window, kept):
    """Scene, place, hour, settings, camera, docks: a second window has all of it."""
    first = open_window()
    first.window.docks["modules"].show()
    first.window.docks["export"].hide()
    first.window.files.open_path(str(SCENES / "spheres.glb"))
    first.until_heard(SceneOpened, lambda m: m.path.endswith("spheres.glb"))
    first.session.send(
        SetPlace(latitude_deg=-33.87, longitude_deg=151.21, altitude_m=40.0),
        SetClock(instant=NOON.replace(hour=3)),
        SetSetting(module="clouds", name="base_m", value=900.0),
        SetTolerance(tolerance=0.05),
        MoveCamera(eye_m=(5.0, 6.0, 7.0), target_m=(0.0, 1.0, 0.0)),
    )
    first.settled()
    first.window.close()
    project = kept.session()
    assert project is not None
    second = open_window()
    assert second.window.docks["modules"].isVisible()
    assert second.window.docks["export"].isHidden()
    second.window.files.open_project(project)
    second.until_heard(SceneOpened, lambda m: m.path.endswith("spheres.glb"))
    second.settled()
    assert second.session.last(SetPlace).latitude_deg == -33.87
    assert second.session.last(ClockMoved).instant == NOON.replace(hour=3)
    assert second.panel("module clouds").rows["base_m"].editor.value == 900.0
    assert second.session.last(SetTolerance).tolerance == 0.05
    assert second.project.camera.eye_m == (5.0, 6.0, 7.0)
    second.window.files.open_path(str(SCENES / "sundial.toml"))
    second.until_heard(SetTolerance, lambda m: m.tolerance == DEFAULT_TOLERANCE)


@pytest.mark.parametrize("changes", [True, False])
def test_a_session_keeps_the_name_of_its_project(open_window, kept, tmp_path, changes):
    """Its title says whether the file lacks changes, and saving writes that file."""
    path = tmp_path / "evening.toml"
    save_project(path, Project(scene=str(SCENES / "sundial.glb"), at=NOON.isoformat()))
    first = open_window()
    first.window.files.open_path(str(path))
    first.until_heard(SceneOpened, lambda m: m.path.endswith("sundial.glb"))
    first.settled()
    first.settled()
    if changes:
        first.session.send(SetTolerance(tolerance=0.05))
        first.settled()
    first.window.close_now()
    named = kept.named
    assert named == NamedProject(str(path), changes)
    second = open_window()
    second.window.files.open_named(kept.session(), named)
    second.until_heard(SceneOpened, lambda m: m.path.endswith("sundial.glb"))
    second.settled()
    second.settled()
    second.window.files.unsaved.look()
    assert second.window.windowTitle().startswith("evening.toml[*]")
    assert second.window.isWindowModified() is changes
    second.window.files.save_or_ask()
    assert not second.window.isWindowModified()
    assert load_project(path).tolerance == (0.05 if changes else DEFAULT_TOLERANCE)
    second.window.close_now()
    assert kept.named == NamedProject(str(path), False)
    path.unlink()
    assert kept.named is None


def test_a_window_that_cannot_keep_anything_closes_all_the_same(open_window, tmp_path):
    """A full or read-only disk must not hold a window open."""
    driver = open_window()
    (tmp_path / "file").write_text("")
    driver.window.files.kept = Kept(tmp_path / "file" / "folder")
    driver.window.close()
    assert "cannot make the folder" in driver.window.news.text()
    assert not driver.window.isVisible()


# --- the store -----------------------------------------------------------------------------


def test_the_latest_files_come_first_and_lost_ones_are_not_offered(kept, tmp_path):
    """Ten at most; one that is opened again moves up."""
    files = [tmp_path / f"{number}.glb" for number in range(12)]
    for file in files:
        file.write_text("")
        kept.add_recent(str(file))
    kept.add_recent(str(files[5]))
    names = [Path(path).name for path in kept.recent]
    assert names == [f"{n}.glb" for n in (5, 11, 10, 9, 8, 7, 6, 4, 3, 2)]
    files[11].unlink()
    assert "11.glb" not in [Path(path).name for path in kept.recent]


def test_shapes_and_files_are_kept_side_by_side(kept, tmp_path):
    """One does not overwrite the other."""
    shape = WindowShape(b"\x00\xffgeometry", b"docks\x01")
    (tmp_path / "a.glb").write_text("")
    kept.keep_shape(shape)
    kept.add_recent(str(tmp_path / "a.glb"))
    assert kept.shape() == shape
    assert kept.recent == [str(tmp_path / "a.glb")]


JSON = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(), inner, max_size=3),
    max_leaves=6,
)
PATHS = ["x" * 5000, "a\0b", "\ud800", "/" * 4000, "", ".", "/dev/zero", "a\nb", "~", 3, None, True]
DAMAGED = [
    "", "[1, 2]", '{"recent": 5, "geometry": 7}', "{", "\udcff", "[" * 100_000, '{"a":' * 100_000,
    "1" * 10_000, '"' + "x" * 2_000_000 + '"', "\0" * 1000, "NaN", "null", "true",
    json.dumps({"recent": PATHS, "geometry": {"a": []}, "docks": [1]}),
    json.dumps({"recent": {"a.glb": 1}, "geometry": "x", "docks": "\u00e9"}),
    json.dumps({"recent": ["a.glb"] * 50_000}),
]  # fmt: skip


@pytest.mark.parametrize("text", DAMAGED, ids=range(len(DAMAGED)))
def test_a_damaged_store_is_an_empty_one(kept, tmp_path, text):
    """A window must open whatever an older version or a crash left behind."""
    (tmp_path / "kept").mkdir()
    for name in ("window.json", "session.toml"):
        (tmp_path / "kept" / name).write_bytes(text.encode("utf-8", "surrogateescape"))
    assert kept.recent == []
    assert kept.shape() is None
    assert kept.session() is None


@pytest.mark.parametrize("kind", ["folder", "pipe", "endless", "loop", "large"])
def test_a_store_that_is_no_file_is_an_empty_one(kept, tmp_path, kind):
    """A pipe would be waited for, a device read without end; what was kept since is found again."""
    (tmp_path / "kept").mkdir()
    for name in ("window.json", "session.toml"):
        make_no_file(tmp_path / "kept" / name, kind)
    assert (kept.recent, kept.shape(), kept.session()) == ([], None, None)
    scene = tmp_path / "a.glb"
    scene.write_text("")
    kept.keep_session(Project(scene=str(scene)))
    kept.keep_shape(WindowShape(b"1", b"2"))
    assert kept.session().scene.endswith("a.glb")
    assert kept.shape() == WindowShape(b"1", b"2")


def make_no_file(path, kind):
    if kind == "folder":
        path.mkdir()
    elif kind == "pipe":
        os.mkfifo(path)
    elif kind == "large":
        path.touch()
        os.truncate(path, 1 << 36)
    else:
        path.symlink_to({"endless": "/dev/zero", "loop": path}[kind])


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(JSON | st.fixed_dictionaries({"recent": JSON, "geometry": JSON, "docks": JSON}))
def test_of_any_json_the_bad_part_alone_is_dropped(tmp_path, facts):
    """Whatever stands where a list or a text should: no exception, and files that are there."""
    there = tmp_path / "there.glb"
    there.write_text("")
    if isinstance(facts, dict) and isinstance(facts.get("recent"), list):
        facts["recent"].append(str(there))
    store = Kept(tmp_path)
    (tmp_path / "window.json").write_text(json.dumps(facts), encoding="utf-8")
    offered = store.recent
    assert all(Path(path).is_file() for path in offered)
    assert (
        str(there) in offered
        or not isinstance(facts, dict)
        or "recent" not in facts
        or (not isinstance(facts["recent"], list))
    )
    assert store.shape() is None


@pytest.mark.parametrize("name", ["geometry", "docks"])
def test_a_shape_with_a_flipped_bit_is_none(kept, tmp_path, name):
    """Qt takes memory for whatever counts stand in it."""
    kept.keep_shape(WindowShape(b"geometry", b"docks"))
    file = tmp_path / "kept" / "window.json"
    facts = json.loads(file.read_text())
    data = bytearray(b64decode(facts[name]))
    data[2] ^= 16
    file.write_text(json.dumps(facts | {name: b64encode(bytes(data)).decode()}))
    assert kept.shape() is None


SAID_WRONG = {
    "place": "95,14", "at": "2026-02-30T10:00",
    "camera": "{eye_m = [0, 0, 0], target_m = [0, 0, 0]}",
}  # fmt: skip


@pytest.mark.parametrize("field", SAID_WRONG)
def test_a_session_that_says_something_impossible_is_none(kept, tmp_path, field):
    """It would open nothing but a complaint."""
    scene = tmp_path / "s.glb"
    scene.write_text("")
    kept.keep_session(Project(scene=str(scene)))
    file = tmp_path / "kept" / "session.toml"
    value = SAID_WRONG[field]
    others = [line for line in file.read_text().splitlines() if not line.startswith(field)]
    others.insert(0, f"{field} = {value}" if field == "camera" else f'{field} = "{value}"')
    file.write_text("\n".join(others))
    assert kept.session() is None


def test_presets_that_cannot_be_read_are_set_aside_not_overwritten(tmp_path):
    """They are their user's work: a comma too many must not cost them."""
    presets = PresetStore(tmp_path)
    for name in ("hazy", "clear"):
        presets.keep("clouds", name, {"coverage": 0.3})
    file = tmp_path / "clouds.json"
    whole = file.read_text()
    file.write_text(whole + ",")
    assert presets.names("clouds") == []
    presets.keep("clouds", "new", {"coverage": 0.5})
    assert presets.names("clouds") == ["new"]
    assert (tmp_path / "clouds.json.damaged").read_text() == whole + ","


def test_of_presets_the_bad_one_alone_is_dropped(tmp_path):
    """The valid presets beside it survive the next write."""
    presets = PresetStore(tmp_path)
    presets.keep("clouds", "good", {"coverage": 0.3})
    file = tmp_path / "clouds.json"
    file.write_text(json.dumps(json.loads(file.read_text()) | {"bad": [1, 2]}))
    assert presets.names("clouds") == ["good"]
    presets.keep("clouds", "new", {"coverage": 0.5})
    assert json.loads(file.read_text())["bad"] == [1, 2]
    presets.forget("clouds", "good")
    assert presets.names("clouds") == ["new"]


def test_a_window_opens_on_a_damaged_store(open_window, tmp_path):
    """The menu of recent files works, with names that are any bytes, and the docks are kept when
    the window closes."""
    (tmp_path / "kept").mkdir()
    (tmp_path / "kept" / "window.json").write_text("[" * 100_000)
    driver = open_window()
    driver.window.menus.fill_recent()
    assert len(driver.window.menus.recent.actions()) == 1
    odd = tmp_path / os.fsdecode(b"\xff.glb")
    odd.write_text("")
    driver.window.files.kept.add_recent(str(odd))
    driver.window.menus.fill_recent()
    assert len(driver.window.menus.recent.actions()) >= 1
    assert str(odd) in driver.window.files.kept.recent
    driver.window.show_palette()
    driver.window.close()
    assert Kept(tmp_path / "kept").shape() is not None


def test_a_session_whose_scene_has_gone_is_not_restored(kept, tmp_path):
    """Otherwise each start would report the same error."""
    scene = tmp_path / "s.glb"
    scene.write_text("")
    kept.keep_session(Project(scene=str(scene), place="10,20,0"))
    assert kept.session().place == "10,20,0"
    scene.unlink()
    assert kept.session() is None


def test_without_a_folder_nothing_is_kept(tmp_path):
    """Nothing is written without a folder, as in safe mode."""
    nothing = Kept(None)
    nothing.add_recent(str(tmp_path))
    nothing.keep_session(Project(scene="a.glb"))
    nothing.keep_shape(WindowShape(b"", b""))
    assert (nothing.recent, nothing.session(), nothing.shape()) == ([], None, None)


# --- the command ---------------------------------------------------------------------------


@pytest.fixture
def started(monkeypatch, kept):
    """What `vrut-lite run` would open: project, store, safe mode."""
    import vrut_lite.app.desktop
    import vrut_lite.app.main

    calls = []
    monkeypatch.setattr(vrut_lite.app.desktop, "require_desktop", lambda meanwhile: None)
    monkeypatch.setattr(vrut_lite.app.main, "run_app", lambda *call: calls.append(call) or 0)
    monkeypatch.setattr(Kept, "of_user", classmethod(lambda cls: kept))
    return calls


def started_with(started, *arguments):
    outcome = CliRunner().invoke(run, arguments)
    assert not isinstance(outcome.exception, UserError), outcome.exception
    return started[-1]


def test_a_module_that_was_switched_off_stays_off(open_window, kept):
    """From the next window's start on, until its box is ticked; undo does not bring it back."""
    first = open_window()
    manager = first.panel("modules")
    first.until(lambda: manager.list.topLevelItemCount() > 0)
    manager.choose("aurora")
    # The window is closed before the engine, which may be busy, has acted on it.
    manager.list.currentItem().setCheckState(0, Qt.CheckState.Unchecked)
    assert manager.switched_off == {"aurora"}
    first.window.close()
    kept.keep_switched_off({*kept.switched_off, "of_a_removed_package"})
    second = open_window()
    assert second.asked(lambda stage: stage.kernel.seats["aurora"].state) == "disabled"
    assert second.asked(lambda stage: stage.kernel.seats["clouds"].state) == "running"
    assert not second.window.actions_by_name["undo"].isEnabled()
    manager = second.panel("modules")
    second.until(lambda: manager.switched_off == {"aurora"})
    second.session.send(EnableModule(module="aurora"))
    second.until(lambda: manager.switched_off == set())
    second.window.close()
    assert kept.switched_off == set()


def test_safe_mode_switches_nothing_off_for_the_next_start(open_window, kept):
    """Only what was off before it stays off."""
    kept.keep_switched_off({"aurora"})
    driver = open_window()
    manager = driver.panel("modules")
    driver.until(lambda: manager.list.topLevelItemCount() > 0)
    driver.click(manager.safe_mode)
    driver.until(lambda: manager.switched_off is None)
    driver.window.close()
    assert kept.switched_off == {"aurora"}


@pytest.mark.parametrize("value", [7, [7, None, ["aurora"]], {"aurora": True}])
def test_damaged_names_of_modules_switch_nothing_off(kept, tmp_path, value):
    (tmp_path / "kept").mkdir()
    (tmp_path / "kept" / "window.json").write_text(json.dumps({"switched_off": value}))
    assert kept.switched_off == set()


def test_run_without_a_scene_opens_the_last_session(started, kept):
    """And the first time a scene that can be looked at; options hold for both."""
    project, *others = started_with(started)
    assert project.scene.endswith("street.obj")
    assert others == [kept, False, None]
    scene = str(SCENES / "spheres.glb")
    kept.keep_session(Project(scene=scene, place="10,20,0"))
    project, *_ = started_with(started)
    assert (Path(project.scene).name, project.place) == ("spheres.glb", "10,20,0")
    kept.keep_named(NamedProject(scene, is_changed=True))
    project, *_, named = started_with(started, "--place", "1,2")
    assert named == kept.named == NamedProject(scene, is_changed=True)
    assert project.where()[:2] == (1.0, 2.0)
    project, *_ = started_with(started, str(SCENES / "sundial.toml"))
    assert project.scene.endswith("sundial.glb")
    # The file that Save writes.
    assert started[-1][3] == NamedProject(str(SCENES / "sundial.toml"))


def test_run_in_safe_mode_leaves_the_last_session_alone(started, kept):
    """It may be what breaks the window."""
    kept.keep_session(Project(scene=str(SCENES / "spheres.glb")))
    project, store, safe, _ = started_with(started, "--safe-mode")
    assert project.scene.endswith("street.obj")
    assert (store.session(), safe) == (None, True)


def test_safe_mode_from_the_start_runs_what_is_needed(qtbot, tmp_path):
    """Before the project's settings arrive, and nothing of it can be taken back."""
    from vrut_lite.app.engine.module_states import into_safe_mode, states_of

    driver = WindowDriver(qtbot, HeadlessStage, tmp_path)
    driver.session.begin_with(*driver.asked(lambda stage: into_safe_mode(states_of(stage))))
    driver.settled()
    states = driver.asked(states_of)
    assert states.safe
    assert {m.name for m in states.modules.values() if m.state == "running"} == {
        "dynamic_skylight", "weather_sky", "scene", "sky_sum",
    }  # fmt: skip
    assert not driver.window.actions_by_name["undo"].isEnabled()
    assert msgspec.structs.asdict(driver.project)["slots"]["sky"] == ("dynamic_skylight")
    driver.close()
