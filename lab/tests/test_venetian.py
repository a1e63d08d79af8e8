"""The venetian blind that measured glazing is tried with, against geometry and energy."""

import numpy as np
import pytest
from daylight_numbers.glazing.angle_basis import KLEMS_FULL
from daylight_numbers.glazing.window_xml import read_window_xml

from vrut_lite_lab.radiance.venetian import VenetianBlind, transmission_of, window_xml_of


def gap(blind, directions):
    """Share of light that passes between slats: what their shadows leave of a period."""
    tilt = np.radians(blind.tilt_deg)
    slope = directions[:, 1] / directions[:, 2]
    shadow_m = blind.width_m * np.abs(np.sin(tilt) - np.cos(tilt) * slope)
    return np.maximum(1.0 - shadow_m / blind.apart_m, 0.0)


@pytest.mark.parametrize("tilt_deg", [0.0, 30.0, -50.0])
def test_black_slats_pass_what_their_shadows_leave(tilt_deg):
    """In each patch the mean over its directions, of which a fine grid has many."""
    blind = VenetianBlind(tilt_deg=tilt_deg, reflectance=0.0)
    found = KLEMS_FULL.projected_sr @ transmission_of(blind, 4096)
    random = np.random.default_rng(2)
    sine2, turn = random.random(400_000), 2 * np.pi * random.random(400_000)
    level = np.sqrt(sine2)
    ways = np.stack([level * np.cos(turn), level * np.sin(turn), np.sqrt(1 - sine2)], axis=1)
    patch = KLEMS_FULL.patch_of(ways)
    truth = np.bincount(patch, gap(blind, ways)) / np.bincount(patch)
    assert np.abs(found - truth).max() < 0.04
    assert abs((found - truth).mean()) < 0.002


def test_brighter_slats_pass_more_and_never_all(tmp_path):
    """What does not pass is absorbed or sent back; light that goes up passes straight."""
    passed = [
        KLEMS_FULL.projected_sr @ transmission_of(VenetianBlind(reflectance=share), 128)
        for share in (0.0, 0.5, 0.9)
    ]
    assert passed[0].mean() < passed[1].mean() < passed[2].mean() < 1.0
    path = tmp_path / "blind.xml"
    path.write_text(window_xml_of("blind", transmission_of(VenetianBlind(), 256)))
    found = read_window_xml(path)
    assert found.warnings() == []
    # Slats tilted down outdoors let light pass that goes up.
    up, down = (
        KLEMS_FULL.patch_of(np.array([0.0, y, 1.0]) / np.hypot(y, 1.0)) for y in (0.5, -0.5)
    )
    assert found.straight[up] > 2.0 * found.straight[down]
