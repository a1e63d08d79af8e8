"""A year of weather that a test may change, as text of an EPW file."""

import pytest


@pytest.fixture(scope="session")
def year_text():
    """Prague's, made by the tool; every other year of these tests is a change of its text."""
    pytest.importorskip("pvlib")
    from epw_year import epw_text

    return epw_text()


@pytest.fixture(scope="session")
def year_file(year_text, tmp_path_factory):
    path = tmp_path_factory.mktemp("weather") / "prague.epw"
    path.write_text(year_text)
    return path
