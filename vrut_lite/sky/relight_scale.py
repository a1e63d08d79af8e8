"""Scales light that was computed for an earlier sky to the brightness of the present one.

A filtered sky and the light of surfaces follow the hour some frames late. At dusk the sky's light
halves every few minutes: in moving pictures they would outshine all that is of the present hour.
"""

# Largest factor: a far darker sky says nothing of the present one's colours.
_MOST = 16.0


def age_factor(now: float, then: float) -> float:
    """The factor for light computed at the sky level `then`; exactly 1 at the present level."""
    if then <= 0.0 or now == then:
        return 1.0
    return min(now / then, _MOST)
