"""Mean albedo of the open ground at a scene's border."""

import numpy as np
from PIL import Image

from vrut_lite.geometry.colour import srgb_decode
from vrut_lite.geometry.reflection import reflectance_table
from vrut_lite.numeric_types import BoolArray, FloatArray, Vector, vector
from vrut_lite.scene.ground import PLANETARY_M, areas_from_above
from vrut_lite.scene.loading import LoadedScene
from vrut_lite.scene.materials import SurfaceMaterial

# Points on the scene, spread evenly seen from above, and cells along its width.
_POINTS, _CELLS = 1 << 16, 64
# Ground lies no higher above the scene's lowest point than these shares of its height and width.
_HIGHEST, _RELIEF = 0.1, 0.01
# Least share of the border that is open ground.
_LEAST_SHARE = 0.25
# Pixels of a texture's side that its mean colour is made of.
_TEXTURE_PX = 256
# Steps of the additive recurrence R2 (Roberts 2018), even in the plane.
_STEPS = np.array([0.7548776662466927, 0.5698402909980532])


def border_albedo(scene: LoadedScene) -> Vector | None:
    """Mean albedo of the ground around the scene's edge; None where less than a quarter is ground.

    Ground is open to the sky, faces up within 45 degrees, and lies low in the scene. The edge is
    the first and the last occupied cell of each row and column of a grid, seen from above.
    """
    extent_m = scene.upper_m - scene.lower_m
    width_m = float(extent_m[[0, 2]].max())
    if not 0.0 < width_m < PLANETARY_M:
        return None
    point_m, faces_up, albedo = _points_from_above(scene)
    cell = np.clip(
        (_CELLS * (point_m[:, [0, 2]] - scene.lower_m[[0, 2]]) / width_m).astype(int), 0, _CELLS - 1
    )
    top_m = np.full((_CELLS, _CELLS), -np.inf)
    np.maximum.at(top_m, (cell[:, 0], cell[:, 1]), point_m[:, 1])
    edge = _edge(np.isfinite(top_m))
    relief_m = _RELIEF * width_m
    low = point_m[:, 1] <= scene.lower_m[1] + _HIGHEST * extent_m[1] + relief_m
    open_above = point_m[:, 1] >= top_m[cell[:, 0], cell[:, 1]] - relief_m
    kept = faces_up & low & open_above & edge[cell[:, 0], cell[:, 1]]
    found = np.zeros_like(edge)
    found[cell[kept, 0], cell[kept, 1]] = True
    if found.sum() < _LEAST_SHARE * max(edge.sum(), 1):
        return None
    return vector(np.clip(albedo[kept].mean(axis=0), 0.0, 1.0))


def _edge(occupied: BoolArray) -> BoolArray:
    """The first and the last occupied cell of each row and each column."""
    edge = np.zeros_like(occupied)
    for cells, of_edge in ((occupied, edge), (occupied.T, edge.T)):
        rows = np.flatnonzero(cells.any(axis=1))
        of_edge[rows, cells[rows].argmax(axis=1)] = True
        of_edge[rows, _CELLS - 1 - cells[rows, ::-1].argmax(axis=1)] = True
    return edge


def _points_from_above(scene: LoadedScene) -> tuple[FloatArray, BoolArray, FloatArray]:
    """Points (n, 3) in metres, whether their triangle faces up, and their albedo (n, 3)."""
    areas = [areas_from_above(place) for place in scene.meshes]
    whole = sum(float(area.sum()) for area, _ in areas)
    colours = {id(place.mesh.material): _mean_albedo(place.mesh.material) for place in scene.meshes}
    parts = []
    for place, (area, up) in zip(scene.meshes, areas, strict=True):
        count = int(np.ceil(_POINTS * area.sum() / max(whole, 1e-30)))
        colour = colours[id(place.mesh.material)]
        if not count or colour is None:
            continue
        after = np.cumsum(area)
        triangle = np.searchsorted(after, (np.arange(count) + 0.5) / count * after[-1])
        triangle = np.minimum(triangle, len(area) - 1)
        share = (np.arange(count)[:, None] * _STEPS) % 1.0
        share = np.where(share.sum(axis=1, keepdims=True) > 1.0, 1.0 - share, share)
        a, b, c = np.moveaxis(place.world_triangles()[triangle], 1, 0)
        at = a + share[:, :1] * (b - a) + share[:, 1:] * (c - a)
        painted = np.tile(colour, (count, 1))
        if place.mesh.colours is not None:
            painted *= place.mesh.colours[place.mesh.faces[triangle], :3].mean(axis=1)
        parts.append((at, up[triangle], painted))
    if not parts:
        return np.empty((0, 3)), np.empty(0, bool), np.empty((0, 3))
    points, ups, albedos = zip(*parts, strict=True)
    return np.concatenate(points), np.concatenate(ups), np.concatenate(albedos)


def _mean_albedo(material: SurfaceMaterial) -> FloatArray | None:
    """Mean albedo (3,) of an opaque material in even light, coat included; None for others."""
    if material.alphaMode != "OPAQUE" or material.terms.transmits:
        return None
    base, metallic = material.baseColorFactor[:3], material.metallicFactor
    if material.baseColorTexture is not None:
        picture = material.baseColorTexture.convert("RGB")
        picture.thumbnail((_TEXTURE_PX, _TEXTURE_PX), Image.Resampling.NEAREST)
        texels = np.asarray(picture, np.float64).reshape(-1, 3) / 255.0
        base = base * srgb_decode(texels).mean(axis=0)
    table = reflectance_table()
    coat = np.interp(material.roughnessFactor, np.linspace(0.0, 1.0, len(table)), table[:, 0, 2])
    return metallic * base + (1.0 - metallic) * (coat + (1.0 - coat) * base)
