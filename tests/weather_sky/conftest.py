"""A year of weather that a test may change, as text of an EPW file."""

import importlib.util
from pathlib import Path

import pytest

_TOOL = Path(__file__).parents[2] / "tools" / "weather_year" / "epw_year.py"


@pytest.fixture(scope="session")
def year_text():
    """Prague's, made by the tool; every other year of these tests is a change of its text."""
    pytest.importorskip("pvlib")
    spec = importlib.util.spec_from_file_location("epw_year", _TOOL)
    tool = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(tool)
    return tool.epw_text()


@pytest.fixture(scope="session")
def year_file(year_text, tmp_path_factory):
    path = tmp_path_factory.mktemp("weather") / "prague.epw"
    path.write_text(year_text)
    return path
