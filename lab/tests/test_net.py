"""The net of a restructuring says what differs between two folders of pictures."""

import numpy as np
import pytest

pytest.importorskip("flip_evaluator", reason="flip-evaluator of the extra ref is not installed")
pytest.importorskip("mitsuba", reason="mitsuba of the extra ref is not installed")

from vrut_lite_lab import net

BRIGHT = np.full((6, 8, 3), 5.0, np.float32)


def folder_of(path, digests=("journals/day 1 sun SunMoved aa",), **pictures):
    """A folder as the net makes it, of some pictures' radiance."""
    (path / "pictures").mkdir(parents=True)
    for name, radiance in pictures.items():
        np.savez_compressed(path / "pictures" / f"{name}.npz", radiance=radiance)
    (path / "digests.txt").write_text("\n".join(digests) + "\n")
    return path


def test_equal_folders_pass(tmp_path, capsys):
    """A move that changes nothing is let through, and says how much was compared."""
    before, after = (folder_of(tmp_path / name, noon=BRIGHT) for name in ("a", "b"))
    assert net.compare(before, after, net.BOUND)
    assert "1 of 1 files are equal" in capsys.readouterr().out


def test_a_changed_pixel_is_named(tmp_path, capsys):
    """The picture, the largest difference and the root of the mean square say where to look."""
    changed = BRIGHT.copy()
    changed[2, 3] *= 1.1
    before = folder_of(tmp_path / "a", noon=BRIGHT, dusk=BRIGHT)
    after = folder_of(tmp_path / "b", noon=BRIGHT, dusk=changed)
    assert not net.compare(before, after, net.BOUND)
    said = capsys.readouterr().out
    assert "dusk.npz: radiance largest 1.00e-01, rms 1.44e-02, FLIP" in said
    assert "noon" not in said
    assert net.compare(before, after, bound=0.02), "the bound is of the root of the mean square"


@pytest.mark.parametrize("changed", ["picture", "digest"])
def test_what_is_missing_fails(tmp_path, changed):
    """A picture that is not drawn any more, or a message that is not posted, is no small change."""
    before = folder_of(tmp_path / "a", noon=BRIGHT, dusk=BRIGHT)
    if changed == "picture":
        after = folder_of(tmp_path / "b", noon=BRIGHT)
    else:
        after = folder_of(tmp_path / "b", digests=(), noon=BRIGHT, dusk=BRIGHT)
    assert not net.compare(before, after, net.BOUND)


def test_a_night_is_compared_as_a_day_is():
    """Radiance of 1e-6 that changes by a tenth is a difference of a tenth."""
    found = net.difference(BRIGHT * np.float32(1.1e-6), BRIGHT * np.float32(1e-6))
    assert found.largest == pytest.approx(0.1, rel=1e-4)
    assert found.rms == pytest.approx(0.1, rel=1e-4)


def test_a_value_that_is_not_a_number_fails():
    """NaN compares as false with all, and would pass any bound."""
    broken = BRIGHT.copy()
    broken[0, 0] = np.nan
    assert net.difference(broken, BRIGHT).rms == np.inf


def test_rounding_stays_below_the_bound():
    """What the files lose must not be taken for a change."""
    values = np.random.default_rng(1).lognormal(-3.0, 5.0, 1000).astype(np.float32)
    assert net.difference(net.rounded(values), values).largest < 2.0**-11


def test_every_bundled_scene_is_drawn():
    """A scene that is added is in the net without being listed."""
    names = set(net.all_scenes())
    assert {"street", "work_room", "work_planet", "large_planet", "large_terrain"} <= names
