"""Polarised light in a plane-parallel slab of molecules over a Lambertian ground, all orders.

Light is the coherency tensor C (3, 3) of its field: its trace is the radiance, and C n = 0 for a
view n. Molecules scatter the integral W of C over all directions, as dipoles do, into
3 D / (8 pi) P W P + (1 - D) / (8 pi) tr(W) P, P = 1 - n n^T. No harmonics, no rotations, float64.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
_LEVELS, _STREAMS, _AZIMUTHS = 128, 24, 4
_SMALLEST = 1e-10


class Slab(NamedTuple):
    """A solved slab: `optical_depth` (levels,) from the top, `tensor` (levels, 3, 3): W of all
    light, the sun's too; `ground`: radiance of the ground; `anisotropy`: D."""

    optical_depth: Floats
    tensor: Floats
    ground: float
    anisotropy: float


def solve_slab(depth: float, mu_s: float, albedo: float, anisotropy: float = 1.0) -> Slab:
    """The slab under a sun of irradiance 1 at azimuth 0."""
    levels = depth * 0.5 * (1.0 - np.cos(np.linspace(0.0, np.pi, _LEVELS)))
    root, weight = np.polynomial.legendre.leggauss(_STREAMS)
    root = 0.5 * (root + 1.0)
    turn = (np.arange(_AZIMUTHS) + 0.5) * np.pi / _AZIMUTHS
    up = np.stack([part.ravel() for part in np.meshgrid(root**2, turn, indexing="ij")])
    solid = np.repeat(root * weight * 2.0 * np.pi / _AZIMUTHS, _AZIMUTHS)
    sides = [_projector(sign * up[0], up[1]) for sign in (1.0, -1.0)]
    beam = _projector(np.array([mu_s]), np.zeros(1))[0] / 2.0
    order = np.exp(-levels / mu_s)[:, None, None] * beam
    lit = albedo / np.pi * mu_s * np.exp(-depth / mu_s)
    total, ground = order.copy(), lit
    while np.trace(order, axis1=1, axis2=2).max() > _SMALLEST:
        sky, below = (_scatter(order, side, anisotropy) for side in sides)
        sky = _march(sky, levels, up[0], np.zeros_like(sky[0]))
        below = _march(below[::-1], levels[-1] - levels[::-1], up[0], lit / 2.0 * sides[1])[::-1]
        order = np.einsum("d,kdij->kij", solid, sky + below)
        # The other half of the azimuths is the mirror image.
        order[:, [0, 1, 1, 2], [1, 0, 2, 1]] = 0.0
        lit = albedo / np.pi * np.einsum("d,dii->", solid * up[0], sky[-1])
        total, ground = total + order, ground + lit
    return Slab(levels, total, ground, anisotropy)


def stokes_of_slab(slab: Slab, mu: float, azimuth: float) -> Floats:
    """I, Q, U (3,) of a view at the ground (mu > 0) or from above the slab (mu < 0), by the
    directions of rising zenith angle and azimuth."""
    view = np.array([mu]), np.array([azimuth])
    levels, source = slab.optical_depth, _scatter(slab.tensor, _projector(*view), slab.anisotropy)
    if mu > 0.0:
        seen = _march(source, levels, view[0], np.zeros((1, 3, 3)))[-1, 0]
    else:
        start = 0.5 * slab.ground * _projector(*view)
        seen = _march(source[::-1], levels[-1] - levels[::-1], -view[0], start)[-1, 0]
    sine, c, s = np.sqrt(1.0 - mu * mu), np.cos(azimuth), np.sin(azimuth)
    theta, phi = np.array([mu * c, mu * s, -sine]), np.array([-s, c, 0.0])
    across = theta @ seen @ theta, phi @ seen @ phi
    return np.array([sum(across), across[0] - across[1], 2.0 * theta @ seen @ phi])


def _projector(mu: Floats, azimuth: Floats) -> Floats:
    """1 - n n^T (n, 3, 3) of directions."""
    sine = np.sqrt(1.0 - mu * mu)
    n = np.stack([sine * np.cos(azimuth), sine * np.sin(azimuth), mu], axis=-1)
    return np.asarray(np.eye(3) - n[:, :, None] * n[:, None, :])


def _scatter(tensor: Floats, projector: Floats, anisotropy: float) -> Floats:
    """Source (levels, n, 3, 3) of molecules in directions."""
    dipoles = np.einsum("dij,kjl,dlm->kdim", projector, tensor, projector, optimize=True)
    even = np.einsum("kjj,dim->kdim", tensor, projector)
    return np.asarray((3.0 * anisotropy * dipoles + (1.0 - anisotropy) * even) / (8.0 * np.pi))


def _march(source: Floats, depth: Floats, mu: Floats, start: Floats) -> Floats:
    """Light (levels, n, 3, 3) of a source that is linear in the depth from the start."""
    light = [start]
    for k, step in enumerate(np.diff(depth)):
        way = step / mu
        passed = np.exp(-way)
        far = 1.0 - (1.0 - passed) / way
        near = 1.0 - passed - far
        ends = near[:, None, None] * source[k] + far[:, None, None] * source[k + 1]
        light.append(passed[:, None, None] * light[-1] + ends)
    return np.stack(light)
