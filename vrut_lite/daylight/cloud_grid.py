"""The grid of the clouds' light volume, on the CPU and on the GPU."""

# Columns are x = near u / (1 - growth |u|), u in [-1, 1] along each axis.
NEAR_M, FARTHEST_M = 6_000.0, 70_000.0
GROWTH = 1.0 - NEAR_M / FARTHEST_M
# A lower sun's depths are those of a sun here: its own way would be longer than the grid.
LEAST_SINE = 0.04
# Samples of the way from one height to the next, at most.
SUB_STEPS = 8
