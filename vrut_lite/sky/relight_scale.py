"""What was made for an earlier sky, brought to the brightness of the present one.

A filtered sky and the light of surfaces follow the hour some frames late. At dusk the sky's light
halves every few minutes: in moving pictures they would outshine all that is of the present hour.
"""

# Of a far darker sky nothing is known of the present one's colours; its pattern is not blown up.
_MOST = 16.0


def age_factor(now: float, then: float) -> float:
    """The factor for what was made at the level `then`; exactly 1 for the present one."""
    if then <= 0.0 or now == then:
        return 1.0
    return min(now / then, _MOST)
