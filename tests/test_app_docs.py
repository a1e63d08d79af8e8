"""docs/app.md names a test for each thing the window can do: they must exist."""

import re
from pathlib import Path

ROOT = Path(__file__).parents[1]


def test_every_test_that_the_page_names_exists():
    """Files and functions by name, and pictures by path."""
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
    pictures = re.findall(r"\]\((pictures/[\w.]+)\)", page)
    assert len(pictures) >= 6
    assert all((ROOT / "docs" / picture).is_file() for picture in pictures)
