"""The check of a graphics card, with what OpenGL there is: parts, their limits, and the page."""

import json

import pytest

from vrut_lite_lab.card_check import parts
from vrut_lite_lab.card_check.page import write_page
from vrut_lite_lab.card_check.parts import run_parts


@pytest.mark.gl
def test_a_part_writes_what_it_found_and_the_page_names_the_card(tmp_path):
    """The driver's part, in its own process; the others are said to be missing."""
    run_parts(tmp_path, ["driver"])
    write_page(tmp_path)
    found = json.loads((tmp_path / "driver.json").read_text())
    page = (tmp_path / "card.md").read_text()
    assert page.startswith(f"# Checked on {found['card']}\n")
    assert f"| GL_MAX_SAMPLES | {found['limits']['GL_MAX_SAMPLES']} |" in page
    assert page.count("not run") == len(parts.PARTS) - 1


def test_a_part_that_takes_too_long_is_stopped_and_said_so(tmp_path, monkeypatch, capsys):
    """What it had found by then stays; the next part is done."""
    slow = parts.CheckPart("Slow", 0.2, "driver")
    monkeypatch.setattr(parts, "PARTS", {**parts.PARTS, "driver": slow})
    (tmp_path / "driver.json").write_text('{"card": "before"}')
    run_parts(tmp_path, ["driver", "driver"])
    assert capsys.readouterr().out.count("stopped at its limit") == 2
    found, end = parts.result(tmp_path, "driver")
    assert found == {"card": "before"}
    assert end["ended"].startswith("stopped")


def test_the_page_shows_what_differs_and_what_failed(tmp_path):
    """A product that raised is a row, and a failed test is named."""
    (tmp_path / "driver.json").write_text(
        json.dumps(dict.fromkeys(("card", "version", "vendor", "chosen", "python"), "x"))[:-1]
        + ', "trial_ns": 1, "open_s": 1, "cores": 1, "limits": {}}'
    )
    bad = {"worst": 0.5, "where": [1, 2], "rms": 0.1, "not_finite": 3}
    (tmp_path / "parity.json").write_text(json.dumps({"cube": bad, "air": {"error": "lost"}}))
    tests = {"tests": 5, "skipped": 1, "failed": {"a::b": "not equal"}}
    (tmp_path / "tests.json").write_text(json.dumps(tests))
    write_page(tmp_path)
    page = (tmp_path / "card.md").read_text()
    for line in (
        "| cube | 5.0e-01 | [1, 2] | 1.0e-01 | 3 |",
        "| air | lost |",
        "* `a::b`: not equal",
    ):
        assert line in page
    assert "5 tests, 1 skipped, 1 failed." in page
