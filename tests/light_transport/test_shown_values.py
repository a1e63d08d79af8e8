"""Values of surfaces in false colours: what they show is what light meter and map say."""

import msgspec
import numpy as np
import pytest
from light_map_stage import RECTANGLE_PX, even, fetched, laid, lit, uneven
from light_transport.drawing.texel_values import texel_edges_m
from scene_stage import light, look, square, surface
from stateful_backend import opened

from vrut_lite.array import Array
from vrut_lite.geometry.colour import LUMENS_PER_WATT, luminance
from vrut_lite.messages.light_map import LightMapLaid

SIZE = 48
# A square of 1 m, and some sky beside it.
ABOVE = ((0.0, 1.0, 1e-3), (0.0, 0.0, 0.0), 2 * np.arctan(0.8))
ACROSS_M = 0.8 * ((np.arange(SIZE) + 0.5) / SIZE * 2.0 - 1.0)
PLACES_M = np.stack(np.meshgrid(ACROSS_M, ACROSS_M), axis=-1)
# Without pixels at its edge.
ON_SQUARE = (np.abs(PLACES_M) < 0.46).all(axis=-1)
OUTSIDE = (np.abs(PLACES_M) > 0.54).any(axis=-1)


@pytest.fixture
def backend(gl_backend):
    backend = gl_backend(size_px=(SIZE, SIZE))
    light(backend, np.ones((6, 16, 16, 3)))
    return backend


def shown(backend, kind):
    """Values of a picture, known for each pixel of the square and for no other."""
    backend.change(shows=kind)
    picture = look(backend, *ABOVE)
    assert np.isfinite(picture.values.values[ON_SQUARE]).all()
    assert np.isnan(picture.values.values[OUTSIDE]).all()
    return picture.values


@pytest.fixture
def scene(backend, tmp_path):
    """A square of dark, glossy paint: its colour and gloss are no light on it."""
    found = opened(square(tmp_path, surface(0.0, 0.2, 0.1)))
    layout = laid(found, ((1, 2),))
    backend.change(scene=found)
    backend.hear(layout, lit(layout, even(layout)))
    return found


@pytest.mark.gl
def test_illuminance_is_that_of_the_map_and_of_the_sun(backend, scene):
    """Linearly between texels, plus the sun's on the level: in lux, as a light meter has it."""
    layout = backend.state.shown(LightMapLaid)
    texels = uneven(layout)
    backend.hear(lit(layout, texels))
    sun = {"sun_direction": (0.0, 0.8, 0.6), "sun_irradiance": (5.0, 4.0, 3.0)}
    light(backend, np.ones((6, 16, 16, 3)), **sun)
    found = shown(backend, "illuminance")
    at_px = np.array([1.5, 2.5]) + (PLACES_M + 0.5) * (RECTANGLE_PX - 1)
    expected = fetched(texels, at_px)[..., :3] + 0.8 * np.array(sun["sun_irradiance"])
    lux = luminance(expected) * LUMENS_PER_WATT
    off = found.values[ON_SQUARE] / lux[ON_SQUARE] - 1.0
    # A pixel's samples lie on both sides of where light bends.
    assert np.median(np.abs(off)) < 1e-3
    assert np.abs(off).max() < 0.02
    x, y = 30, 20
    metered = backend.backend.illuminance(
        backend.state, (PLACES_M[y, x, 0], 0.0, PLACES_M[y, x, 1]), (0.0, 1.0, 0.0)
    )
    assert found.values[y, x] == pytest.approx(metered.lux, rel=5e-3)
    assert found.said_at(x, y) == f"{float(found.values[y, x]):,.0f} lx"


@pytest.mark.gl
def test_texels_are_shown_by_their_edge(backend, scene):
    """Seven texels lie between the first and the last on a metre."""
    found = shown(backend, "texels")
    np.testing.assert_allclose(found.values[ON_SQUARE], 1.0 / 7.0, rtol=2e-3)


@pytest.mark.gl
def test_noise_is_a_share_of_the_light(backend, scene):
    """A tenth less by half of the rays leaves a tenth; without fewer rays none is known."""
    layout = backend.state.shown(LightMapLaid)
    backend.change(shows="noise")
    assert np.isnan(look(backend, *ABOVE).values.values).all()
    finer, coarser = (
        msgspec.structs.replace(lit(layout, even(layout, light)), rays=rays, sky_level=1.0)
        for light, rays in ((1.0, 64), (0.9, 32))
    )
    backend.hear(coarser, finer)
    found = shown(backend, "noise")
    np.testing.assert_allclose(found.values[ON_SQUARE], 0.1, rtol=5e-3)
    assert found.said_at(24, 24) == "10 %"


def test_a_strip_narrower_than_a_texel_has_texels_as_long_as_its_own(tmp_path):
    """A strip of 1 m by 0.04 m with two texels, looked up in the middle of the one across."""
    scene = opened(
        square(tmp_path, corners=np.array([[0, 0, 0.04], [1, 0, 0.04], [1, 0, 0], [0, 0, 0]]))
    )
    layout = laid(scene, ((1, 2),))
    uv = layout.uv.values.copy()
    uv[:, 1] = 0.5
    edges = texel_edges_m(msgspec.structs.replace(layout, uv=Array(uv)), scene)
    assert edges[edges > 0.0] == pytest.approx(np.sqrt(0.04 / 7.0), rel=1e-3)
