"""Where rays of sensors end: they pass glass by weight, at the angle at which they meet it."""

import math

import numpy as np

from light_transport.daylight_numbers.glass import Glass
from light_transport.kernels import hot, inlined
from light_transport.ray_scene import RayScene
from light_transport.rays.ray_starts import scratch
from light_transport.rays.ray_table import met_row
from light_transport.rays.trace import MISS, mixed, nearest_along
from light_transport.rays.tree import Tree
from vrut_lite.numeric_types import Float32Array, FloatArray

# What is no row: above and below the horizon, a body's back, and nothing at all.
SKY, OPEN_GROUND, BODY, NOTHING = -1, -2, -3, -4
# Light that has passed so many panes is let go.
_MOST_PANES = 8
# Rays go on so far behind a pane, in radii.
_BEHIND = 1e-5


def tree_with_glass(scene: RayScene, glass: Glass) -> Tree:
    """The scene's tree, in which rays always meet glass."""
    opacity = np.where(glass.clear[scene.tree.order], np.float32(1.0), scene.tree.opacity)
    return scene.tree._replace(opacity=opacity.astype(np.float32))


def ends_of(
    scene: RayScene, tree: Tree, glass: Glass, origin: FloatArray, direction: FloatArray
) -> tuple[np.ndarray, Float32Array]:
    """Ends of rays (R) that begin at `origin` (R, 3) in radii towards `direction` (R, 3), unit.

    Returns:
        Rows, SKY, OPEN_GROUND or BODY (R, 2) int32 that a ray ends at, and of the first pane that
        it met, or NOTHING; and the share (R, 2, 3) of either by colour.
    """
    target = np.empty((len(origin), 2), np.int32)
    share = np.zeros((len(origin), 2, 3), np.float32)
    receivers = scene.receivers
    first_group = len(receivers.texels.pixel) + len(receivers.probes.place)
    _ends(
        tree, receivers, first_group, glass, np.asarray(origin, float),
        np.asarray(direction, float), scratch(), target, share,
    )  # fmt: skip
    return target, share


@inlined
def _through(face, inner, panes):  # type: ignore[no-untyped-def]
    """Share of light of one polarisation that passes panes; see `glass.stack`."""
    passes = (1.0 - face) * (1.0 - face) * inner / (1.0 - face * face * inner * inner)
    back = face * (1.0 + inner * passes)
    through, returned = passes, back
    for _ in range(1, panes):
        between = 1.0 / (1.0 - returned * back)
        returned += through * through * back * between
        through *= passes * between
    return through


@inlined
def _passes(cosine, ior, panes, tint):  # type: ignore[no-untyped-def]
    """Share of unpolarised light that passes one face of a body, or panes; see `glass.stack`."""
    bent = math.sqrt(max(1.0 - (1.0 - cosine * cosine) / (ior * ior), 0.0))
    across = (cosine - ior * bent) / (cosine + ior * bent)
    along = (ior * cosine - bent) / (ior * cosine + bent)
    across, along = across * across, along * along
    if panes == 0:
        return tint * (1.0 - 0.5 * (across + along))
    inner = min(tint, 1.0) ** (1.0 / bent)
    both = _through(across, inner, panes) + _through(along, inner, panes)
    return 0.5 * max(tint, 1.0) * both


@hot
def _ends(tree, receivers, first_group, glass, origin, direction, scratch, target, share):  # type: ignore[no-untyped-def]
    geometry, texels, _, groups = receivers
    stack, far_stack, left, passed, place, _, _, ray = scratch
    for i in range(len(origin)):
        for k in range(3):
            place[k], ray[k], left[k] = origin[i, k], direction[i, k], 1.0
        target[i, 0], target[i, 1] = BODY, NOTHING
        for panes in range(_MOST_PANES):
            distance, hit, u, v = nearest_along(tree, place, ray, mixed(i, panes), stack, far_stack)
            if hit == MISS:
                target[i, 0] = SKY if ray[1] >= 0.0 else OPEN_GROUND
                break
            t = tree.order[hit]
            for k in range(3):
                place[k] += distance * ray[k]
            clear = glass.tint[t, 0] > 0.0 or glass.tint[t, 1] > 0.0 or glass.tint[t, 2] > 0.0
            if not clear or panes == _MOST_PANES - 1:
                met = met_row(geometry, texels, groups, first_group, t, u, v, place, ray)
                target[i, 0] = met if met >= 0 else BODY
                break
            faces = geometry.faces
            cosine = abs(faces[t, 0] * ray[0] + faces[t, 1] * ray[1] + faces[t, 2] * ray[2])
            through = 0.0
            for k in range(3):
                if k == 0 or glass.tint[t, k] != glass.tint[t, k - 1]:
                    through = _passes(
                        max(cosine, 1e-6), glass.ior[t], glass.panes[t], float(glass.tint[t, k])
                    )
                passed[k] = through
            if panes == 0:
                met = met_row(geometry, texels, groups, first_group, t, u, v, place, ray)
                target[i, 1] = met if met >= 0 else NOTHING
                for k in range(3):
                    share[i, 1, k] = 1.0 - passed[k]
            for k in range(3):
                left[k] *= passed[k]
                place[k] += _BEHIND * ray[k]
        for k in range(3):
            share[i, 0, k] = left[k]
