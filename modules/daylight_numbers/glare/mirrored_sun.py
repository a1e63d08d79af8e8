"""The sun as an eye sees it: straight, through panes, and in flat mirrors, panes and water."""

from typing import NamedTuple

import numpy as np
from light_transport.public import MISS, SceneTransport, Surfaces, first_hits

from daylight_numbers.glazing.glass import Glass
from daylight_numbers.matrix.sensor_rays import SKY, ends_of, glazed
from vrut_lite.messages.scene import SceneOpened
from vrut_lite.numeric_types import FloatArray, IntArray

# Rougher surfaces spread the sun's image over a much larger lobe.
ROUGHEST = 0.1
_SAME_PLANE = 0.9999
_OFF = 2e-5
# As many planes as a scene may mirror the sun with: the largest.
_MOST = 64


class Flats(NamedTuple):
    """Smooth triangles by the planes (K) that they face.

    `normal` (K, 3); `plane_of` (F,) the plane of each triangle of the scene, -1 for none; `f0`
    (F, 3) reflectance at normal incidence.
    """

    normal: FloatArray
    plane_of: IntArray
    f0: FloatArray


def flats_of(scene: SceneOpened, surfaces: Surfaces) -> Flats:
    """The smooth flat parts of a scene; maps are not looked up, but where they roughen by none."""
    count = len(surfaces.part)
    f0, smooth = np.zeros((count, 3)), np.zeros(count, bool)
    materials = scene.materials.all()
    for part, mesh in enumerate(scene.geometry.part_mesh.values.tolist()):
        material = materials[scene.geometry.mesh(mesh).material]
        if material.roughness > ROUGHEST or material.alpha_mode == "BLEND":
            continue
        here = surfaces.part == part
        colour = np.asarray(material.base_colour_rgba[:3], float)
        dielectric = np.broadcast_to(material.terms.f0_rgb, (3,))
        if material.terms.transmits and material.terms.is_pane:
            dielectric = 2.0 * dielectric / (1.0 + dielectric)
        smooth[here] = True
        f0[here] = material.metallic * colour + (1.0 - material.metallic) * dielectric
    edges = surfaces.corners_m[:, 1:] - surfaces.corners_m[:, :1]
    cross = np.cross(edges[:, 0], edges[:, 1])
    area = np.linalg.norm(cross, axis=1)
    unit = cross / np.maximum(area, 1e-30)[:, None]
    # Shading normals of curved surfaces differ from face normals.
    flat = np.einsum("fci,fi->fc", surfaces.normals, unit).min(axis=1) > _SAME_PLANE
    chosen = np.flatnonzero(smooth & flat & (area > 0.0))
    plane_of = np.full(count, -1, np.int64)
    if not len(chosen):
        return Flats(np.empty((0, 3)), plane_of, f0)
    _, first, number = np.unique(
        np.round(unit[chosen], 3), axis=0, return_index=True, return_inverse=True
    )
    number = number.reshape(-1)
    largest = np.argsort(-np.bincount(number, area[chosen]), kind="stable")[:_MOST]
    rank = np.full(len(first), -1)
    rank[largest] = np.arange(len(largest))
    plane_of[chosen] = rank[number]
    return Flats(unit[chosen][first[largest]], plane_of, f0)


def mirrored_suns(
    transport: SceneTransport,
    glass: Glass,
    flats: Flats,
    place_m: FloatArray,
    sun: FloatArray,
    irradiance_rgb: FloatArray,
) -> tuple[FloatArray, FloatArray]:
    """Directions (K, 3) in which an eye sees a sun at `sun` (3,), and the irradiance (K, 3) of each
    on a plane that faces it."""
    towards, irradiance = [np.empty((0, 3))], [np.empty((0, 3))]
    if sun[1] <= 0.0 or not irradiance_rgb.any():
        return towards[0], irradiance[0]
    where = glazed(transport, glass)
    place = transport.in_radii(place_m)
    straight = sun[None]
    target, share = ends_of(where, place[None], straight)
    if target[0, 0] == SKY:
        towards.append(straight)
        irradiance.append(share[:, 0] * irradiance_rgb)
    if not len(flats.normal):
        return np.concatenate(towards), np.concatenate(irradiance)
    # Seen in a mirror, the sun stands where its direction is mirrored.
    image = sun - 2.0 * (flats.normal @ sun)[:, None] * flats.normal
    origin = np.tile(place, (len(image), 1))
    hit, distance = first_hits(where.tree, origin, image)
    met = (hit != MISS) & (flats.plane_of[hit] == np.arange(len(image)))
    met &= (flats.normal @ sun) * np.einsum("ki,ki->k", flats.normal, image) < 0.0
    at = origin + (distance[:, None] - _OFF) * image
    there = np.flatnonzero(met)
    if len(there):
        target, share = ends_of(where, at[there], np.tile(sun, (len(there), 1)))
        free = (target[:, 0] == SKY)[:, None]
        cosine = np.abs(flats.normal[there] @ sun)[:, None]
        f0 = flats.f0[hit[there]]
        # Schlick 1994.
        reflected = f0 + (1.0 - f0) * (1.0 - cosine) ** 5
        seen = free[:, 0] & (reflected > 0.0).any(axis=1)
        towards.append(image[there][seen])
        irradiance.append((reflected * share[:, 0] * free * irradiance_rgb)[seen])
    return np.concatenate(towards), np.concatenate(irradiance)
