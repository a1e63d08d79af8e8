"""What was made for an earlier sky, brought to the brightness of the present one.

A filtered sky and the light of surfaces follow the hour some frames late. At dusk the sky's light
halves every few minutes: in moving pictures they would outshine all that is of the present hour.
"""

from vrut_lite.geometry.colour import luminance
from vrut_lite.render.light import Light

# Of a far darker sky nothing is known of the present one's colours; its pattern is not blown up.
_MOST = 16.0


def sky_level(light: Light) -> float:
    """A number that is proportional to the mean luminance of sky and ground around the scene."""
    return max(0.0, float(luminance(light.irradiance_sh[0])))


def age_factor(now: float, then: float) -> float:
    """The factor for what was made at the level `then`; exactly 1 for the present one."""
    if then <= 0.0 or now == then:
        return 1.0
    return min(now / then, _MOST)
