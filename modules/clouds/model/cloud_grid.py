"""The grids of the clouds' light volume and of their shadow map, on the CPU and on the GPU.

Columns are x = near u / (1 - (1 - near / FARTHEST_M) |u|), u in [-1, 1] along each axis.
"""

# The shadow map's near distance; a light volume's is longer in thick layers.
NEAR_M, FARTHEST_M = 6_000.0, 70_000.0
_OF_THICKNESS, _LONGEST_NEAR_M = 4.0, 30_000.0
# A lower sun's depths are those of a sun here: its own way would be longer than the grid.
LEAST_SINE = 0.04
# Samples of the way from one height to the next, at most.
SUB_STEPS = 8


def volume_near_m(thickness_m: float) -> float:
    """The near distance of a light volume: its cells are about as wide as high."""
    return min(max(_OF_THICKNESS * thickness_m, NEAR_M), _LONGEST_NEAR_M)


def growth_of(near_m: float) -> float:
    """How fast columns get wider with the distance."""
    return 1.0 - near_m / FARTHEST_M


def place_of(u: float, near_m: float) -> float:
    """Distance from the middle along an axis, m, of a coordinate in [-1, 1]."""
    return near_m * u / (1.0 - growth_of(near_m) * abs(u))
