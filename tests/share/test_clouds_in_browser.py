"""A page of a room under cumulus, written by the command and opened by Chromium from disk."""

import re

import numpy as np
import pytest
from browser import Browser, chromium
from click.testing import CliRunner
from conftest import ROOM
from share.command import share
from share.page_file import SCRIPT


@pytest.fixture(scope="session")
def cloudy(tmp_path_factory):
    """The page, and what the command printed."""
    if not SCRIPT.is_file():
        pytest.skip("needs Node.js with npm: sh tools/bootstrap.sh page")
    path = tmp_path_factory.mktemp("clouds") / "room.html"
    arguments = [str(ROOM), "-o", str(path), "--texels", "1500", "--no-stills"]
    arguments += ["--genus", "Cu", "--coverage", "0.4", "--wind-speed-m-s", "0"]
    done = CliRunner().invoke(
        share, [*arguments, "--at", "2026-06-21T12:30"], catch_exceptions=False
    )
    assert done.exit_code == 0
    return path, done.output


@pytest.mark.long
def test_the_light_of_a_cloudy_page_is_that_of_the_scene(cloudy):
    """By day to 8 % rms of its mean: the sun's light on each cloud is known at 67 places alone."""
    _, output = cloudy
    assert "left out" not in output
    lines = re.findall(r"sun (-?[\d.]+) deg: mean ([\d.,]+).* rms ([\d.]+)%", output)
    by_day = [float(rms) for height, _, rms in lines if float(height) > 5.0]
    assert len(by_day) > 5
    assert max(by_day) < 8.0


@pytest.mark.long
def test_pictures_light_map_and_sun_are_behind_the_same_clouds(cloudy, tmp_path):
    """High above the scene, half a cube of pictures and one of the sun's disc sum to the sky and
    the sun that light open ground; the sun's rays are those of a clear hour times what passes; and
    so from hour to hour."""
    if chromium() is None:
        pytest.skip("needs a browser (Debian: chromium)")
    browser = Browser(tmp_path)
    try:
        browser.open(f"{cloudy[0].as_uri()}#2026-06-21T17:00")
        script = """(() => {
            const page = window.daylight, { view } = page, { clouds, open, shared, table } = view;
            page.frame = () => {};
            page.lightHour(false);
            const found = [], suns = [], point = view.camera.position.clone().set(0, 300, 0);
            const scale = shared.open_scale.value, key = shared.key_irradiance.value.toArray();
            for (let k = 0; k < open.normals.length; k += 7) {
                const normal = open.normals[k], cosine = Math.max(normal.dot(view.keyDirection), 0);
                const sum = [0, 1, 2].map((c) => scale * open.values[4 * k + c] + cosine * key[c]);
                found.push([sum, view.points.irradiance(point, normal, normal)]);
            }
            for (let minute = 360; minute <= 1200; minute += 5) {
                page.setHour(page.day, minute);
                page.lightHour(false);
                const clear = table.of('key', view.sun.trueRad)[1];
                const passed = clouds.transmittance(view.keyDirection);
                suns.push([shared.key_irradiance.value.y / clear, passed, open.left]);
            }
            return [found, suns];
        })()"""
        found, suns = browser.value(script)
        by_table, gathered = np.array(found).transpose(1, 0, 2)
        assert gathered == pytest.approx(by_table, rel=0.05)
        sun, passed, left = np.array(suns).T
        assert sun == pytest.approx(passed, abs=1e-6)
        # The sun comes out and goes; what clouds send to the ground changes slowly.
        assert passed.max() > 0.9
        assert passed.min() < 0.01
        assert np.abs(np.diff(np.log(left))).max() < 0.2
        assert browser.errors == []
    finally:
        browser.close()
