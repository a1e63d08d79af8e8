"""Lamps of glTF files and IES files shine with the candela that the files give."""

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from loaded_scenes import WriteScene

from vrut_lite.errors import UserError
from vrut_lite.geometry.colour import LUMENS_PER_WATT
from vrut_lite.messages.lamps import SceneLamps
from vrut_lite.project import Project, load_project, save_project, view_inputs
from vrut_lite.scene.ies_file import read_ies
from vrut_lite.scene.loading import load_scene
from vrut_lite.scene.packing import packed

PUNCTUAL, IES = "KHR_lights_punctual", "EXT_lights_ies"
# A downlight of 40 candela (multiplier 2) that is four times dimmer across than along.
DOWNLIGHT = """IESNA:LM-63-1995
[TEST] made for a test
TILT=NONE
1 1000 2 3 2 1 2 0.1 0.1 0 1 1 10
0 45 90
0 90
20 10 0
20 2.5 0
"""


def lamps_of(path: Path, **luminaires: str) -> SceneLamps:
    lamps = load_scene(path, luminaires=luminaires).lamps
    assert lamps is not None
    lamps.check()
    lamps.check_arrays()
    return lamps


def with_lamps(*lamps: dict[str, Any], **node: Any) -> Any:
    """An edit that adds a node for each lamp; all stand 2 m up."""

    def edit(document: dict[str, Any]) -> None:
        document["extensionsRequired"] = [PUNCTUAL]
        document["extensions"] = {PUNCTUAL: {"lights": list(lamps)}}
        for number, lamp in enumerate(lamps):
            placed = {"name": lamp.get("name", ""), "translation": [0, 2, 0], **node}
            document["nodes"].append({**placed, "extensions": {PUNCTUAL: {"light": number}}})
            document["scenes"][0]["nodes"].append(number + 1)

    return edit


def test_a_point_of_so_many_candela_gives_lux_by_the_square_of_the_distance(
    write_square: WriteScene,
) -> None:
    """683 cd white, 2 m above the ground: a quarter of a watt, 170.75 lx, whatever the scale."""
    lamp = {"type": "point", "intensity": 683.0, "name": "bulb"}
    for scale in (1.0, 50.0):
        lamps = lamps_of(write_square(with_lamps(lamp, scale=[scale] * 3)))
        below = lamps.irradiance_at(0, [0.0, 0.0, 0.0], [0.0, 1.0, 0.0])
        assert below == pytest.approx([0.25] * 3)
        aside = lamps.irradiance_at(0, [2.0, 0.0, 0.0], [0.0, 1.0, 0.0])
        assert aside == pytest.approx([0.125 * math.sqrt(0.5)] * 3)
        assert lamps.irradiance_at(0, [0.0, 0.0, 0.0], [0.0, -1.0, 0.0]) == pytest.approx([0.0] * 3)


def test_a_spot_shines_along_its_node_and_fades_between_its_cones(write_square: WriteScene) -> None:
    """KHR_lights_punctual's ramp: full inside, dark outside, squared between the cosines."""
    cone = {"innerConeAngle": 0.3, "outerConeAngle": 0.6}
    lamp = {"type": "spot", "intensity": 100.0, "color": [1.0, 0.5, 0.0], "spot": cone}
    # A quarter turn about x points -Z down.
    down = [-math.sqrt(0.5), 0.0, 0.0, math.sqrt(0.5)]
    lamps = lamps_of(write_square(with_lamps(lamp, rotation=down)))
    full = np.array([100.0, 50.0, 0.0]) / LUMENS_PER_WATT
    for angle, share in ((0.0, 1.0), (0.29, 1.0), (0.61, 0.0), (math.pi, 0.0)):
        way = [math.sin(angle), -math.cos(angle), 0.0]
        assert lamps.intensity_towards(0, way) == pytest.approx(full * share, abs=1e-9)
    between = 0.5 * (math.cos(0.3) + math.cos(0.6))
    way = [math.sqrt(1.0 - between**2), -between, 0.0]
    assert lamps.intensity_towards(0, way) == pytest.approx(full * 0.25)


