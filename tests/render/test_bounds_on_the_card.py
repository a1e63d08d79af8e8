"""What passes compile and tabulate for scenes is bounded, however many scenes come."""

import numpy as np
import pytest
from scene_stage import light, look, square
from stateful_backend import opened
from term_stage import GROUND, material

from vrut_lite.render.passes import programs

pytestmark = pytest.mark.gl
_HIGHEST_NAME = 4000


@pytest.fixture
def backend(shared_gl_backend):
    return shared_gl_backend(size_px=(32, 32))


def count_of(gl_owner, kind):
    """Number of GL objects of a kind."""
    from OpenGL import GL

    is_one = getattr(GL, kind)
    return gl_owner.call(lambda _: sum(bool(is_one(name)) for name in range(1, _HIGHEST_NAME)))


def picture_of(backend, folder, paint):
    folder.mkdir(exist_ok=True)
    backend.change(scene=opened(square(folder, paint), GROUND))
    light(backend, np.full((6, 16, 16, 3), 1.0))
    return look(backend, (0.0, 2.0, 2.0), (0.0, 0.0, 0.0)).radiance


PAINTS = {
    "metal": material((0.6, 0.5, 0.4), 0.2, metallic=1.0),
    "plain": material((0.6, 0.5, 0.4), 1.0),
    "sheen": material((0.3,) * 3, 0.7, sheen={"sheenColorFactor": [0.5] * 3}),
    "coat": material((0.3,) * 3, 0.7, clearcoat={"clearcoatFactor": 1.0}),
    "pane": material((0.3,) * 3, 0.1, transmission={"transmissionFactor": 1.0}),
    "brushed": material((0.3,) * 3, 0.4, metallic=1.0, anisotropy={"anisotropyStrength": 0.7}),
}


def test_programs_of_materials_that_went_are_freed(backend, gl_owner, tmp_path, monkeypatch):
    """Each combination of features is a program of 3 MiB on a processor: only so many stay, and a
    scene whose programs were freed looks as before."""
    few = 4
    monkeypatch.setattr(programs, "MOST_PROGRAMS", few)
    known = backend.backend._frame._passes.meshes._program_cache._program_cache
    first, compiled, counts = {}, set(), []
    for _ in range(3):
        for name, paint in PAINTS.items():
            shown = picture_of(backend, tmp_path / name, paint)
            np.testing.assert_array_equal(shown, first.setdefault(name, shown))
            compiled |= known.keys()
            assert len(known) <= few
        counts.append(count_of(gl_owner, "glIsProgram"))
    assert len(compiled) > few
    assert counts[1] == counts[2]


def test_films_of_scenes_that_went_are_freed(backend, gl_owner, tmp_path):
    """A film's table has 0.4 MiB, and each scene may have others."""

    def film(thickness_nm):
        term = {"iridescenceFactor": 1.0, "iridescenceThicknessMaximum": thickness_nm}
        picture_of(backend, tmp_path / "film", material((0.1,) * 3, 0.3, iridescence=term))

    film(300.0)
    textures = count_of(gl_owner, "glIsTexture")
    for thickness_nm in (350.0, 400.0, 450.0):
        film(thickness_nm)
    assert count_of(gl_owner, "glIsTexture") == textures
