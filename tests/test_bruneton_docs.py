"""The Python examples of docs/bruneton.md run as printed and say what the page says."""

import re
from pathlib import Path

import numpy as np

PAGE = (Path(__file__).parents[1] / "docs" / "bruneton.md").read_text(encoding="utf-8")


def test_the_examples_run() -> None:
    """One after the other, as a reader copies them: shapes, and light that is some."""
    names: dict[str, np.ndarray] = {}
    for source in re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL):
        exec(source, names)
    assert names["spectral"].shape == names["rgb"].shape == (91, 3)
    assert names["cube"].shape == (6, 64, 64, 3)
    for name in ("spectral", "rgb", "added", "passed", "cube", "seen", "radiance", "before"):
        assert np.all(np.isfinite(names[name]) & (names[name] > 0.0)), name


def test_pictures_are_there() -> None:
    """What the page shows is in the repository."""
    for link in re.findall(r"\]\((pictures/[^)]+)\)", PAGE):
        assert (Path(__file__).parents[1] / "docs" / link).exists(), link
