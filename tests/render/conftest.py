"""A scene that several tests of the frame share."""

import pytest
import trimesh


@pytest.fixture(scope="module")
def box_file(tmp_path_factory):
    """A cube of 2 m with its base at height 0."""
    path = tmp_path_factory.mktemp("scene") / "box.glb"
    trimesh.creation.box((2, 2, 2)).apply_translation((0, 1, 0)).export(path)
    return path
