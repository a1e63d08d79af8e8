"""OpenGL's devices are tried one by one, and a machine without its libraries is told so."""

import moderngl
import pytest

from vrut_lite.errors import UserError
from vrut_lite.render.gl_choice import open_context


@pytest.mark.parametrize("said", ["libGL.so not loaded", "libEGL.so not loaded"])
def test_a_missing_library_ends_the_search(said, monkeypatch, no_hang):
    """moderngl then says the same of every device: the search took a minute of a core."""

    def create_context(**asked):
        raise Exception(said)  # As glcontext 3.1 does on a system without libegl1 and libgl1.

    monkeypatch.setattr(moderngl, "create_context", create_context)
    no_hang()
    with pytest.raises(UserError, match=rf"\({said}\): install the packages libegl1 and libgl1"):
        open_context()
