"""The light of an hour in the cube maps of glossy parts: a gather from what their rays met."""

import numpy as np

from light_transport.kernels import hot
from light_transport.map_texels import Texels
from light_transport.mirror_rays import MirrorRays
from light_transport.surfaces import Surfaces
from vrut_lite.numeric_types import Float32Array, Vector


def texel_radiance(
    rays: MirrorRays,
    surfaces: Surfaces,
    texels: Texels,
    irradiance: Float32Array,
    ground_albedo_rgb: Vector,
) -> Float32Array:
    """Radiance (T, 3) of the texels among the rows that are seen, T of them, which come first.

    `irradiance` (T, 3) is all that falls on them, the key light's too: (M + rho E) / pi.
    """
    triangle = texels.triangle[rays.row[: len(irradiance)]]
    reflectance = surfaces.reflectance_rgb[triangle]
    reflectance[surfaces.part[triangle] < 0] = ground_albedo_rgb
    sent = surfaces.emitted_rgb[triangle] + reflectance * irradiance
    return np.asarray(sent / np.float32(np.pi), np.float32)


def cubes(rays: MirrorRays, radiance: Float32Array) -> Float32Array:
    """Cubes (N, 6, e, e, 4) by the radiance (U, 3) of the rows that are seen.

    Alpha is the share of a texel's rays that met something, and what they met is weighed by it.
    """
    target = rays.target.reshape(-1, rays.target.shape[-1])
    out = np.empty((len(target), 4), np.float32)
    _gather(target, radiance, out)
    return out.reshape(*rays.target.shape[:-1], 4)


@hot
def _gather(target, radiance, out):  # type: ignore[no-untyped-def]
    rays = target.shape[1]
    scale = np.float32(1.0) / np.float32(rays)
    for i in range(len(target)):
        r, g = np.float32(0.0), np.float32(0.0)
        b, a = np.float32(0.0), np.float32(0.0)
        for k in range(rays):
            t = target[i, k]
            if t >= 0:
                r += radiance[t, 0]
                g += radiance[t, 1]
                b += radiance[t, 2]
                a += np.float32(1.0)
        out[i, 0], out[i, 1], out[i, 2], out[i, 3] = r * scale, g * scale, b * scale, a * scale
