"""Path-traced truths on disk: made once, found again, never mistaken for each other."""

from dataclasses import replace

import numpy as np
import pytest

from vrut_lite_lab.path_traced import truths
from vrut_lite_lab.path_traced.cases import Case
from vrut_lite_lab.scenes import trials

NOON = Case("sundial.toml", "dynamic_skylight", "12:30")


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    monkeypatch.setattr(truths, "FOLDER", tmp_path)
    return tmp_path


def test_what_was_made_once_is_found_again(folder):
    """A second call makes nothing; no half-written file is left."""
    made = []

    def make():
        made.append(1)
        return {"radiance": np.arange(6.0).reshape(1, 2, 3)}

    assert truths.known(NOON, "picture") is None
    for _ in range(2):
        found = truths.kept(NOON, "picture", make)
        np.testing.assert_array_equal(found["radiance"], np.arange(6.0).reshape(1, 2, 3))
    assert len(made) == 1
    assert len(list(folder.iterdir())) == 1


def test_each_hour_sky_recipe_and_number_of_samples_has_a_file_of_its_own(monkeypatch, folder):
    """Any of them changes the picture, so none may be read in another's place."""
    monkeypatch.setattr(
        truths, "traced", lambda state, recipe, samples: np.zeros((1, 1, 3), np.float32)
    )
    cases = [NOON, replace(NOON, hour="20:00"), replace(NOON, sky="bruneton_sky")]
    recipes = [truths.TRUTH, truths.OTHER_TRUTH, truths.DIRECT, truths.SUN, truths.BARE_SUN]
    for case in cases:
        for recipe in recipes:
            for samples in (8, 16):
                truths.truth(case, None, recipe, samples)
    assert len(list(folder.iterdir())) == len(cases) * len(recipes) * 2
    assert truths.known_truth(NOON, truths.TRUTH, 8) is not None
    assert truths.known_truth(NOON, truths.TRUTH, 9) is None


def test_a_changed_scene_has_other_truths(tmp_path):
    """The file's bytes are part of the name."""
    path = tmp_path / "scene.glb"
    path.write_bytes(b"one")
    first = Case(str(path), "dynamic_skylight", "12:30").content
    assert Case(str(path), "dynamic_skylight", "20:00").content == first
    path.write_bytes(b"two")
    assert Case(str(path), "dynamic_skylight", "12:30").content != first


def test_trial_scenes_are_the_same_each_time_and_small():
    """Truths are kept by their bytes; each file has some tens of kilobytes."""
    once, again = trials.build(), trials.build()
    assert once == again
    assert max(map(len, once.values())) < 80_000
