"""Bounds that several messages of daylight share."""

from vrut_lite import checks

# W m^-2, also per steradian, whose sums and products stay finite in 32 bits; the sun's disc has
# 2e7.
MOST_LIGHT = 1e10
# Guaranteed by OpenGL 4.3: the edge of a cube or of a map, and of a 3-D texture.
LARGEST_EDGE, LARGEST_VOLUME = 16384, 2048


def check_scale(message: object) -> None:
    """Check that a `radiance_scale` keeps values of 16 bits within 32."""
    # Below it values of 32 bits lose digits; the largest of 16 bits is 65504.
    checks.number(message, "radiance_scale", 2.0**-126, MOST_LIGHT)
