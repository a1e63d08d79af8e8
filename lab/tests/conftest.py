"""Fixtures and options that the laboratory's tests share with the product's."""

import pytest
from bruneton_sky import Atmosphere
from open_sky import lit_by_the_open_sky  # noqa: F401
from other_planet import OTHER_PLANET

pytest_plugins = ["house_fixtures"]


@pytest.fixture(scope="session")
def other_planet() -> Atmosphere:
    """A small hazy planet with four wavelengths."""
    return OTHER_PLANET
