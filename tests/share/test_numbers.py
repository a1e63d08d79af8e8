"""Numbers of `vrut-lite daylight` that a page shows: their names, units and places."""

from pathlib import Path

import numpy as np
import pytest
from share.numbers import numbers_of

from vrut_lite.errors import UserError
from vrut_lite.scene.loading import load_scene
from vrut_lite.scene.packing import packed

ROOM = Path(__file__).parents[2] / "scenes" / "work" / "room.glb"
HEAD = "plane,x_m,y_m,z_m,direction_x,direction_y,direction_z"


@pytest.fixture(scope="module")
def room():
    return packed(load_scene(ROOM))


def written(folder, columns, *rows):
    text = "\n".join([f"{HEAD},{columns}", *rows]) + "\n"
    (folder / "sensors.csv").write_text(text)
    return folder


def test_columns_become_quantities_with_units_and_errors_are_left_out(room, tmp_path):
    """An empty cell is no number: not every sensor has every quantity."""
    folder = written(
        tmp_path,
        "illuminance_lx,illuminance_error_lx,of_sun_lx,da_300_percent,dose_klxh,sky_view",
        "room 1,0,0.85,0,0,2,0,1200,3,900,45,,0.02",
        "room 1,0.5,0.85,0,0,1,0,800,2,0,50,7,0.01",
    )
    found = numbers_of(folder, room)
    named = dict(zip(found.names, found.units, strict=True))
    assert named == {
        "illuminance": "lx",
        "illuminance of sun": "lx",
        "DA 300": "%",
        "dose": "klx h",
        "sky view": "",
    }
    assert found.values.shape == (5, 2)
    assert np.isnan(found.values[3, 0])
    assert found.spacing_m == pytest.approx(0.5)
    assert found.direction[0] == pytest.approx([0.0, 1.0, 0.0])


@pytest.mark.parametrize(
    ("columns", "rows", "said"),
    [
        ("sun_h", ["a,900,0,0,0,1,0,1"], "of another scene: 1 of its 1 sensors"),
        ("sun_h", ["a,,0.85,0,0,1,0,1"], "a sensor whose place is no number"),
        ("sun_h", ["a,0,0.85,0,0,1,0,"], "places, but no number to show"),
        ("sun_h", [], "no sensors with a column x_m"),
    ],
)
def test_a_table_that_is_not_of_the_scene_is_refused_in_a_sentence(
    room, tmp_path, columns, rows, said
):
    with pytest.raises(UserError, match=said):
        numbers_of(written(tmp_path, columns, *rows), room)


def test_a_folder_without_numbers_is_refused_with_what_writes_them(room, tmp_path):
    with pytest.raises(UserError, match="name a folder that `vrut-lite daylight` wrote"):
        numbers_of(tmp_path, room)
