"""The documentation's examples work as printed, and what its pages name is there."""

import re
from pathlib import Path

import msgspec
import numpy as np

from tools.who_hears_what import PAGE, handled, message_types
from vrut_lite.project import Project, daylight_inputs

ROOT = Path(__file__).parents[1]


def blocks(page, language):
    return re.findall(rf"```{language}\n(.*?)```", (ROOT / page).read_text(), re.DOTALL)


def test_the_python_example_runs():
    """Pasted into an interpreter it gives a sky."""
    (source,) = blocks("README.md", "python")
    names: dict = {}
    exec(source, names)
    assert np.isfinite(names["sky"].radiance(theta_rad=0.5, gamma_rad=0.3)).all()
    assert 20.0 < np.degrees(names["sun"].elevation_rad) < 26.0


def test_the_project_file_is_one():
    """The TOML example is a valid project file."""
    (source,) = blocks("docs/commands.md", "toml")
    project = msgspec.toml.decode(source, type=Project)
    assert (ROOT / "scenes" / project.scene).exists()
    assert len(daylight_inputs(project)) == 2


def test_the_examples_of_the_bruneton_page_run() -> None:
    """One after the other, as a reader copies them: shapes, and light that is some."""
    names: dict[str, np.ndarray] = {}
    for source in blocks("docs/bruneton.md", "python"):
        exec(source, names)
    assert names["spectral"].shape == names["rgb"].shape == (91, 3)
    assert names["cube"].shape == (6, 64, 64, 3)
    for name in ("spectral", "rgb", "added", "passed", "cube", "seen", "radiance", "before"):
        assert np.all(np.isfinite(names[name]) & (names[name] > 0.0)), name


def test_the_example_of_the_page_on_polarisation_runs() -> None:
    """I, Q, U and degrees of a whole meridian, as the page says."""
    names: dict[str, np.ndarray] = {}
    for source in blocks("docs/polarisation.md", "python"):
        exec(source, names)
    assert names["stokes"].shape == (91, 3, 3)
    assert names["degree"].shape == (91, 3)


def test_every_test_that_docs_app_names_exists():
    """The page names a test for each thing that the window can do."""
    page = (ROOT / "docs" / "app.md").read_text(encoding="utf-8")
    files = {
        path.stem: path.read_text(encoding="utf-8") for path in ROOT.glob("tests/**/test_*.py")
    }
    known = set(files) | {
        name for text in files.values() for name in re.findall(r"^def (test_\w+)", text, re.M)
    }
    named = set(re.findall(r"`(test_\w+)`", page))
    assert len(named) > 50
    assert not named - known


def test_who_hears_what_names_every_message_and_who_handles_it():
    """After a change: python -m tools.who_hears_what."""
    rows = [line.split("|")[1:-1] for line in PAGE.read_text().splitlines() if "| `" in line]
    said = {row[0].strip(" `"): set(filter(None, row[-1].strip().split(", "))) for row in rows}
    hears = handled()
    assert said == {kind.__name__: hears[kind.__name__] for kind in message_types()}
