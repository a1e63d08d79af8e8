"""The README's examples work as printed."""

import re
from pathlib import Path

import msgspec
import numpy as np
import pytest

from vrut_lite.project import Project, daylight_inputs

ROOT = Path(__file__).parents[1]
README = (ROOT / "README.md").read_text()


def blocks(language):
    return re.findall(rf"```{language}\n(.*?)```", README, re.DOTALL)


def test_the_python_example_runs():
    """Pasted into an interpreter it gives a sky."""
    (source,) = blocks("python")
    names: dict = {}
    exec(source, names)
    assert np.isfinite(names["sky"].radiance(theta_rad=0.5, gamma_rad=0.3)).all()
    assert 20.0 < np.degrees(names["sun"].elevation_rad) < 26.0


def test_the_project_file_is_one():
    """The TOML example is a valid project file."""
    (source,) = blocks("toml")
    project = msgspec.toml.decode(source, type=Project)
    assert (ROOT / "scenes" / project.scene).exists()
    assert len(daylight_inputs(project)) == 2


@pytest.mark.parametrize("path", re.findall(r"\]\(([^)h][^)]*)\)", README))
def test_links_lead_somewhere(path):
    """Every picture and file that the README links is in the repository."""
    assert (ROOT / path).exists()
