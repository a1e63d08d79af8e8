"""The tool that measures fronts finds every module's knobs, and measures those of any module."""

import numpy as np

from vrut_lite.messages.tolerance import MeasuredFronts, read_fronts
from vrut_lite_lab.tolerance_fronts import declared_knobs, front_lines, measure

THIRD_SKY = """
from pathlib import Path
import numpy as np
from vrut_lite_lab.tolerance.knobs import Knob, ToleranceKnobs
from vrut_lite.kernel.module import Manifest, Module

class ThirdSky(Module):
    manifest = Manifest(name="third_sky", title="Third sky", version="1")

KNOBS = ToleranceKnobs(
    fronts=Path(__file__).parent / "fronts.json",
    knobs={
        "size": Knob(
            (8, 16),
            lambda sample, truth: np.array([[sample / 8.0, sample / 16.0]]),
            lambda size: float(size * size),
            lambda size: None,
        )
    },
    samples=lambda pictures: ([0.01 * n for n in range(pictures)], [0.5]),
    truth=lambda sample: [np.ones(3)],
    picture_errors=lambda sample, truth, tolerance: [tolerance / 2.0],
)
"""


def test_both_skies_declare_the_knobs_whose_fronts_they_bring() -> None:
    """A front without a knob could not be measured again, a knob without a front not chosen."""
    declared = declared_knobs()
    assert {"bruneton_sky", "dynamic_skylight"} <= set(declared)
    for name, knobs in declared.items():
        bundled = read_fronts(knobs.fronts)
        assert bundled.module == name
        assert set(bundled.fronts) == set(knobs.knobs)
        for knob, front in bundled.fronts.items():
            assert [point.choice for point in front] == list(knobs.knobs[knob].choices)
            work = knobs.knobs[knob].work
            assert [point.work for point in front] == [work(point.choice) for point in front]


def test_a_third_sky_gets_a_front(tmp_path) -> None:
    """A module of one file in a folder, unknown to the tool: its errors, work and pictures."""
    (tmp_path / "third_sky.py").write_text(THIRD_SKY)
    knobs = declared_knobs((tmp_path,))["third_sky"]
    measuring, _ = knobs.samples(101)
    found: MeasuredFronts = measure("third_sky", knobs, measuring, knobs.truth)
    assert found.pictures == 101
    small, large = found.fronts["size"]
    assert (small.choice, small.work, large.work) == (8, 64.0, 256.0)
    np.testing.assert_allclose([small.error, large.error], [0.99 / 8.0, 0.99 / 16.0])
    assert len(list(front_lines(found))) == 4
