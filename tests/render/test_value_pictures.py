"""Values of surfaces in false colours: what they show is what light meter and map say."""

import msgspec
import numpy as np
import pytest
from light_map_stage import RECTANGLE_PX, even, fetched, laid, lit, uneven
from scene_stage import light, look, square, surface
from stateful_backend import opened

from vrut_lite.array import Array
from vrut_lite.geometry.colour import LUMENS_PER_WATT, luminance
from vrut_lite.geometry.false_colours import (
    UNUSED,
    Scale,
    coloured,
    iso_lines,
    round_levels,
    scale_of,
)
from vrut_lite.messages.light_map_values import texel_edges_m
from vrut_lite.pictures.value_picture import value_pixels, values_of

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
    """Values of a picture, which are told for each pixel of the square and for no other."""
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
    backend.change(scene=found, light_map=layout, surface_light=lit(layout, even(layout)))
    return found


@pytest.mark.gl
def test_illuminance_is_that_of_the_map_and_of_the_sun(backend, scene):
    """Linearly between texels, plus the sun's on the level: in lux, as a light meter has it."""
    layout = backend.state.light_map
    texels = uneven(layout)
    backend.change(surface_light=lit(layout, texels))
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
    layout = backend.state.light_map
    backend.change(shows="noise")
    assert np.isnan(look(backend, *ABOVE).values.values).all()
    finer, coarser = lit(layout, even(layout, 1.0)), lit(layout, even(layout, 0.9))
    coarser = msgspec.structs.replace(coarser, rays=finer.rays // 2)
    backend.change(surface_light=finer, coarser_light=coarser)
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


def test_the_legend_spans_the_values_and_what_has_none_is_grey():
    """Darkest and brightest colour are the ends of the scale."""
    scale = scale_of(np.geomspace(1.0, 100.0, 101))
    assert scale.low == pytest.approx(1.0, rel=0.1)
    assert scale.at(0.5) == pytest.approx(10.0, rel=0.01)
    pixels = coloured(np.array([scale.low, scale.high, np.nan, 0.0]), scale)
    assert pixels.tolist() == [[68, 1, 84], [253, 231, 37], list(UNUSED), list(UNUSED)]


def test_a_picture_of_nothing_has_no_legend():
    """Where no surface is seen there is no scale to draw."""
    nothing = np.full((200, 300), np.nan, np.float32)
    assert (value_pixels(values_of(nothing, "illuminance")) == UNUSED).all()


def test_iso_lines_are_where_round_values_are_passed():
    """Of values that double from column to column: a line a round value, none beside the wall."""
    values = np.tile(2.0 ** np.arange(8), (4, 1))
    values[:, 5] = np.nan
    levels = round_levels(Scale(1.0, 128.0))
    assert levels[0] > 1.0
    assert len(levels) <= 6
    line = iso_lines(values, levels)
    assert (line == line[0]).all()
    assert (line[0, [0, 5, 6]] == -1).all()
    for column in (1, 2, 3, 4, 7):
        if line[0, column] >= 0:
            assert values[0, column - 1] <= levels[line[0, column]] < values[0, column]
    assert (iso_lines(values, levels, steepest=1.5) == -1).all()
