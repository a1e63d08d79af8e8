"""A page of a room, written by the command and opened by Chromium from disk."""

import re
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner
from share.command import share
from share.page_file import SCRIPT

ROOM = Path(__file__).parents[2] / "scenes" / "work" / "room.glb"
# Without a graphics card, a sandbox, or a word to anybody.
FLAGS = [
    "--headless",
    "--no-sandbox",
    "--disable-gpu",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--virtual-time-budget=60000",
]


@pytest.fixture(scope="module")
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


@pytest.mark.long
def test_the_light_of_a_page_is_that_of_the_scene(written):
    """By day to 3 % rms of its mean, as printed: interpolation, basis and bytes together."""
    path, output = written
    assert path.stat().st_size < 15e6
    lines = re.findall(r"sun (-?[\d.]+) deg: mean ([\d.,]+).* rms ([\d.]+)%", output)
    assert len(lines) == 12
    by_day = [float(rms) for height, _, rms in lines if float(height) > 5.0]
    assert len(by_day) > 5
    assert max(by_day) < 3.0
    assert np.isfinite([float(rms) for *_, rms in lines]).all()


@pytest.mark.long
def test_a_browser_opens_a_page_at_the_hour_of_its_link(written, tmp_path):
    """From disk, by WebGL2 of a processor: clock, sun and exposure are there, and no message."""
    chromium = shutil.which("chromium") or shutil.which("chromium-browser")
    if chromium is None:
        pytest.skip("needs a browser (Debian: chromium)")
    address = f"{written[0].as_uri()}#2026-12-21T15:00"
    done = subprocess.run(
        [chromium, *FLAGS, f"--user-data-dir={tmp_path}", "--dump-dom", address],
        capture_output=True,
        text=True,
        check=False,
        timeout=300,
    )
    found = done.stdout

    def text(name):
        return re.search(rf'id="{name}"[^>]*>([^<]*)<', found)[1]

    assert 'class="ready"' in found
    assert text("clock") == "15:00"
    assert text("date") == "21 December"
    assert re.fullmatch(r"sun \d+\.\d° high", text("sun"))
    assert re.fullmatch(r"EV -?\d+\.\d", text("ev"))
    assert re.search(r'id="message" role="alert" hidden', found)