def test_a_luminaire_has_the_candela_of_its_file(write_square: WriteScene, tmp_path: Path) -> None:
    """40 cd along its axis; at 45 degrees 20 along the angle 0, 5 along 90; none upwards."""
    path = write_square(with_ies)
    (path.parent / "down.ies").write_text(DOWNLIGHT)
    lamps = lamps_of(path)
    at_45 = math.sqrt(0.5)
    ways = {
        (0.0, 0.0, -1.0): 40.0,
        (at_45, 0.0, -at_45): 20.0,
        (-at_45, 0.0, -at_45): 20.0,
        (0.0, at_45, -at_45): 5.0,
        (0.0, -at_45, -at_45): 5.0,
        (0.0, 0.0, 1.0): 0.0,
    }
    for way, candela in ways.items():
        found = lamps.intensity_towards(0, way) * LUMENS_PER_WATT
        assert found == pytest.approx([0.5 * candela, 0.25 * candela, 0.0], rel=1e-3, abs=1e-6)


def with_ies(document: dict[str, Any]) -> None:
    document["extensionsUsed"] = [IES]
    document["extensions"] = {IES: {"lights": [{"uri": "down.ies"}]}}
    instance = {"light": 0, "multiplier": 0.5, "color": [1.0, 0.5, 0.0]}
    document["nodes"].append({"extensions": {IES: instance}})
    document["scenes"][0]["nodes"].append(1)


def test_a_project_gives_a_luminaire_to_a_lamp_by_name(
    write_square: WriteScene, tmp_path: Path
) -> None:
    """The file's candela in the lamp's own colour; the project finds the file beside itself."""
    lamp = {"type": "point", "intensity": 1.0, "name": "Ceiling", "color": [1.0, 0.5, 0.25]}
    scene = write_square(with_lamps(lamp))
    (tmp_path / "down.ies").write_text(DOWNLIGHT)
    project_path = tmp_path / "rooms.toml"
    luminaires = {"Ceiling": str(tmp_path / "down.ies")}
    save_project(project_path, Project(scene=str(scene), luminaires=luminaires))
    assert '"down.ies"' in project_path.read_text()
    (load,) = [m for m in view_inputs(load_project(project_path)) if hasattr(m, "luminaires")]
    lamps = lamps_of(Path(load.path), **dict(load.luminaires))
    found = lamps.intensity_towards(0, [0.0, 0.0, -1.0]) * LUMENS_PER_WATT
    assert found @ [0.2126, 0.7152, 0.0722] == pytest.approx(40.0, rel=1e-3)
    assert found / found[0] == pytest.approx([1.0, 0.5, 0.25])
    with pytest.raises(UserError, match=r"to the lamp 'Cieling', which it does not have.*Ceiling"):
        lamps_of(scene, Cieling=luminaires["Ceiling"])


def test_lamps_come_brightest_first_and_dark_ones_and_suns_not_at_all(
    write_square: WriteScene,
) -> None:
    """The sun is the host's: a directional light is told, not drawn."""
    lamps = [
        {"type": "point", "intensity": 5.0, "name": "dim"},
        {"type": "directional", "intensity": 5.0, "name": "sun"},
        {"type": "point", "intensity": 0.0, "name": "off"},
        {"type": "point", "intensity": 50.0, "name": "bright"},
    ]
    scene = load_scene(write_square(with_lamps(*lamps)))
    assert scene.lamps is not None
    assert bytes(scene.lamps.names.values).decode() == "bright\ndim"
    assert scene.notices == ("directional light: the sun of the hour shines instead",)
    assert packed(scene).content_key != packed(load_scene(write_square())).content_key


# 30 candela (multiplier 1) where it is aimed, in two quarters symmetric.
FLOODLIGHT = """IESNA:LM-63-2002
TILT=NONE
1 1000 1 3 3 {kind} 2 0.1 0.1 0 1 1 10
-90 0 90
0 60 90
0 30 0
0 20 0
0 0 0
"""


