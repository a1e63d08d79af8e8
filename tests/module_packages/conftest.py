"""An environment into which the tests of a file may install."""

import pytest
from foreign_packages import ScratchEnvironment


@pytest.fixture(scope="module")
def environment(tmp_path_factory):
    """Fixtures shared by tests, each of which installs packages under different names."""
    return ScratchEnvironment(tmp_path_factory.mktemp("environment"))
