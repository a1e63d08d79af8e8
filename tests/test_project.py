"""Each field of a project is in its file, its inputs, the command line and undo."""

import sys

import msgspec
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from vrut_lite import cli
from vrut_lite.app.engine.history import inverse_of
from vrut_lite.commands import render
from vrut_lite.daylight_kernel import FaultCollector, daylight_kernel
from vrut_lite.errors import UserError
from vrut_lite.kernel.messages import SetSetting
from vrut_lite.kernel.settings import describe
from vrut_lite.messages.camera import MoveCamera
from vrut_lite.messages.glazing import GlazingFile
from vrut_lite.messages.lighting import LampPlacement, LightingControl
from vrut_lite.messages.picture import Resize
from vrut_lite.messages.placement import PlacedFile, Placement
from vrut_lite.messages.scene import LoadScene
from vrut_lite.messages.weather import SetWeather
from vrut_lite.project import (
    PROJECT_PARTS,
    CameraView,
    Exposure,
    Haze,
    Project,
    daylight_inputs,
    load_project,
    project_of_path,
    save_project,
    setting_inputs,
    view_inputs,
)
from vrut_lite.scene.manager import SceneManager
from vrut_lite.scene.settings import SCENE, SceneSettings

OF_SCENE = describe(SceneSettings)
# Fields that no input carries.
BY_MODULE = {"settings", "slots"}
KEPT_IN_FILE = {
    "views": "names that the window has for cameras",
    "sensors": "points for `vrut-lite daylight`",
    "bsdf": "measured glazing for `vrut-lite daylight`",
    "lamp": "luminaires for `vrut-lite daylight`",
    "lighting": "controls of lamps for `vrut-lite daylight`",
}
NO_UNDO = {
    Resize: "the window has the size that its user gives it",
    MoveCamera: "looking around changes nothing",
    LoadScene: "a project or a scene is where undo ends",
    SetWeather: "the slots that come with it are undone",
}
OPTIONS = {
    "placement": ["--up", "z"],
    "scene_camera": ["--scene-camera", "2"],
    "variant": ["--variant", "red"],
    "place": ["--place", "1,2"],
    "at": ["--at", "2026-01-01T12:00Z"],
    "north_offset_deg": ["--north-offset", "20"],
    "slots": ["--sky", "bruneton_sky"],
    "settings": ["--set", "clouds.coverage=0.5"],
    "camera": ["--eye", "1,2,3", "--target", "0,0,0"],
    "exposure": ["--exposure", "12"],
    "size": ["--size", "64x32"],
    "tolerance": ["--tolerance", "1%"],
    "haze": ["--haze", "0.3"],
    "ground": ["--ground", "snow,0.8"],
    "weather": ["--weather", "YEAR.epw"],
}
NO_OPTION = {
    "scene": "it is the argument",
    "beside": "a list of files with placements",
    "luminaires": "a table of lamps",
    "glazing": "a table of materials",
    "views": "a table of cameras",
    "sensors": "an option of `vrut-lite daylight`",
    "bsdf": "an option of `vrut-lite daylight`",
    "lamp": "an option of `vrut-lite daylight`",
    "lighting": "a table of controls",
}


def another(spec):
    """A value of a setting that is not its default."""
    if spec.choices:
        return next(choice for choice in spec.choices if choice != spec.default)
    if spec.type is bool:
        return not spec.default
    return 30.0 if spec.at_most is None else spec.at_most


@pytest.fixture(scope="module")
def project(house, year_file):
    """A project of which all that the scene allows is other than by default."""
    return Project(
        scene=str(house),
        placement=Placement(up="z", metres_per_unit=0.01, position_m=(1.0, 0.0, 2.0)),
        beside=(PlacedFile(scene=str(house), placement=Placement(up="z", metres_per_unit=0.1)),),
        place="-33.87,151.21,40",
        at="2026-06-21T11:00:00+00:00",
        north_offset_deg=-12.5,
        slots={"sky": "bruneton_sky"},
        settings={"clouds": {"coverage": 0.5}},
        camera=CameraView(eye_m=(1.0, 2.0, 3.0), target_m=(0.0, 0.0, 0.0)),
        views={"door": CameraView(eye_m=(3.0, 2.0, 1.0), target_m=(0.0, 0.0, 0.0))},
        exposure=Exposure(mode="manual", ev100=9.25),
        size=(64, 48),
        tolerance=0.5,
        haze=Haze(0.3, "desert"),
        ground="grass,0.15",
        weather=str(year_file),
        sensors=str(house.with_name("desks.csv")),
        lamp={
            "desk": LampPlacement(str(house.with_name("panel.ies")), [1.0, 2.0, 3.0], group="row"),
            "rows": LampPlacement(str(house.with_name("spot.ldt")), [(1.0, 2.0, 3.0)], watts=7.0),
        },
        lighting={"row": LightingControl("open_loop", dark_at_lx=800.0)},
        bsdf={
            "pane": GlazingFile(
                str(house.with_name("blind.xml")),
                up=(0.0, 0.0, 1.0),
                closed=(str(house.with_name("shut.xml")),),
                by="schedule",
                schedule=str(house.with_name("hours.csv")),
            )
        },
        **{name: another(spec) for name, spec in OF_SCENE.items()},
    )


@pytest.fixture(scope="module")
def house(tmp_path_factory):
    path = tmp_path_factory.mktemp("project") / "house.obj"
    path.write_text("v 0 0 0\nv 900 0 0\nv 900 0 600\nv 0 0 600\nf 1 2 3 4\n")
    return path


