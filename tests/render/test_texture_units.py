"""Texture units: each is one texture's in all that one program draws."""

import re
from collections import defaultdict
from pathlib import Path

import air
import clouds
import lamps
import numpy as np
import pytest
from air_stage import air_of, volume_of
from light_map_stage import even, laid, lit
from scene_stage import light, look, square
from stateful_backend import opened
from term_stage import material

from vrut_lite.render.shader_files import SHADERS, shader_source

_SAMPLER = re.compile(r"^layout\(binding = (\d+)\) uniform sampler\w+ (\w+);", re.MULTILINE)
FOLDERS = SHADERS, *(Path(module.__file__).parent / "shaders" for module in (air, clouds, lamps))
STAGES = sorted(path for folder in FOLDERS for path in folder.iterdir() if path.suffix != ".glsl")


@pytest.mark.parametrize("stage", STAGES, ids=lambda path: path.name)
def test_no_unit_has_two_textures(stage):
    """What is bound once a picture stays while materials bind theirs, and no unit of a program has
    two kinds of texture, with which GL draws nothing; whatever is compiled out."""
    textures = defaultdict(set)
    for unit, name in _SAMPLER.findall(shader_source(stage)):
        textures[unit].add(name)
    assert {unit: names for unit, names in textures.items() if len(names) > 1} == {}


@pytest.fixture
def backend(shared_gl_backend):
    backend = shared_gl_backend(size_px=(16, 16))
    light(backend, np.ones((6, 8, 8, 3)))
    return backend


def middle(backend, eye=(0.0, 2.0, 1e-3)):
    """What is seen of the square's middle (3,)."""
    return look(backend, eye, (0.0, 0.0, 0.0), 0.1).radiance[8, 8]


@pytest.mark.gl
def test_a_thin_film_is_drawn_in_air(backend, tmp_path):
    """Through air that neither takes nor adds light it looks as without: 1 %."""
    film = {"iridescenceFactor": 1.0, "iridescenceThicknessMaximum": 400.0}
    backend.change(scene=opened(square(tmp_path, material((0.1,) * 3, 0.3, iridescence=film))))
    without = middle(backend)
    backend.hear(air_of(volume_of(1e-12, 0.0)))
    np.testing.assert_allclose(middle(backend), without, rtol=0.01)


@pytest.mark.gl
@pytest.mark.parametrize(("towards", "expected"), [(1.0, 1.0), (-1.0, 0.0)])
def test_a_map_of_gloss_does_not_replace_the_sky_that_is_seen(backend, tmp_path, towards, expected):
    """A metal, to which the map is nothing, mirrors where it sees the sky: all or none of it."""
    gloss = material(
        roughness=0.1,
        metallic=1.0,
        specular={"specularFactor": 0.5, "specularTexture": {"index": 0}},
    )
    texels = np.full((4, 4, 4), 128, np.uint8)
    scene = opened(square(tmp_path, gloss, [texels]), None)
    layout = laid(scene, ((1, 2),))
    sky = np.array([3.0 * towards, 0.0, 0.0, 0.5])
    seen = lit(layout, even(layout, 0.5 * np.pi, 0.5), sky=sky)
    backend.change(scene=scene)
    backend.hear(layout, seen)
    np.testing.assert_allclose(middle(backend, (-1.0, 1.0, 0.0)), expected, atol=0.02)
