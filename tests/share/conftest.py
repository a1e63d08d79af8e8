"""A page of a room, which tests of the browser share."""

from pathlib import Path

import pytest
from click.testing import CliRunner
from share.command import share
from share.page_file import SCRIPT

ROOM = Path(__file__).parents[2] / "scenes" / "work" / "room.glb"


@pytest.fixture(scope="session")
def written(tmp_path_factory):
    """The page, and what the command printed."""
    if not SCRIPT.is_file():
        pytest.skip("needs Node.js with npm: sh tools/bootstrap.sh page")
    path = tmp_path_factory.mktemp("page") / "room.html"
    arguments = [str(ROOM), "-o", str(path), "--texels", "1500", "--no-stills"]
    done = CliRunner().invoke(
        share, [*arguments, "--at", "2026-06-21T12:30"], catch_exceptions=False
    )
    assert done.exit_code == 0
    return path, done.output
