"""The Scene panel tells how the file stands and what of it is not shown, and changes it."""

import json

import numpy as np
import pytest
from ifc_files import house_ifc
from window_driver import SCENES, choose

from vrut_lite.messages.place import SetPlace
from vrut_lite.messages.scene import SceneOpened
from vrut_lite.project import Project


@pytest.fixture
def lying(tmp_path):
    """A Z-up house in centimetres, with a line that nobody draws."""
    plot = [(-1e3, -1e3, 0), (1e3, -1e3, 0), (1e3, 1e3, 0), (-1e3, 1e3, 0)]
    wall = [(-400, 0, 0), (400, 0, 0), (400, 0, 600), (-400, 0, 600)]
    text = "".join("v {} {} {}\n".format(*corner) for corner in plot + wall)
    path = tmp_path / "house.obj"
    path.write_text(text + "f 1 2 3 4\nf 5 6 7 8\nl 1 2\n")
    return path


def test_axis_and_unit_are_shown_and_changed(shared_headless_window, lying):
    """Panel and status line show the guess; another choice opens the file again."""
    driver = shared_headless_window
    panel = driver.panel("module scene")
    driver.open(Project(scene=str(lying)))
    driver.until(lambda: panel.unit.currentData() == 0.01)
    assert panel.up.currentData() == "z"
    assert "20 \N{MULTIPLICATION SIGN} 6" in panel.extent.text()
    for shown in (panel.notices.text(), driver.window.news.text()):
        assert "stand along +Z" in shown
        assert "points or lines: one pixel wide" in shown
    # A long line does not widen the window.
    assert driver.window.minimumSizeHint().width() < driver.window.news.sizeHint().width()
    choose(panel.unit, 0.001)
    driver.until(lambda: driver.session.last(SceneOpened).upper_m[1] == pytest.approx(0.6))
    choose(panel.up, "y")
    driver.until(lambda: driver.session.last(SceneOpened).upper_m[2] == pytest.approx(0.6))
    # The file has neither cameras nor variants, and no empty list of them is shown.
    assert not panel.camera.isEnabled()
    assert panel.camera.isHidden()
    assert panel.variant.isHidden()


def test_a_hint_at_another_axis_has_its_click_and_undo_takes_it_back(
    shared_headless_window, tmp_path
):
    """Flat land on edge: one click beside the notice lays it down, Ctrl+Z sets it up again."""
    driver = shared_headless_window.activated()
    land = tmp_path / "land.obj"
    land.write_text("v 0 0 0\nv 40 0 0\nv 40 30 0\nv 0 30 0\nf 1 2 3 4\n")
    driver.open(Project(scene=str(land)))
    status = driver.window.statusBar()
    driver.until(lambda: "flat and upright" in driver.window.news.text())
    assert status.remedy.text() == "Up: Z"
    assert driver.session.last(SceneOpened).upper_m[1] == pytest.approx(30.0)
    status.remedy.click()
    driver.until(lambda: driver.session.last(SceneOpened).upper_m[1] == pytest.approx(0.0))
    assert driver.panel("module scene").up.currentData() == "z"
    assert status.remedy.isHidden()
    driver.window.undo()
    driver.until(lambda: driver.session.last(SceneOpened).upper_m[1] == pytest.approx(30.0))
    driver.window.redo()
    driver.until(lambda: driver.session.last(SceneOpened).upper_m[1] == pytest.approx(0.0))


def test_an_ifc_brings_its_place_to_the_window(shared_headless_window, tmp_path):
    """Opened like any scene, the house stands where its site says, once it is there."""
    pytest.importorskip("ifcopenshell", reason="the package ifcopenshell is not installed")
    driver = shared_headless_window
    (tmp_path / "house.ifc").write_bytes(house_ifc())
    driver.window.files.open_path(str(tmp_path / "house.ifc"))
    driver.until(lambda: driver.session.last(SceneOpened).path.endswith("house.ifc"))
    driver.until(lambda: driver.session.last(SetPlace).altitude_m == 520.0)
    assert driver.session.last(SetPlace).latitude_deg == pytest.approx(48.14, abs=0.01)


def test_the_first_scene_has_nothing_to_note(shared_headless_window):
    """A scene that is shown as it is says nothing."""
    driver = shared_headless_window
    panel = driver.panel("module scene")
    driver.open(Project(scene=str(SCENES / "street.obj")))
    driver.until(lambda: "25.5" in panel.extent.text())
    assert panel.notices.text() == ""


def test_animations_run_at_their_own_pace(shared_headless_window, tmp_path):
    """The button lets a clip run and holds it; a scene without animations has no button."""
    driver = shared_headless_window
    panel = driver.panel("module scene")
    assert panel.play.isHidden()
    driver.open(Project(scene=str(sliding_glb(tmp_path))))
    driver.until(lambda: not panel.play.isHidden())
    panel.play.click()
    driver.until(lambda: driver.session.last(SceneOpened).lower_m[0] > 0.0)
    panel.play.click()
    assert not panel.play.isChecked()


def test_variants_are_offered_and_chosen(shared_headless_window, tmp_path):
    """The file's other materials stand by name in the panel, and are shown when chosen."""
    driver = shared_headless_window
    panel = driver.panel("module scene")
    name = "KHR_materials_variants"
    materials = [
        {"pbrMetallicRoughness": {"baseColorFactor": [*rgb, 1]}} for rgb in ([0, 0, 0], [1, 0, 0])
    ]
    dressed = {
        "attributes": {"POSITION": 0},
        "material": 0,
        "extensions": {name: {"mappings": [{"material": 1, "variants": [0]}]}},
    }
    more = {
        "materials": materials,
        "meshes": [{"primitives": [dressed]}],
        "extensions": {name: {"variants": [{"name": "red"}]}},
    }
    driver.open(Project(scene=str(sliding_glb(tmp_path, **more))))
    driver.until(lambda: panel.variant.count() == 2)
    assert panel.variant.currentData() == ""
    choose(panel.variant, "red")
    driver.until(lambda: driver.session.last(SceneOpened).opened.variant == "red")
    colours = driver.session.last(SceneOpened).materials.base_colour_rgba.values
    np.testing.assert_array_equal(colours, [[1, 0, 0, 1]])


def sliding_glb(folder, **more):
    """A triangle that slides by 1 m a second for ten seconds."""
    numbers = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 0], [10, 0, 0]], "<f4")
    data = numbers.tobytes() + np.array([0, 10], "<f4").tobytes()
    views = [(0, 36), (36, 24), (60, 8)]
    document = {
        "asset": {"version": "2.0"},
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        "animations": [
            {
                "channels": [{"sampler": 0, "target": {"node": 0, "path": "translation"}}],
                "samplers": [{"input": 2, "output": 1}],
            }
        ],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"},
            {"bufferView": 1, "componentType": 5126, "count": 2, "type": "VEC3"},
            {"bufferView": 2, "componentType": 5126, "count": 2, "type": "SCALAR"},
        ],
        "bufferViews": [{"buffer": 0, "byteOffset": a, "byteLength": n} for a, n in views],
        "buffers": [{"uri": "sliding.bin", "byteLength": len(data)}],
    }
    (folder / "sliding.bin").write_bytes(data)
    path = folder / "sliding.gltf"
    path.write_text(json.dumps({**document, **more}))
    return path
