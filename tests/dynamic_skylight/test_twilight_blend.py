"""How the model's last sky and the computed twilight are joined, direction by direction."""

import numpy as np
import pytest
from dynamic_skylight.twilight_blend import (
    BLEND_DEG,
    BLEND_ENDS_DEG,
    COLOUR_ENDS_DEG,
    blend,
    colour_share,
    luminance_share,
)
from dynamic_skylight.twilight_table import MAP_SHAPE, luminous_irradiance
from hypothesis import given
from hypothesis import strategies as st

from vrut_lite.geometry.colour import luminance


def skies(seed: int = 0) -> tuple[np.ndarray, np.ndarray]:
    """Two maps of positive radiance, the second of unit luminous irradiance."""
    random = np.random.default_rng(seed)
    model, twilight = random.uniform(0.5, 2.0, (2, *MAP_SHAPE, 3))
    return model, twilight / luminous_irradiance(twilight)


def seen(sky: np.ndarray, model: np.ndarray) -> np.ndarray:
    """What the map makes of the model, (V, A, 3)."""
    return sky[..., 3:] * model + sky[..., :3]


def test_at_the_blend_the_model_is_itself():
    """Nothing added and nothing scaled: the day goes on into the twilight without a step."""
    model, twilight = skies()
    sky = blend(model, twilight, luminous_irradiance(model), BLEND_DEG)
    np.testing.assert_allclose(sky[..., 3], 1.0, rtol=1e-12)
    np.testing.assert_allclose(sky[..., :3], 0.0, atol=1e-12)


@pytest.mark.parametrize("geometric_deg", [BLEND_ENDS_DEG, -5.0])
def test_below_the_blend_there_is_the_twilight_alone(geometric_deg):
    """At the end of the blend nothing of the model is left."""
    model, twilight = skies()
    sky = blend(model, twilight, 3.0, geometric_deg)
    np.testing.assert_array_equal(sky[..., 3], 0.0)
    np.testing.assert_allclose(sky[..., :3], 3.0 * twilight, rtol=1e-12)


@given(st.floats(-4.0, BLEND_DEG), st.floats(1e-6, 1e3), st.integers(0, 1000))
def test_the_illuminance_is_the_one_asked_for(geometric_deg, level, seed):
    """Whatever the shares: CIE Y on level ground is `level`."""
    model, twilight = skies(seed)
    sky = seen(blend(model, twilight, level, geometric_deg), model)
    assert luminous_irradiance(sky) == pytest.approx(level)
    assert sky.min() >= 0.0


@pytest.mark.parametrize("geometric_deg", [0.2, -1.0, -2.2])
def test_luminance_goes_evenly_in_its_logarithm(geometric_deg):
    """Up to one factor for all directions it is model^share * twilight^(1 - share).

    Within 1 %: a black direction's floor, 5 % of the twilight, lifts one of its luminance by 0.1 %.
    """
    model, twilight = skies()
    share = luminance_share(geometric_deg)
    expected = luminance(model) ** share * luminance(twilight) ** (1.0 - share)
    ratio = luminance(seen(blend(model, twilight, 1.0, geometric_deg), model)) / expected
    np.testing.assert_allclose(ratio, ratio.mean(), rtol=0.01)


def test_a_black_direction_brightens_in_small_steps():
    """The model's horizon may be black (turbidity 10, albedo 0): never by more than 21 % a step.

    0.05 deg of sun a step, relative to 2 % of the sky's mean luminance at least, at one level
    of light; the falling level takes 4 % off.
    """
    model, twilight = np.ones((2, *MAP_SHAPE, 3))
    model[0] = 0.0
    twilight /= luminous_irradiance(twilight)
    path = np.array(
        [
            luminance(seen(blend(model, twilight, np.pi, e), model))[0, 5]
            for e in np.arange(BLEND_DEG, BLEND_ENDS_DEG - 0.01, -0.05)
        ]
    )
    assert path[0] == pytest.approx(0.0, abs=1e-12)
    assert path[-1] == pytest.approx(1.0, rel=0.01)
    assert np.all(np.diff(path) > 0)
    assert np.max(path[1:] / np.maximum(path[:-1], 0.02)) < 1.21


@given(st.floats(-5.0, 2.0), st.floats(1e-6, 0.5))
def test_the_shares_fall_smoothly_with_the_sun(geometric_deg, step_deg):
    """From 1 to 0, monotone; the luminance's slope stays within 14 % of an even one's."""
    for share, end in ((luminance_share, BLEND_ENDS_DEG), (colour_share, COLOUR_ENDS_DEG)):
        higher, lower = share(geometric_deg), share(geometric_deg - step_deg)
        assert 0.0 <= lower <= higher <= 1.0
        assert share(BLEND_DEG) == 1.0
        assert share(end) == 0.0
        assert share(0.5 * (BLEND_DEG + end)) == pytest.approx(0.5)
    even = step_deg / (BLEND_DEG - BLEND_ENDS_DEG)
    change = luminance_share(geometric_deg) - luminance_share(geometric_deg - step_deg)
    assert change < 1.14 * even + 1e-12
