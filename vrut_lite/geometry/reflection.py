"""Reflection of a sky by glossy surfaces: the reference for the shaders.

Split-sum (Karis 2013, "Real Shading in Unreal Engine 4"): the sky is averaged over the lobe
once for all surfaces, and a table says how much of it a surface reflects. GGX with alpha =
roughness^2, height-correlated Smith shadowing (Heitz 2014) and Schlick's Fresnel term.
"""

from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike, NDArray

from vrut_lite.geometry.cached_table import kept_table
from vrut_lite.geometry.cube_map import texel_directions, texel_solid_angles

# Glass, plastic, stone: glTF 2.0, appendix B.2.
DIELECTRIC_F0 = 0.04
TABLE_SIZE = 32
_GRAZING_MU = 1e-3
_RADII, _ANGLES = 32, 12


def lobe(cosine: ArrayLike, roughness: float) -> NDArray[np.float64]:
    """Weight (...,) of light at an angle, by its cosine (...,), from the mirror direction.

    The lobe of a surface seen from straight above (normal, view and mirror direction are one):
    D(h) (n.l), with h half-way, not normalised; zero behind the surface.
    """
    c = np.asarray(cosine, dtype=float)
    alpha_squared = roughness**4
    # (n.h)^2 = (1 + c) / 2, so this is (n.h)^2 (alpha^2 - 1) + 1 without cancellation.
    spread = 0.5 * (1.0 - c) + 0.5 * (1.0 + c) * alpha_squared
    return np.asarray(alpha_squared * np.maximum(c, 0.0) / spread**2)


def prefiltered(
    cube: NDArray[np.floating], direction: ArrayLike, roughness: float
) -> NDArray[np.float64]:
    """Mean radiance (..., 3) of a cube (6, n, n, 3) over the lobes around directions (..., 3).

    Every texel is weighed at its centre, so that the lobe must be wider than a texel.
    """
    towards = np.asarray(direction, dtype=float).reshape(-1, 3)
    n = cube.shape[1]
    texels = texel_directions(n).reshape(-1, 3)
    solid_angle = np.broadcast_to(texel_solid_angles(n), (6, n, n)).ravel()
    radiance = np.asarray(cube, dtype=float).reshape(-1, 3)
    mean = np.empty((len(towards), 3))
    for index, axis in enumerate(towards):
        weight = lobe(texels @ axis, roughness) * solid_angle
        mean[index] = weight @ radiance / weight.sum()
    return mean.reshape(*np.shape(direction)[:-1], 3)


@lru_cache(maxsize=1)
def reflectance_table() -> NDArray[np.float32]:
    """Reflectance under a uniform white sky: (TABLE_SIZE, TABLE_SIZE, 3), rows are roughness.

    Roughness runs from 0 to 1 in equal steps, the cosine of the view angle along a row as
    the square of equal steps. The first two channels are a and b of the reflectance
    f0 a + f90 b by one bounce; a + b is the reflectance of a perfect mirror's facets. The third is
    the reflectance of a dielectric, all bounces, averaged over the hemisphere.
    """
    return kept_table("reflectance", _reflectance_table, __file__)


def _reflectance_table() -> NDArray[np.float32]:
    steps = np.linspace(0.0, 1.0, TABLE_SIZE)
    table = np.empty((TABLE_SIZE, TABLE_SIZE, 3), np.float32)
    for row, roughness in enumerate(steps):
        a, b = reflectance(steps**2, roughness)
        dielectric = all_bounces(DIELECTRIC_F0, 1.0, a, b)
        # dE = 2 mu dmu, with mu = s^2: 4 s^3 ds.
        weight = steps**3
        table[row, :, 0], table[row, :, 1] = a, b
        table[row, :, 2] = np.trapezoid(dielectric * weight, steps) / np.trapezoid(weight, steps)
    return table


def reflectance(mu: ArrayLike, roughness: float) -> tuple[NDArray, NDArray]:
    """a and b (...,) of one bounce at view cosines (...,), by integration.

    Facets are sampled by visibility (Heitz 2018, "Sampling the GGX Distribution of
    Visible Normals"), which leaves a smooth integrand also for a mirror: the midpoint rule.
    """
    nv = np.maximum(np.asarray(mu, dtype=float), _GRAZING_MU)[..., None, None]
    alpha = max(roughness**2, 1e-4)
    view = np.stack([np.sqrt((1.0 - nv) * (1.0 + nv)), np.zeros_like(nv), nv], axis=-1)
    half = _visible_normals(view, alpha)
    vh = np.sum(view * half, axis=-1)
    nl = 2.0 * vh * half[..., 2] - nv
    seen = np.where(nl > 0.0, _masking(nv, nl, alpha), 0.0)
    fresnel = (1.0 - np.clip(vh, 0.0, 1.0)) ** 5
    return np.mean(seen * (1.0 - fresnel), axis=(-1, -2)), np.mean(seen * fresnel, axis=(-1, -2))


def all_bounces(f0: ArrayLike, f90: ArrayLike, a: ArrayLike, b: ArrayLike) -> NDArray[np.float64]:
    """Reflectance (...,) with the light that bounces between facets before it leaves.

    Turquin 2019, "Practical multiple scattering compensation for microfacet models": the loss of a
    perfect mirror's facets, 1 - (a + b), returns coloured by f0.
    """
    f0, a, b = (np.asarray(value, dtype=float) for value in (f0, a, b))
    return np.asarray((f0 * a + f90 * b) * (1.0 + f0 * (1.0 / (a + b) - 1.0)))


def _visible_normals(view: NDArray, alpha: float) -> NDArray:
    """Normals (..., radii, angles, 3) that stand for equal shares of the visible facets."""
    share, turn = np.meshgrid(
        (np.arange(_RADII) + 0.5) / _RADII,
        # The other half turn has the same light: its normals are the mirror images.
        np.pi * ((np.arange(_ANGLES) + 0.5) / _ANGLES - 0.5),
        indexing="ij",
    )
    stretched = view * np.array([alpha, alpha, 1.0])
    stretched = stretched / np.linalg.norm(stretched, axis=-1, keepdims=True)
    # The view has no y component: neither have the stretched view and the second axis.
    x, z = stretched[..., 0], stretched[..., 2]
    t1, t2 = np.sqrt(share) * np.cos(turn), np.sqrt(share) * np.sin(turn)
    lean = 0.5 * (1.0 + z)
    t2 = (1.0 - lean) * np.sqrt(np.maximum(0.0, 1.0 - t1 * t1)) + lean * t2
    up = np.sqrt(np.maximum(0.0, 1.0 - t1 * t1 - t2 * t2))
    normal = np.stack(
        [alpha * (-z * t2 + x * up), alpha * (t1 + 0.0 * z), x * t2 + z * up], axis=-1
    )
    return normal / np.linalg.norm(normal, axis=-1, keepdims=True)


def _masking(nv: NDArray, nl: NDArray, alpha: float) -> NDArray:
    """Share of visible facets whose reflection leaves unblocked: G2 / G1."""
    out, back = _smith_lambda(nv, alpha), _smith_lambda(np.maximum(nl, 1e-9), alpha)
    return (1.0 + out) / (1.0 + out + back)


def _smith_lambda(mu: NDArray, alpha: float) -> NDArray:
    tangent_squared = (1.0 - mu) * (1.0 + mu) / (mu * mu)
    return 0.5 * (np.sqrt(1.0 + alpha * alpha * tangent_squared) - 1.0)
