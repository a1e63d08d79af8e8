"""The light of an hour on a scene: its inputs and its result."""

from dataclasses import dataclass

from vrut_lite.array import Array
from vrut_lite.numeric_types import Float32Array, FloatArray, Vector


@dataclass(frozen=True, eq=False)
class Illumination:
    """The light that falls on a scene; linear sRGB, world axes.

    Attributes:
        sky: (6, n, n, 3) float32, radiance in W m^-2 sr^-1; see `geometry.cube_map`. Its lower half
            is not used.
        ground_radiance_rgb: of open ground, W m^-2 sr^-1.
        ground_albedo_rgb: of the ground disc.
        key_direction: unit vector towards the key light.
        key_irradiance_rgb: on a plane that faces it, W m^-2.
        open_sky: (25, 3), harmonics of the irradiance where nothing hides the sky; see
            `geometry.spherical_harmonics`.
    """

    sky: Float32Array
    ground_radiance_rgb: Vector
    ground_albedo_rgb: Vector
    key_direction: Vector
    key_irradiance_rgb: Vector
    open_sky: FloatArray


@dataclass(frozen=True, eq=False)
class HourLight:
    """Irradiance without the key light's own, and the share of the open sky's that arrives.

    `texels` (height, width, 4) float32: RGB in W m^-2, and openness in [0, 1]; `probes`
    (nz, ny, nx, 6, 4) float32 or None: the same on planes that face +x, -x, +y, -y, +z and -z.
    `visible_sky` (height, width, 4) float16: the share of the sky that is seen from a texel in
    direction d is RGB . d + alpha, kept in [0, 1]. `mirrors` (C, 6, e, e, 4) float32 or None:
    radiance that glossy parts see around them, and the share of a texel that is neither sky nor
    open ground; it weighs the radiance too. `column_light` (C, 4) float32: pi L that a ray brings
    from each column of the table, and its luminance, 0 for patches.
    """

    texels: Float32Array
    probes: Float32Array | None
    visible_sky: Array
    mirrors: Float32Array | None
    column_light: Float32Array
