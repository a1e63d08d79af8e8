"""Blender gets the very light that vrut_lite computes, from a child process that it keeps."""

import importlib.util
import json
import math
import os
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

BLENDER = Path(__file__).parents[2] / "integrations" / "blender"
PROGRAM = str(Path(sys.executable).with_name("vrut-lite"))


def loaded(name):
    """A file of the add-on that needs no Blender."""
    path = BLENDER / "vrut_lite_daylight" / f"{name}.py"
    spec = importlib.util.spec_from_file_location(f"blender_{name}", path)
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    return module


child_of_blender, sky_file = loaded("child"), loaded("sky_file")


@pytest.fixture
def child():
    """A child that ends with the test."""
    child = child_of_blender.Child()
    yield child
    child.close()


def hour(**changes):
    """An afternoon in Prague."""
    place = {"latitude_deg": 50.0755, "longitude_deg": 14.4378, "altitude_m": 200.0}
    air = {"sky": "dynamic_skylight", "haze": 0.2, "albedo": 0.1}
    when = {"date": "2026-06-21", "hour": 18.5}
    return sky_file.Hour(**(place | air | when | {"rows": 32} | changes))


@pytest.mark.long
def test_the_lamp_shines_from_where_the_sun_stands(child, tmp_path):
    """Its +Z axis, turned by its angles about X and then Z, points to the sun of the facts: east
    by north by up are Blender's axes."""
    path = tmp_path / "sky.exr"
    said = child.ask(PROGRAM, hour().words(path))
    assert "sun 23.1 deg high" in said
    lamp = sky_file.sun_lamp(path)
    around_x, _, around_z = lamp.rotation
    z_axis = (
        math.sin(around_x) * math.sin(around_z),
        -math.sin(around_x) * math.cos(around_z),
        math.cos(around_x),
    )
    facts = json.loads((tmp_path / "sky.exr.json").read_text())
    east, up, south = facts["sunDirection"]
    assert z_axis == pytest.approx((east, -south, up), abs=1e-7)
    irradiance = [lamp.strength * share for share in lamp.colour]
    assert irradiance == pytest.approx(facts["sunIrradianceRgb"])
    assert max(lamp.colour) == 1.0
    assert math.degrees(lamp.angle) == pytest.approx(0.533, abs=0.01)


@pytest.mark.long
def test_what_is_refused_is_one_sentence_and_the_child_goes_on(child, tmp_path):
    """A wrong place, a program that is none, a child that was killed: the next request works."""
    path = tmp_path / "sky.exr"
    for words, sentence in [
        (hour(latitude_deg=99.0).words(path), "latitude"),
        (["no-such-command"], "No such command"),
        (["serve"], "serve runs already"),
    ]:
        with pytest.raises(child_of_blender.NoDaylight, match=sentence):
            child.ask(PROGRAM, words)
    with pytest.raises(child_of_blender.NoDaylight, match="name the path of vrut-lite"):
        child.ask(str(tmp_path / "none"), ["modules"])
    assert "--at" in child.ask(PROGRAM, ["sky", "--help"])
    child._process.kill()
    child._process.wait()
    assert "--at" in child.ask(PROGRAM, ["sky", "--help"])


@pytest.mark.long
@pytest.mark.skipif("BLENDER_PYTHON" not in os.environ, reason="BLENDER_PYTHON names no Python")
def test_blender_has_our_light(tmp_path):
    """A plane in Cycles gets our irradiance within 1 % by day, below stratus and by the moon, and
    within 6 % where stars and the moon's disc are in the map; a day is keyed, saved and opened
    again, one hour follows it; a second scene has its own light; a file that is saved for the
    first time, moved, or saved elsewhere has its panoramas beside it, or a sentence where no
    folder can be made; a world that was removed is made anew; the add-on disabled leaves the file
    as it was.

    BLENDER_PYTHON names a Python that has the package bpy, which needs an older numpy than ours.
    """
    archive = tmp_path / "addon.zip"
    subprocess.run([sys.executable, BLENDER / "package.py", archive], check=True)
    assert "blender_manifest.toml" in zipfile.ZipFile(archive).namelist()
    script = Path(__file__).with_name("in_blender.py")
    done = subprocess.run(
        [os.environ["BLENDER_PYTHON"], script, archive, PROGRAM, tmp_path],
        env=os.environ | {"BLENDER_USER_RESOURCES": str(tmp_path / "user")},
        capture_output=True,
        text=True,
        check=True,
    )
    (line,) = [line for line in done.stdout.splitlines() if line.startswith("TOLD ")]
    told = json.loads(line.removeprefix("TOLD "))
    for name, (found, wanted) in told["light"].items():
        assert found == pytest.approx(wanted, rel=0.06 if "map" in name else 0.01), name
    assert told["at 18"] != told["at 15"]
    assert told["undone"] == told["at 15"]
    assert "name the path of vrut-lite" in told["refused"]
    day = told["day"]
    assert [frame[1] for frame in day] == 3 * ["SEQUENCE"]
    assert len({tuple(frame[2:5]) for frame in day}) == 3
    assert told["reopened"] == [day[2], 50.0]
    # One hour after a keyed day is that hour in every frame, of lamp and map.
    assert told["one hour after a day"] == 3 * [told["one hour after a day"][0]]
    assert told["one hour after a day"][0][1] == "FILE"
    # Another scene has its own light.
    assert told["other scene"][0] == told["one hour after a day"][0]
    assert told["other scene"][1:] == [["//scene.skies/Scene.exr", True],
                                       ["//scene.skies/Other.exr", True]]  # fmt: skip
    assert told["saved"] == ["//scene.skies/Scene.exr", True]
    for name, folder in (("moved", "scene"), ("saved elsewhere", "copy")):
        files = [f"//{folder}.skies/{scene}.exr" for scene in ("Other", "Scene")]
        assert told[name] == [[file, True] for file in files]
    assert "could not be saved beside the file" in told["saved without a folder"]
    assert "cannot make the folder" in told["no folder"]
    assert told["without a world"] == ["//blocked.skies/Scene.exr", True]
    assert told["disabled"] == told["enabled"]
