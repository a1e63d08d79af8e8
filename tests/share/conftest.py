"""A page of a room for tests of the browser, and Node.js beside the page's sources."""

import json
import shutil
import subprocess
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
ROOT = Path(__file__).parents[2]
ROOM = ROOT / "scenes" / "work" / "room.glb"
PACKAGES = ROOT / ".page" / "node_modules"


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


@pytest.fixture(scope="session")
def node(tmp_path_factory):
    """A function that runs a script beside the page's sources and returns what it prints."""
    if shutil.which("node") is None:
        pytest.skip("needs Node.js (Debian: nodejs)")
    if not (PACKAGES / "three").is_dir():
        pytest.skip("needs npm's three and astronomy-engine: sh tools/bootstrap.sh page")
    folder = tmp_path_factory.mktemp("page")
    shutil.copytree(ROOT / "modules" / "share" / "page" / "src", folder / "src")
    (folder / "package.json").write_text('{"type": "module"}')
    (folder / "node_modules").symlink_to(PACKAGES)

    def run(script, given, content=b""):
        (folder / "given.json").write_text(json.dumps(given))
        (folder / "content.bin").write_bytes(content)
        read = "const given = JSON.parse(readFileSync('given.json', 'utf8'));"
        imports = "import { readFileSync } from 'node:fs';"
        (folder / "run.js").write_text(f"{imports}\n{read}\n{script}")
        done = subprocess.run(
            ["node", "run.js"], cwd=folder, capture_output=True, text=True, check=False
        )
        assert done.returncode == 0, done.stderr
        return json.loads(done.stdout)

    return run