@pytest.mark.parametrize("kind", [2, 3])
def test_lamps_of_types_a_and_b_shine_where_they_are_aimed(kind: int) -> None:
    """Type A turns around the vertical axis, so that 60 degrees aside and 45 up keep its angles;
    type B turns around the horizontal one."""
    candela, table = read_ies(FLOODLIGHT.format(kind=kind).encode()).photometry()
    assert candela == pytest.approx(30.0)
    assert table[0] == pytest.approx(1.0)
    assert table[91:].max() == 0.0

    def towards(right: float, up: float, ahead: float) -> float:
        row = math.degrees(math.acos(ahead))
        column = math.degrees(math.atan2(up, right)) % 360.0 / 5.0
        return 30.0 * float(table[round(row), round(column)])

    # On the axes both agree: 20 at 60 degrees either way, 15 at 45 degrees up or down.
    for side in (-1.0, 1.0):
        assert towards(side * math.sin(math.radians(60)), 0.0, 0.5) == pytest.approx(20.0, rel=0.01)
        assert towards(0.0, side * math.sqrt(0.5), math.sqrt(0.5)) == pytest.approx(15.0, rel=0.01)
    # 30 degrees aside and 45 up, turned first around the one axis or around the other.
    s, c, r = 0.5, math.sqrt(0.75), math.sqrt(0.5)
    way = (s * r, r, c * r) if kind == 3 else (s, r * c, r * c)
    assert towards(*way) == pytest.approx(30.0 * 0.5 * (1.0 - 30.0 / 180.0), rel=0.05)


BROKEN = {
    "no tilt": ("TILT=NONE", "", "no line TILT"),
    "letters": ("0 45 90", "0 4x5 90", "damaged"),
    "short": ("20 2.5 0\n", "", "cut short"),
    "falling angles": ("0 45 90", "0 90 45", "do not rise"),
    "type D": ("2 3 2 1 2", "2 3 2 4 2", "type 4"),
    "negative": ("20 2.5 0", "20 -2.5 0", "impossible candela"),
    "infinite": ("20 2.5 0", "20 inf 0", "not finite"),
    "many angles": ("2 3 2 1 2", "2 3e9 2 1 2", "angles"),
}


@pytest.mark.parametrize("name", BROKEN)
def test_a_damaged_luminaire_is_refused_in_a_sentence(write_square: WriteScene, name: str) -> None:
    """And nothing of a size that the file only declares is made."""
    old, new, sentence = BROKEN[name]
    path = write_square(with_ies)
    (path.parent / "down.ies").write_text(DOWNLIGHT.replace(old, new))
    with pytest.raises(UserError, match=sentence):
        load_scene(path)


@pytest.mark.parametrize(
    ("angles", "first", "same"),
    [
        ("0 90", 30.0, (150.0, 210.0, 330.0)),
        ("0 180", 30.0, (330.0,)),
        ("90 270", 100.0, (80.0,)),
        ("0 360", 30.0, (30.0,)),
        ("0", 0.0, (77.0, 200.0)),
    ],
)
def test_symmetry_of_a_luminaire_is_its_files(
    angles: str, first: float, same: tuple[float, ...]
) -> None:
    """LM-63: what angles around the axis a file leaves out repeats by its last one."""
    columns = len(angles.split())
    rows = "\n".join(["20 10 0", "20 2 0"][:columns])
    text = f"TILT\nTILT=NONE\n1 1 1 3 {columns} 1 2 0 0 0 1 1 1\n0 45 90\n{angles}\n{rows}\n"
    table = read_ies(text.encode()).photometry().table
    row = np.interp([first, *same], np.linspace(0.0, 360.0, 73), table[45])
    assert row[1:] == pytest.approx([row[0]] * len(same), abs=2e-3)


@pytest.mark.parametrize(
    "lamp",
    [
        {"type": "point", "intensity": -1.0},
        {"type": "point", "intensity": 1e300},
        {"type": "spot", "spot": {"innerConeAngle": 0.9, "outerConeAngle": 0.3}},
        {"type": "spot", "spot": {"outerConeAngle": 3.0}},
        {"type": "laser"},
    ],
)
def test_impossible_lamps_are_refused_in_a_sentence(
    write_square: WriteScene, lamp: dict[str, Any]
) -> None:
    """A scene file may come from anybody."""
    with pytest.raises(UserError):
        load_scene(write_square(with_lamps(lamp)))
