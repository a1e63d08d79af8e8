"""Writes what version 1.0 wrote, for the test that later versions open it: tests/promises/1.0.

    python tests/promises/write_kept.py

Files of a released version are never written again; a later version that writes something else gets
a folder of its own beside it.
"""

import json
import os
import sys
from pathlib import Path

import msgspec

from vrut_lite import cli
from vrut_lite.app.json_files import write_object
from vrut_lite.app.panels.presets import PresetStore
from vrut_lite.app.window.kept import Kept, WindowShape
from vrut_lite.atmosphere.aerosols.own import OwnAerosol
from vrut_lite.messages.glazing import Glazing
from vrut_lite.messages.placement import PlacedFile, Placement
from vrut_lite.project import CameraView, Exposure, Haze, Project, load_project, save_project

FOLDER = Path(__file__).parent / "1.0"
YARD = """v 0 0 0
v 4 0 0
v 4 0 4
v 0 0 4
v 0 3 0
v 4 3 0
f 4 3 2 1
f 1 2 6 5
"""
# Two skies, clouds and the night over a scene.
SCRIPT = (
    ("SetSetting", {"module": "clouds", "name": "genus", "value": "Cu"}),
    ("SetSetting", {"module": "clouds", "name": "coverage", "value": 0.4}),
    ("ChooseSlot", {"slot": "sky", "module": "bruneton_sky"}),
    ("SetClock", {"instant": "2026-06-21T10:00:00Z"}),
    ("SetHaze", {"optical_depth_550": 0.3, "aerosol": "urban"}),
    ("MoveCamera", {"eye_m": [6.0, 2.0, 8.0], "target_m": [2.0, 1.0, 2.0],
                    "vertical_field_of_view_rad": 0.7}),
    ("SetSetting", {"module": "clouds", "name": "coverage", "value": 0.0}),
    ("ChooseSlot", {"slot": "sky", "module": "dynamic_skylight"}),
    ("SetClock", {"instant": "2026-06-24T22:00:00Z"}),
    ("SetPlace", {"latitude_deg": 49.2, "longitude_deg": 16.6, "altitude_m": 230.0,
                  "north_offset_rad": 0.2}),
)  # fmt: skip
CAMERA = CameraView(
    eye_m=(6.0, 2.0, 8.0), target_m=(2.0, 1.0, 2.0), vertical_field_of_view_deg=50.0
)
PROJECT = Project(
    air=False,
    light_shafts=True,
    animation="clock",
    animation_time_s=2.5,
    section="x",
    section_at=0.25,
    shows="illuminance",
    polariser_deg=30.0,
    section_keeps="above",
    scene="yard.obj",
    placement=Placement(up="z", metres_per_unit=0.01, position_m=(1.0, 2.0, 3.0), heading_deg=15.0),
    beside=(PlacedFile(scene="yard.obj", placement=Placement(heading_deg=90.0)),),
    scene_camera="front",
    luminaires={"lamp": "lamp.ies"},
    variant="red",
    place="49.2,16.6,230",
    at="2026-06-21T16:00:00+02:00",
    north_offset_deg=12.0,
    slots={"sky": "bruneton_sky", "sun": "dynamic_skylight"},
    settings={
        "clouds": {"genus": "Cu", "coverage": 0.4},
        "bruneton_sky": {"turbidity": "none"},
    },
    camera=CAMERA,
    views={"front": CAMERA},
    exposure=Exposure(
        mode="manual",
        ev100=14.0,
        compensation_ev=0.5,
        tone_map="exponential",
        white_temperature_k=5000.0,
        white_duv=0.01,
        night_look="exposure",
        glare=0.3,
    ),
    size=(320, 180),
    tolerance=0.02,
    haze=Haze(
        optical_depth_550=0.3,
        aerosol="maritime-clean",
        humidity_percent=60.0,
        own=OwnAerosol(angstrom_exponent=1.1, albedo=0.9, asymmetry=0.6, scale_height_m=1500.0),
        nitrogen_dioxide_du=0.4,
        scale_height_m=1500.0,
        stratosphere_depth_550=0.01,
        stratosphere_peak_km=20.0,
    ),
    ground="grass",
    weather="prague.epw",
    sensors="desks.csv",
    glazing={"pane": Glazing(0.7, colour=(0.9, 1.0, 0.9), panes=3)},
)
PRESET = {"genus": "Cu", "coverage": 0.4, "base_m": 1200.0}
SHAPE = WindowShape(geometry=b"a window's geometry", docks=b"its docks")
SESSION = Project(
    scene="yard.obj", at="2026-06-21T16:00:00+02:00", place="49.2,16.6,230", camera=CAMERA
)


def main() -> None:
    """Write all, with this version's code."""
    FOLDER.mkdir(exist_ok=True)
    os.chdir(FOLDER)
    Path("yard.obj").write_text(YARD, encoding="utf-8")
    for field in msgspec.structs.fields(Project):
        if getattr(PROJECT, field.name) == field.default:
            raise SystemExit(f"the project leaves {field.name} at its default")
    save_project("project.toml", PROJECT)
    if load_project("project.toml") != PROJECT:
        raise SystemExit("the project is not read as it was written")
    PresetStore(Path("presets")).keep("clouds", "Evening", PRESET)
    state = Path("state")
    Kept(state).keep_session(SESSION)
    Kept(state).keep_shape(SHAPE)
    # The window writes whole paths, which are of one machine.
    file = state / "window.json"
    write_object(file, {**json.loads(file.read_text(encoding="utf-8")), "recent": ["yard.obj"]})
    script = Path("script.jsonl")
    lines = (json.dumps({"input": kind, "message": message}) for kind, message in SCRIPT)
    script.write_text("\n".join(lines), encoding="utf-8")
    sys.argv = [
        *("vrut-lite", "record", "yard.obj", "-o", "session.mcap", "--inputs", str(script)),
        *("--size", "8", "--sky", "dynamic_skylight", "--at", "2026-06-21T18:00"),
    ]
    cli.main()
    script.unlink()


if __name__ == "__main__":
    main()
