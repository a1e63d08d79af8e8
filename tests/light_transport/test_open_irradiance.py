"""The table of the open sky's irradiance against its harmonics."""

import numpy as np
import pytest
from light_map_stage import fetched
from light_transport.drawing.open_irradiance import NODES, open_irradiance

from vrut_lite.geometry.cube_map import texel_directions
from vrut_lite.geometry.spherical_harmonics import evaluate_irradiance, irradiance_coefficients


def looked_up(table, n):
    """As the shader does: normals (..., 3) on the octahedron, unfolded."""
    on_faces = n / np.abs(n).sum(axis=-1, keepdims=True)
    at = on_faces[..., [0, 2]]
    folded = (1.0 - np.abs(at[..., ::-1])) * np.where(at < 0.0, -1.0, 1.0)
    at = np.where(n[..., 1:2] < 0.0, folded, at)
    return fetched(table, (0.5 + 0.5 * at) * (NODES - 1) + 0.5)


@pytest.mark.parametrize("seed", range(4))
def test_look_ups_agree_with_the_harmonics(seed):
    """Within 0.5 % of the brightest, under skies whose every face has another radiance."""
    generator = np.random.default_rng(seed)
    cube = np.ones((6, 16, 16, 3)) * generator.uniform(0.0, 9.0, (6, 1, 1, 3))
    cube[texel_directions(16)[..., 1] > 0.9] *= 5.0
    harmonics = irradiance_coefficients(cube)
    n = generator.normal(size=(4000, 3))
    n /= np.linalg.norm(n, axis=-1, keepdims=True)
    wanted = evaluate_irradiance(harmonics, n)
    found = looked_up(open_irradiance(harmonics).astype(float), n)
    assert np.abs(found - wanted).max() < 5e-3 * wanted.max()
