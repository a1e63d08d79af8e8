"""The check of a shared page: where lux is compared."""

import numpy as np

from vrut_lite_lab.page_check import even_pixels


def test_lux_is_compared_away_from_edges_of_light_and_of_surfaces():
    """Three pixels beside a shadow's edge and on; a slow gradient counts, the sky does not."""
    lux = np.full((9, 20), 1000.0, np.float32) * np.linspace(1.0, 1.1, 20, dtype=np.float32)
    lux[:, 10:] *= 0.5
    lux[:, 18:] = 0.0
    even = even_pixels(lux)
    assert even[:, :8].all()
    assert not even[:, 8:12].any()
    assert even[:, 12:16].all()
    assert not even[:, 16:].any()
