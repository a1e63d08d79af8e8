"""What a notebook shows, and that docs/notebook.md runs as printed, here with a smaller scene."""

import importlib.util
import re
import threading
from io import BytesIO
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from vrut_lite.errors import UserError
from vrut_lite.geometry.preview import fisheyes_png
from vrut_lite.notebook import LitScene
from vrut_lite.pictures.picture import Picture

ROOT = Path(__file__).parents[1]
PAGE = (ROOT / "docs" / "notebook.md").read_text(encoding="utf-8")
CELLS = re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL)


def pixels_of(png):
    return np.asarray(Image.open(BytesIO(png)))


def shown(cell, names):
    """What a notebook shows of a cell: the value of its last line."""
    *lines, last = cell.strip().splitlines()
    exec("\n".join(lines), names)
    return eval(last, names)


def test_skies_of_the_page_show_themselves():
    """A fisheye, brightest to the south where the sun is, white outside; four for a solved air."""
    names = {}
    one = pixels_of(shown(CELLS[0], names)._repr_png_())
    four = pixels_of(shown(CELLS[1], names)._repr_png_())
    height, width = one.shape[:2]
    assert height == width
    assert (one[0, 0] == 255).all()
    assert one[: height // 2, width // 2].mean() < one[height // 2 :, width // 2].mean()
    assert four.shape[0] == height
    assert four.shape[1] > 4 * width


def test_a_black_sky_is_black():
    """No exposure brightens it."""
    seen = pixels_of(fisheyes_png([np.zeros((6, 4, 4, 3), np.float32)], size=16))
    assert not seen[8, 8].any()


def test_a_picture_shows_its_display_values():
    """As PNG, to the byte."""
    display = np.arange(24, dtype=np.uint8).reshape(2, 4, 3)
    picture = Picture(np.zeros((2, 4, 3), np.float32), display, 10.0)
    np.testing.assert_array_equal(pixels_of(picture._repr_png_()), display)


@pytest.mark.long
def test_the_study_s_figure_shows_itself():
    """The page's last cell: two rows of three tiles."""
    figure = shown(CELLS[5], {})
    assert pixels_of(figure._repr_png_()).shape == figure.image.shape
    assert f"<figcaption>{figure.title}</figcaption>" in figure._repr_html_()


@pytest.mark.gl
def test_a_scene_shows_itself_and_follows_the_hour(monkeypatch):
    """The page's scene (here a sundial, smaller): by night darker than by day, an exact hour."""
    monkeypatch.chdir(ROOT)
    names = {}
    cell = CELLS[2].replace("street.toml", "sundial.toml").replace("(480, 270)", "(48, 28)")
    scene = shown(cell, names)
    with scene:
        assert pixels_of(scene._repr_png_()).shape == (28, 48, 3)
        dusk = shown(CELLS[3].replace("(240, 20)", "(24, 2)"), names)
        assert scene.project.at == "2026-06-21T20:30"
        assert "2026-06-21 20:30 CEST, sun 5.1° high" in scene._repr_html_()
        assert dusk.radiance.mean() < 0.5 * scene.at("2026-06-21T13:00").radiance.mean()
        if importlib.util.find_spec("anywidget") is None:
            with pytest.raises(UserError, match="extra `notebook`"):
                scene.slider()
            return
        slider = shown(CELLS[4], names)
        assert slider.hour == pytest.approx(13.0)
        before = slider.picture
        slider.hour = 20.5
        assert slider.picture != before
        assert scene.project.at == "2026-06-21T20:30"


@pytest.mark.gl
def test_cells_that_run_again_keep_two_scenes_open(monkeypatch):
    """A notebook keeps what its cells have shown: each run kept an OpenGL context, some 190 MB.
    One that was freed opens again; a closed one says so, however often it is closed."""
    monkeypatch.chdir(ROOT)

    def opened():
        return sum(thread.name.startswith("gl-owner") for thread in threading.enumerate())

    before = opened()
    scenes = [LitScene("scenes/sundial.toml", size=(32, 18)) for _ in range(3)]
    assert opened() - before == 2
    first = scenes[0].at(9.0)
    assert first.display.shape == (18, 32, 3)
    assert opened() - before == 2
    for _ in range(2):
        scenes[0].close()
    assert opened() - before == 1
    np.testing.assert_array_equal(pixels_of(scenes[0]._repr_png_()), first.display)
    with pytest.raises(UserError, match=r"sundial.* is closed"):
        scenes[0].at(10.0)
    for scene in scenes:
        scene.close()
    assert opened() == before


def test_a_wrong_field_is_said_in_a_sentence():
    """Before any renderer is opened."""
    with pytest.raises(UserError, match="hour"):
        LitScene("scenes/sundial.toml", hour=12)