@pytest.fixture(scope="module")
def year_file(house):
    pytest.importorskip("pvlib")
    from epw_year import epw_text

    path = house.with_name("prague.epw")
    path.write_text(epw_text())
    return path


@pytest.fixture(scope="module")
def kernel(project):
    """A kernel with the project's inputs."""
    kernel, failures = daylight_kernel()
    assert failures == []
    faults = FaultCollector(kernel)
    kernel.add_module(SceneManager, lights_surfaces=False)
    kernel.inject(*setting_inputs(project, kernel), *daylight_inputs(project))
    kernel.inject(*view_inputs(project))
    kernel.pump_until_idle()
    faults.raise_first()
    yield kernel
    kernel.close()


def test_the_file_keeps_every_field(project, house):
    """Reading a written project gives an equal one."""
    path = house.with_name("project.toml")
    save_project(path, project)
    assert load_project(path) == project


def test_a_table_of_the_scenes_settings_is_refused(house):
    """They are fields of the project: values of a table beside them would hold for nothing."""
    path = house.with_name("table.toml")
    path.write_text('scene = "house.obj"\n[settings.scene]\nsection = "y"\n')
    with pytest.raises(UserError, match="write its lines above all tables"):
        load_project(path)


def test_every_field_becomes_inputs_and_is_read_back(project, kernel):
    """A field that no input carries, or that is not read back, is lost when a window saves."""
    fields = {}
    for part in PROJECT_PARTS.values():
        message = part.sent(kernel)
        fields |= {} if message is None else part.fields_of(message)
    settings = msgspec.structs.asdict(kernel.seats[SCENE].settings)
    found = fields | settings
    assert found == {name: getattr(project, name) for name in found}
    assert {*found, *BY_MODULE, *KEPT_IN_FILE} == set(Project.__struct_fields__)


@pytest.mark.parametrize("kind", PROJECT_PARTS)
def test_undo_takes_back_every_input_of_a_project_or_says_why_not(project, kernel, kind):
    """The input before comes back: that of the project, where the defaults are sent."""
    sent = PROJECT_PARTS[kind].input_of(msgspec.structs.replace(Project(), scene="other.obj"))
    sent = sent or PROJECT_PARTS[kind].default
    undone = inverse_of(sent, kernel) if sent else None
    assert undone == (None if kind in NO_UNDO else PROJECT_PARTS[kind].input_of(project))


@pytest.mark.parametrize("name", OF_SCENE)
def test_undo_takes_back_every_setting_of_the_scene(project, kernel, name):
    """By the setting's name alone."""
    sent = SetSetting(module=SCENE, name=name, value=OF_SCENE[name].default)
    undone = SetSetting(module=SCENE, name=name, value=getattr(project, name))
    assert inverse_of(sent, kernel) == undone


@pytest.mark.parametrize("name", Project.__struct_fields__)
def test_the_command_line_sets_every_field_or_says_why_not(house, year_file, monkeypatch, name):
    """An option, or --set for settings of the scene, changes the field of the project."""
    if name in NO_OPTION:
        return
    plans = []
    monkeypatch.setattr(render, "make_pictures", lambda plan, *_: plans.append(plan) or [""])
    if name in OF_SCENE:
        options = ["--set", f"scene.{name}={another(OF_SCENE[name])}"]
    else:
        options = [str(year_file) if text == "YEAR.epw" else text for text in OPTIONS[name]]
    monkeypatch.setattr(sys, "argv", ["vrut-lite", "render", str(house), "-o", "a.png", *options])
    cli.main()
    changed = getattr(plans[0].project, name)
    assert changed != getattr(project_of_path(str(house)), name)
    if name in OF_SCENE:
        assert changed == another(OF_SCENE[name])


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16"])
def test_a_project_of_any_editor_is_read(tmp_path, encoding):
    """Notepad begins a file with a byte order mark, older ones write UTF-16."""
    path = tmp_path / "house.toml"
    path.write_bytes('scene = "Häuser.obj"\r\nplace = "50,14"\r\n'.encode(encoding))
    assert load_project(path).scene.endswith("Häuser.obj")


HOSTILE = [
    "nan", "-inf", "1e999", "-1", "0", "99999999999999999999", "0x10", "true", '""', "[]", "{}",
    "[[1]]", "2026-02-30", "2026-06-21", "12:00:00", "2026-06-21T12:00:00Z", '"\\u0000"', '"\\n"',
    '"../../x"', "[1.0, nan, 3.0]", "[1, 2, 3, 4]", "'", '"""', "{a = 1}", "=", "",
]  # fmt: skip


@settings(max_examples=120, deadline=None)
@given(
    line=st.integers(0, 80),
    value=st.one_of(st.none(), st.sampled_from(HOSTILE)),
    at=st.floats(0.0, 1.0),
    cut=st.integers(0, 40),
    put=st.binary(max_size=6),
)
def test_a_damaged_project_is_read_or_refused_in_a_sentence(
    project, house, kernel, line, value, at, cut, put
):
    """Values of another kind, and bytes lost or changed anywhere: no error but one sentence, when
    the file is read and when its inputs are made."""
    path = house.with_name("damaged.toml")
    save_project(path, project)
    lines = path.read_text().split("\n")
    line %= len(lines)
    if value is not None:
        lines[line] = lines[line].split("=")[0] + "= " + value
        data = "\n".join(lines).encode()
    else:
        data = path.read_bytes()
        start = int(at * len(data))
        data = data[:start] + put + data[start + cut :]
    path.write_bytes(data)
    refusal = ""
    try:
        found = load_project(path)
        setting_inputs(found, kernel)
        daylight_inputs(found)
        view_inputs(found)
    except UserError as error:
        refusal = str(error)
    assert "\n" not in refusal
