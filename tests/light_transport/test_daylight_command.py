"""The command `vrut-lite daylight`: files that it writes, and one line for bad input."""

import csv

import numpy as np
import pytest
from click.testing import CliRunner
from light_transport.daylight_numbers.command import daylight

from vrut_lite.errors import UserError


def run(*arguments):
    found = CliRunner().invoke(daylight, [str(a) for a in arguments], catch_exceptions=False)
    assert found.exit_code == 0
    return found.output


def test_bad_sensors_are_refused_before_the_scene_is_opened(tmp_path):
    path = tmp_path / "desks.csv"
    path.write_text("1,2,nan\n")
    with pytest.raises(UserError, match="no finite point"):
        run("none.glb", "-o", tmp_path / "out", "--sensors", path)


@pytest.mark.long
def test_a_room_has_its_tables_plans_and_page(tmp_path):
    """By the installed sky, through the real kernel."""
    said = run("scenes/work/indoor.glb", "-o", tmp_path, "--grid", 1, "--at", "2026-03-21T12:00")
    assert "room 1" in said
    rows = list(csv.DictReader((tmp_path / "sensors.csv").open()))
    arrays = np.load(tmp_path / "sensors.npz")
    lux = np.array([float(row["illuminance_lx"]) for row in rows])
    np.testing.assert_allclose(lux, arrays["illuminance_lx"], rtol=1e-5)
    parts = sum(arrays[f"of_{part}_lx"] for part in ("sun", "sky", "surfaces"))
    np.testing.assert_allclose(parts, arrays["illuminance_lx"])
    assert (arrays["illuminance_error_lx"] < 0.05 * lux).all()
    page = (tmp_path / "report.html").read_text()
    assert page.count("data:image/png;base64,") == 3
    assert "CIE sky type 16" in page
