"""A page of a room, written by the command and opened by Chromium from disk."""

import re

import numpy as np
import pytest
from browser import Browser, chromium


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
    if chromium() is None:
        pytest.skip("needs a browser (Debian: chromium)")
    browser = Browser(tmp_path)
    try:
        browser.open(f"{written[0].as_uri()}#2026-12-21T15:00")

        def text(name):
            return browser.value(f"document.getElementById('{name}').textContent")

        assert text("clock") == "15:00"
        assert text("date") == "21 December"
        assert re.fullmatch(r"sun \d+\.\d° high", text("sun"))
        assert re.fullmatch(r"EV -?\d+\.\d", text("ev"))
        assert browser.value("document.getElementById('message').hidden")
        # No headset is there.
        assert browser.value("document.getElementById('headset').hidden")
        assert browser.errors == []
    finally:
        browser.close()
