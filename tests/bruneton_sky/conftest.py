"""Atmospheres that the tests share."""

import pytest
from bruneton_sky import Atmosphere
from other_planet import OTHER_PLANET


@pytest.fixture(scope="session")
def other_planet() -> Atmosphere:
    """A small hazy planet with four wavelengths."""
    return OTHER_PLANET
