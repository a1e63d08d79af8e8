"""An environment into which the tests of a file may install."""

import pytest
from foreign_packages import ScratchEnvironment


@pytest.fixture(scope="module")
def environment(tmp_path_factory):
    """Shared: each test installs packages of its own names."""
    return ScratchEnvironment(tmp_path_factory.mktemp("environment"))
