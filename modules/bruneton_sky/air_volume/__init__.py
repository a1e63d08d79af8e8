"""The air between an observer and the scene, as a table by direction and distance.

`volume` makes it on the CPU, `kernels` sums matter and light along its rays, `gpu` has the light
made by a shader.
"""

from bruneton_sky.air_volume.volume import AirSizes, air_is_seen, air_volume

__all__ = ["AirSizes", "air_is_seen", "air_volume"]
