"""Small scenes with a layout of their own: a square grid of texels on each quad."""

from types import SimpleNamespace

import numpy as np
from light_transport.hour.illumination import Illumination
from light_transport.surfaces.surfaces import Surfaces

from vrut_lite.geometry.spherical_harmonics import irradiance_coefficients

_GAP = 2


def quads(
    *corners, texels=8, reflectance=0.5, emitted=0.0, opacity=1.0, double_sided=False, roughness=1.0
):
    """Surfaces of quads (4, 3), counter-clockwise from their front, and their layout."""
    count = len(corners)
    triangles, uv, part = [], [], []
    owner = np.full((count * (texels + _GAP), texels), -1, np.int32)
    for number, quad in enumerate(np.asarray(corners, float)):
        top = number * (texels + _GAP)
        places = np.array([[0, top], [texels, top], [texels, top + texels], [0, top + texels]])
        for k in ((0, 1, 2), (0, 2, 3)):
            triangles.append(quad[list(k)])
            uv.append(places[list(k)])
            part.append(number)
        row, column = np.indices((texels, texels))
        owner[top : top + texels] = 2 * number + (row > column)
    triangles = np.array(triangles)
    centre = 0.5 * (triangles.min(axis=(0, 1)) + triangles.max(axis=(0, 1)))
    radius = 0.5 * np.linalg.norm(triangles.max(axis=(0, 1)) - triangles.min(axis=(0, 1)))
    cross = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    normal = cross / np.linalg.norm(cross, axis=1, keepdims=True)
    each = np.ones((len(triangles), 1), np.float32)
    surfaces = Surfaces(
        corners_m=triangles - centre,
        normals=np.repeat(normal[:, None], 3, axis=1).astype(np.float32),
        part=np.array(part, np.int32),
        reflectance_rgb=each * np.broadcast_to(np.float32(reflectance), 3),
        emitted_rgb=each * np.broadcast_to(np.float32(emitted), 3),
        roughness=each[:, 0] * np.float32(roughness),
        opacity=each[:, 0] * np.float32(opacity),
        double_sided=np.full(len(triangles), double_sided),
        centre_m=centre,
        radius_m=float(radius),
    )
    layout = SimpleNamespace(
        message=SimpleNamespace(ground=None, probes=None),
        uv_px=np.array(uv, np.float32),
        owner=owner,
        chart=surfaces.part,
        seams=np.empty((0, 2), np.int32),
    )
    return surfaces, layout


def box(lower, upper, inwards=False):
    """The six quads of a box, seen from outside, or from inside."""
    x0, y0, z0 = lower
    x1, y1, z1 = upper
    sides = [
        [[x1, y0, z1], [x1, y0, z0], [x1, y1, z0], [x1, y1, z1]],
        [[x0, y0, z0], [x0, y0, z1], [x0, y1, z1], [x0, y1, z0]],
        [[x0, y1, z1], [x1, y1, z1], [x1, y1, z0], [x0, y1, z0]],
        [[x0, y0, z0], [x1, y0, z0], [x1, y0, z1], [x0, y0, z1]],
        [[x0, y0, z1], [x1, y0, z1], [x1, y1, z1], [x0, y1, z1]],
        [[x1, y0, z0], [x0, y0, z0], [x0, y1, z0], [x1, y1, z0]],
    ]
    return [side[::-1] if inwards else side for side in sides]


def floor(x0, x1, z0, z1, y=0.0):
    """A level quad, seen from above."""
    return [[x0, y, z1], [x1, y, z1], [x1, y, z0], [x0, y, z0]]


def hour(radiance=0.0, key=(0.0, 1.0, 0.0), irradiance=0.0, ground=None, cube=None):
    """Light of a uniform sky, open ground that is as bright unless told, and a key light."""
    if cube is None:
        cube = np.full((6, 16, 16, 3), radiance, np.float32)
    return Illumination(
        sky=cube,
        ground_radiance_rgb=(radiance if ground is None else ground,) * 3,
        ground_albedo_rgb=(0.2, 0.2, 0.2),
        key_direction=tuple(np.asarray(key, float) / np.linalg.norm(key)),
        key_irradiance_rgb=(irradiance,) * 3,
        open_sky=irradiance_coefficients(cube),
    )
