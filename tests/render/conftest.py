"""A scene that several tests of the frame share."""

import pytest
import trimesh
from stateful_backend import StatefulBackend


@pytest.fixture(scope="module")
def box_file(tmp_path_factory):
    """A cube of 2 m with its base at height 0."""
    path = tmp_path_factory.mktemp("scene") / "box.glb"
    trimesh.creation.box((2, 2, 2)).apply_translation((0, 1, 0)).export(path)
    return path


@pytest.fixture
def gl_backend(gl_owner):
    """Makes a `StatefulBackend` on OpenGL with parts of its state."""
    from vrut_lite.render.pyrender_backend import PyrenderBackend

    backend = PyrenderBackend(gl_owner)
    yield lambda **parts: StatefulBackend(backend, **parts)
    backend.close()


@pytest.fixture(scope="module")
def _backend_of_file(gl_owner):
    from vrut_lite.render.pyrender_backend import PyrenderBackend

    backend = PyrenderBackend(gl_owner)
    yield backend
    backend.close()


@pytest.fixture
def shared_gl_backend(_backend_of_file):
    """The same on a backend that the tests of a file share: its frames remember the ones before."""
    return lambda **parts: StatefulBackend(_backend_of_file, **parts)
