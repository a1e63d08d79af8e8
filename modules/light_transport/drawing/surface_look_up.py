"""The light map and the probes at single points: surface_light.glsl's twin in double precision."""

import numpy as np
from numpy.typing import NDArray

from light_transport.drawing.mapped_scene import MappedScene
from vrut_lite.frame_part import GROUND, Hit
from vrut_lite.geometry.spherical_harmonics import evaluate_irradiance
from vrut_lite.messages.light_map import NOT_MAPPED, GroundChart, ProbeGrid
from vrut_lite.numeric_types import FloatArray

_UP = np.array([0.0, 1.0, 0.0])
# As in the shaders.
_GROUND_FADE, _MOST_BEHIND = 0.7, 10.0


def reached_irradiance(lit: MappedScene, hit: Hit, open_sky: NDArray) -> FloatArray | None:
    """Irradiance (3,) of a point on a surface, on the side of its normal.

    `open_sky`: irradiance of the sky by harmonics (25, 3). None where the surface has neither
    texels nor probes: the open sky lights it.
    """
    if hit.part == GROUND:
        return None if lit.laid.ground is None else _ground(lit, lit.laid.ground, hit, open_sky)
    if lit.laid.part_shape.values[hit.part] == NOT_MAPPED:
        return None if lit.laid.probes is None else _probes(lit, lit.laid.probes, hit)
    place_px, front = _place_px(lit, hit)
    if front @ hit.normal >= 0.0:
        return _texel(lit, place_px)
    if lit.laid.probes is not None and _is_among(lit.laid.probes, hit.point_m):
        return _probes(lit, lit.laid.probes, hit)
    behind, before = (evaluate_irradiance(open_sky, n) for n in (hit.normal, -hit.normal))
    share = np.clip((behind + 1e-20) / (before + 1e-20), 1.0 / _MOST_BEHIND, _MOST_BEHIND)
    return np.asarray(_texel(lit, place_px) * share)


def _place_px(lit: MappedScene, hit: Hit) -> tuple[FloatArray, FloatArray]:
    """Where a point lies in the map (2,), and a normal (3,) on the front of its triangle."""
    geometry, laid = lit.scene.geometry, lit.laid
    shape = laid.shape(int(laid.part_shape.values[hit.part]))
    mesh = geometry.mesh(int(geometry.part_mesh.values[hit.part]))
    matrix, corners = geometry.world_from_part.values[hit.part], mesh.triangles[hit.triangle]
    a, b, c = mesh.positions_m[corners] @ matrix[:3, :3].T + matrix[:3, 3]
    shares = np.linalg.lstsq(np.stack([b - a, c - a], axis=1), hit.point_m - a, rcond=None)[0]
    weights = np.array([1.0 - shares.sum(), *shares])
    x, y, z = matrix[:3, :3].T
    side = np.sign(np.cross(x, y) @ z) or 1.0
    front = side * (
        np.stack([np.cross(y, z), np.cross(z, x), np.cross(x, y)], axis=1)
        @ (weights @ mesh.normals[corners])
    )
    place = weights @ shape.uv[shape.triangles[hit.triangle]].astype(float)
    return place + laid.part_corner_px.values[hit.part], front


def _texel(lit: MappedScene, place_px: FloatArray) -> FloatArray:
    """Linearly between four texels."""
    texels = lit.light.texels.values
    found = _between(texels, np.asarray(place_px)[::-1] - 0.5)
    return found[:3] * lit.light.radiance_scale


def _ground(lit: MappedScene, chart: GroundChart, hit: Hit, open_sky: NDArray) -> FloatArray:
    assert lit.scene.ground is not None
    away = (hit.point_m[[0, 2]] - lit.scene.ground.centre_xz_m) / chart.half_width_m
    along = np.clip(np.arcsinh(np.sinh(chart.warp) * away) / chart.warp, -1.0, 1.0)
    place = np.array(chart.corner_px) + 0.5 + 0.5 * (1.0 + along) * (chart.edge_px - 1)
    far = np.clip((np.abs(away).max() - _GROUND_FADE) / (1.0 - _GROUND_FADE), 0.0, 1.0)
    share = far * far * (3.0 - 2.0 * far)
    open_ground = evaluate_irradiance(open_sky, _UP)
    return np.asarray((1.0 - share) * _texel(lit, place) + share * open_ground)


def _probes(lit: MappedScene, grid: ProbeGrid, hit: Hit) -> FloatArray:
    assert lit.light.probes is not None
    at = (hit.point_m - grid.lower_m) / np.array(grid.step_m) + 0.5 * hit.normal
    planes = _between(lit.light.probes.values, at[::-1])[:, :3]
    facing = 2 * np.arange(3) + (hit.normal < 0.0)
    return np.square(hit.normal) @ planes[facing] * lit.light.radiance_scale


def _is_among(grid: ProbeGrid, point_m: FloatArray) -> bool:
    at = (point_m - grid.lower_m) / np.array(grid.step_m)
    return bool(np.all((at > -1.0) & (at < np.array(grid.counts))))


def _between(values: NDArray, at: FloatArray) -> FloatArray:
    """Values (n, m, ..., C) at a place (d,) along their first d axes, linear, held at the ends."""
    found = values
    for place, length in zip(at, values.shape[: len(at)], strict=True):
        place = float(np.clip(place, 0.0, length - 1.0))
        first = min(int(place), length - 2) if length > 1 else 0
        share = place - first
        next_one = found[min(first + 1, length - 1)].astype(float)
        found = (1.0 - share) * found[first].astype(float) + share * next_one
    return np.asarray(found)
