"""A page of a room, which tests of the browser share."""

from pathlib import Path

import pytest
from click.testing import CliRunner
from share.command import share
from share.page_file import SCRIPT

# Three sensors of the room's floor, as `vrut-lite daylight` writes them.
NUMBERS = """plane,x_m,y_m,z_m,direction_x,direction_y,direction_z,daylight_factor_percent,sun_h
room 1,-1,0.85,0,0,1,0,0.5,0
room 1,0,0.85,0,0,1,0,2,1.5
room 1,1,0.85,0,0,1,0,8,3
"""
ROOM = Path(__file__).parents[2] / "scenes" / "work" / "room.glb"


@pytest.fixture(scope="session")
def written(tmp_path_factory):
    """The page, and what the command printed."""
    if not SCRIPT.is_file():
        pytest.skip("needs Node.js with npm: sh tools/bootstrap.sh page")
    path = tmp_path_factory.mktemp("page") / "room.html"
    table = path.with_name("numbers") / "sensors.csv"
    table.parent.mkdir()
    table.write_text(NUMBERS)
    arguments = [str(ROOM), "-o", str(path), "--texels", "1500", "--no-stills"]
    arguments += ["--numbers", str(table.parent)]
    done = CliRunner().invoke(
        share, [*arguments, "--at", "2026-06-21T12:30"], catch_exceptions=False
    )
    assert done.exit_code == 0
    return path, done.output
