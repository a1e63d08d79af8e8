"""The first examples that a user meets, in README.md and docs/commands.md, work as printed."""

import re
from pathlib import Path

import msgspec
import numpy as np

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
