"""Radii of the planet and of its moon."""

# The ground of pictures and of the air's models, as in Bruneton 2017.
GROUND_RADIUS_M = 6.36e6
# Mean radius of the Earth (IUGG), for astronomy and distances over the ground.
EARTH_RADIUS_M = 6_371_000.0
# Mean radius of the moon (IAU 2015).
MOON_RADIUS_KM = 1737.4
