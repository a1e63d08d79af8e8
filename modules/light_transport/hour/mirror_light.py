"""The light of an hour in the cube maps of glossy parts: a gather over the surfaces that their rays
met."""

import numpy as np
from numpy.typing import NDArray

from light_transport.kernels import hot
from light_transport.rays.map_texels import Texels
from light_transport.rays.mirror_rays import MirrorRays
from light_transport.rays.ray_table import TRIED
from vrut_lite.numeric_types import Float32Array


def asked_for_key_light(
    seen: NDArray[np.int32], texels: Texels, links: NDArray[np.int32]
) -> NDArray[np.integer]:
    """Texels whose key light is needed by texels in view, `seen` (U,): every second of them, as on
    a chess board, and those beside the others."""
    even = texels.pixel[seen].sum(axis=1) % 2 == 0
    odd = seen[~even]
    beside = links[odd]
    alone = ~(beside >= 0).any(axis=1)
    return np.unique(np.concatenate([seen[even], beside[beside >= 0], odd[alone]]))


@hot
def seen_shares(rows, share, ray, links, out):  # type: ignore[no-untyped-def]
    """Fill out[: len(rows)] (U,) with the key light's share of texels in view.

    Every second texel has a shadow ray, `ray` (N,), and a share (N,); the others take the mean of
    their neighbours' by `links` (N, 4).
    """
    for i in range(len(rows)):
        row = rows[i]
        lit, asked = np.float32(0.0), np.float32(0.0)
        if ray[row] < TRIED:
            lit, asked = share[row], np.float32(1.0)
        else:
            for k in range(links.shape[1]):
                j = links[row, k]
                if j >= 0 and ray[j] < TRIED:
                    lit += share[j]
                    asked += np.float32(1.0)
        out[i] = lit / max(asked, np.float32(1.0))


@hot
def texel_radiance(rows, part, surfaces, triangle, light, lit, hour, out):  # type: ignore[no-untyped-def]
    """Fill out[: len(rows)] (U, 3): radiance (M + rho (E + the key light's)) / pi of texels.

    `surfaces` are reflectance and radiosity (F, 3); `light` the irradiance (N, 4) of texels and
    whose each shows; `lit` (U,) `seen_shares`; `hour` the ground's albedo and the key light's
    irradiance (2, 3).
    """
    reflectance, emitted = surfaces
    irradiance, source = light
    inverse_pi = np.float32(1.0 / np.pi)
    for i in range(len(rows)):
        row = rows[i]
        t = triangle[row]
        shown = source[row]
        for k in range(3):
            falls = lit[i] * hour[1, k]
            if shown >= 0:
                falls += irradiance[shown, k]
            rho = hour[0, k] if part[t] < 0 else reflectance[t, k]
            out[i, k] = (emitted[t, k] + rho * falls) * inverse_pi


def cubes(rays: MirrorRays, radiance: Float32Array) -> Float32Array:
    """Cubes (N, 6, e, e, 4) by the radiance (U, 3) of the rows that are seen.

    Alpha is the share of a texel's rays that met a surface; radiance is weighed by it.
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
