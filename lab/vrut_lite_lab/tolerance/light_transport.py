"""The sizes that light transport chooses by the tolerance, and places that they are measured in.

Each place is random: by turns a room (walls 0.3 m thick around 3 to 9 m, a window, boxes in it and
before it) and a street (houses 5 to 20 m high on both sides of 50 to 100 m, boxes between them),
with paint of reflectance 0.1 to 0.8, an even sky above a grey ground, and a sun. The error is what
95 % of the points that lie evenly on all visible surfaces stay below, relative to light there plus
a tenth of the mean: where walls meet and things stand, a texel is for both sides.
"""

import os
from functools import lru_cache
from math import log
from typing import Any, NamedTuple

import numpy as np
from light_transport.hour.illumination import Illumination
from light_transport.layout.layout import Layout, lay_out
from light_transport.surfaces.surfaces import Surfaces, surfaces_of
from light_transport.tolerance import FRONTS, TransportQuality, quality_for
from light_transport.transport import SceneTransport
from numpy.typing import NDArray

from vrut_lite.array import Array
from vrut_lite.geometry.colour import luminance
from vrut_lite.geometry.cube_map import texel_directions
from vrut_lite.geometry.spherical_harmonics import irradiance_coefficients
from vrut_lite.messages.ground_disc import GroundDisc
from vrut_lite.messages.scene import SceneOpened
from vrut_lite.messages.scene_content import MAP_NAMES, NONE, SceneGeometry, SceneMaterials
from vrut_lite.messages.surface_terms import SurfaceTerms, as_row
from vrut_lite.numeric_types import BoolArray, FloatArray
from vrut_lite_lab.tolerance.knobs import Knob, ToleranceKnobs, Truth

TEXELS = (15_000, 30_000, 60_000, 120_000)
RAYS = (64, 128, 256, 512)
PATCH_TEXELS = (8, 6, 4, 3, 2)
BOUNCES = (10, 30, 100, 300, 1000)
# With what the other knobs are measured, and what the truth of each is.
_SIZE, _RAYS, _PATCH = 20_000, 128, 6.0
_TRUE_SIZE, _TRUE_RAYS, _TRUE_PATCH = 160_000, 256, 3.0
_TIMED_SIZE, _TIMED_RAYS = 5000, 16
_THREADS = os.cpu_count() or 1
_PLACES, _MOST_PLACES = 4000, 0.95
_WALL_M, _BEFORE_M = 0.3, 0.02
_SEEDS = (1, 2)
_CORNERS = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], float)
# Corners of the faces -x, +x, -y, +y, -z and +z, counter-clockwise seen from outside.
_FACES = np.array(
    [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
)


class TrialRoom(NamedTuple):
    """Boxes (B, 6) from corner to corner in metres, their paint (B,), and where the sun is."""

    boxes: tuple[tuple[float, ...], ...]
    paint: tuple[float, ...]
    sun: tuple[float, float, float]


class _Laid(NamedTuple):
    surfaces: Surfaces
    layout: Layout


def two_sets(pictures: int) -> tuple[list[TrialRoom], list[TrialRoom]]:
    """So many rooms in each set, always the same."""
    sets = [_rooms(pictures, seed) for seed in _SEEDS]
    return sets[0], sets[1]


def _rooms(count: int, seed: int) -> list[TrialRoom]:
    rng = np.random.default_rng(seed)
    return [(_room, _street)[n % 2](rng) for n in range(count)]


def _room(rng: np.random.Generator) -> TrialRoom:
    wide, high, deep = rng.uniform((3.0, 2.4, 3.0), (9.0, 4.0, 9.0))
    w, sill, head = _WALL_M, rng.uniform(0.0, 0.3) * high, rng.uniform(0.6, 0.9) * high
    left, right = rng.uniform(0.1, 0.4) * wide, rng.uniform(0.6, 0.9) * wide
    boxes: list[tuple[float, ...]] = [
        (-w, -w, -w, wide + w, 0.0, deep + w),
        (-w, high, -w, wide + w, high + w, deep + w),
        (-w, 0.0, -w, 0.0, high, deep + w),
        (wide, 0.0, -w, wide + w, high, deep + w),
        (0.0, 0.0, -w, wide, high, 0.0),
        (0.0, 0.0, deep, left, high, deep + w),
        (right, 0.0, deep, wide, high, deep + w),
        (left, 0.0, deep, right, sill + 0.01, deep + w),
        (left, head, deep, right, high, deep + w),
    ]
    for z in (*rng.uniform(0.5, deep - 1.0, 4), *(deep + rng.uniform(2.0, 6.0, 2))):
        x, size = rng.uniform(0.2, wide - 1.0), rng.uniform(0.3, 0.8, 3)
        boxes.append((x, 0.0, z, x + size[0], 2.0 * size[1], z + size[2]))
    return _lit(rng, boxes)


def _street(rng: np.random.Generator) -> TrialRoom:
    wide, long = rng.uniform((6.0, 50.0), (20.0, 100.0))
    boxes: list[tuple[float, ...]] = [(-12.0, -_WALL_M, 0.0, wide + 12.0, 0.0, long)]
    for x0, x1 in ((-10.0, 0.0), (wide, wide + 10.0)):
        z = 0.0
        while z < long - 5.0:
            end = min(z + rng.uniform(8.0, 20.0), long)
            boxes.append((x0, 0.0, z, x1, rng.uniform(5.0, 20.0), end))
            z = end + rng.choice((0.01, 3.0))
    for _ in range(6):
        x, z = rng.uniform((0.5, 2.0), (wide - 2.5, long - 6.0))
        size = rng.uniform((0.5, 0.8, 0.5), (2.0, 3.0, 5.0))
        boxes.append((x, 0.0, z, x + size[0], size[1], z + size[2]))
    return _lit(rng, boxes)


def _lit(rng: np.random.Generator, boxes: list[tuple[float, ...]]) -> TrialRoom:
    paint = tuple(rng.uniform(0.1, 0.8, len(boxes)).tolist())
    azimuth, elevation = rng.uniform(-1.0, 1.0), rng.uniform(0.2, 1.2)
    level = np.cos(elevation)
    sun = (level * np.sin(azimuth), np.sin(elevation), level * np.cos(azimuth))
    return TrialRoom(
        tuple(tuple(float(value) for value in box) for box in boxes),
        paint,
        (float(sun[0]), float(sun[1]), float(sun[2])),
    )


def scene_of(room: TrialRoom) -> SceneOpened:
    """The room as if it had been opened."""
    boxes = np.array(room.boxes)
    corners = boxes[:, None, :3] + _CORNERS * (boxes[:, None, 3:] - boxes[:, None, :3])
    count = len(boxes)
    normals = np.repeat(np.kron(np.eye(3), [[-1.0], [1.0]]), 4, axis=0)
    quads = np.array([[0, 1, 2], [0, 2, 3]])
    triangles = (4 * np.arange(6)[:, None, None] + quads).reshape(-1, 3)
    meshes = [[24 * n, 24, 12 * n, 12, NONE, NONE, NONE, n] for n in range(count)]
    lower, upper = (tuple(map(float, edge)) for edge in (corners.min((0, 1)), corners.max((0, 1))))
    return SceneOpened(
        path="",
        lower_m=lower,  # type: ignore[arg-type]
        upper_m=upper,  # type: ignore[arg-type]
        triangles=12 * count,
        geometry=SceneGeometry(
            positions_m=Array(corners[:, _FACES].reshape(-1, 3)),
            normals=Array(np.tile(normals, (count, 1))),
            uv=Array(np.empty((0, 2))),
            colours_rgba=Array(np.empty((0, 4), np.float32)),
            triangles=Array(np.tile(triangles, (count, 1)).astype(np.int32)),
            meshes=Array(np.array(meshes, np.int64)),
            part_mesh=Array(np.arange(count, dtype=np.int32)),
            world_from_part=Array(np.tile(np.eye(4), (count, 1, 1))),
        ),
        materials=_painted(np.array(room.paint)),
        ground=GroundDisc((0.0, 0.0), -_WALL_M - 0.01, 100.0),
        camera=None,
    )


def _painted(paint: FloatArray) -> SceneMaterials:
    count = len(paint)
    grey = np.append(np.repeat(paint[:, None], 3, axis=1), np.ones((count, 1)), axis=1)
    ones = {
        name: Array(np.ones(count))
        for name in ("roughness", "alpha_cutoff", "normal_scale", "occlusion_strength")
    }
    return SceneMaterials(
        names=Array(np.frombuffer(b"\n".join([b"paint"] * count), np.uint8)),
        base_colour_rgba=Array(grey),
        metallic=Array(np.zeros(count)),
        emission_rgb=Array(np.zeros((count, 3))),
        alpha_mode=Array(np.zeros(count, np.uint8)),
        double_sided=Array(np.zeros(count, bool)),
        terms=Array(np.tile(as_row(SurfaceTerms()), (count, 1))),
        map_image=Array(np.full((count, len(MAP_NAMES)), NONE, np.int32)),
        map_uv_layer=Array(np.zeros((count, len(MAP_NAMES)), np.uint8)),
        map_sampler=Array(np.zeros((count, len(MAP_NAMES), 3), np.uint8)),
        images=Array(np.empty((0, 4), np.int64)),
        texels=Array(np.empty(0, np.uint8)),
        **ones,
    )


def hour_of(room: TrialRoom) -> Illumination:
    """An even sky of radiance 1 with a sun of 3 W m^-2, above a ground of albedo 0.2."""
    above = texel_directions(16)[..., 1:2] > 0.0
    ground = 0.2 * (1.0 + 3.0 / np.pi * room.sun[1])
    cube = np.where(above, 1.0, ground).repeat(3, axis=-1).astype(np.float32)
    return Illumination(
        sky=cube,
        ground_radiance_rgb=(ground,) * 3,
        ground_albedo_rgb=(0.2,) * 3,
        key_direction=room.sun,
        key_irradiance_rgb=(3.0,) * 3,
        open_sky=irradiance_coefficients(cube),
    )


def _laid(room: TrialRoom, texels: int) -> _Laid:
    scene = scene_of(room)
    surfaces = surfaces_of(scene)
    return _Laid(surfaces, lay_out(scene, surfaces, None, texels))


def _baked(laid: _Laid, rays: int, patch_texels: float, left: float = 1e-4) -> SceneTransport:
    transport = SceneTransport(
        *laid, threads=_THREADS, patch_texels=patch_texels, bounces_left=left
    )
    transport.add_rays(rays)
    return transport


def _light_at(laid: _Laid, transport: SceneTransport, room: TrialRoom) -> FloatArray:
    """Irradiance as luminance (P,) at places that are the same in every layout of a room."""
    uv_px, inside = _places(laid.surfaces, laid.layout, np.array(room.boxes))
    texels = luminance(transport.light(hour_of(room)).texels[..., :3])
    at = uv_px - 0.5
    low = np.clip(np.floor(at).astype(int), 0, np.array(texels.shape)[::-1] - 2)
    x, y = (at - low).T
    column, row = low.T
    top = (1.0 - x) * texels[row, column] + x * texels[row, column + 1]
    below = (1.0 - x) * texels[row + 1, column] + x * texels[row + 1, column + 1]
    return np.asarray(np.where(inside, (1.0 - y) * top + y * below, 0.0), float)


def _places(surfaces: Surfaces, layout: Layout, boxes: FloatArray) -> tuple[FloatArray, BoolArray]:
    """Places (P, 2) in the map, evenly spread over what is seen, and which have texels."""
    own = np.flatnonzero(surfaces.part >= 0)
    a, b, c = np.moveaxis(surfaces.corners_m[own], 1, 0)
    across = np.cross(b - a, c - a)
    area = np.linalg.norm(across, axis=1)
    rng = np.random.default_rng(0)
    drawn = np.searchsorted(np.cumsum(area) / area.sum(), rng.random(_PLACES))
    root, along = np.sqrt(rng.random(_PLACES)), rng.random(_PLACES)
    weights = np.stack([1.0 - root, root * (1.0 - along), root * along], axis=1)
    before_m = np.einsum("pk,pkc->pc", weights, surfaces.corners_m[own[drawn]])
    before_m += surfaces.centre_m + _BEFORE_M * (across / area[:, None])[drawn]
    seen = ~_is_within(before_m, boxes)
    uv_px = np.einsum("pk,pkc->pc", weights, layout.uv_px[own[drawn]].astype(float))[seen]
    inside = np.isfinite(uv_px).all(axis=1)
    return np.where(inside[:, None], uv_px, 0.5), np.asarray(inside)


def _is_within(places_m: FloatArray, boxes: FloatArray) -> BoolArray:
    """Which places (P, 3) lie in boxes, or below all."""
    lower, upper = boxes[:, None, :3], boxes[:, None, 3:]
    inside = ((places_m > lower) & (places_m < upper)).all(axis=-1).any(axis=0)
    return np.asarray(inside | (places_m[:, 1] < boxes[:, 1].min()))


def light_error(light: FloatArray, true: FloatArray) -> float:
    """See the head of the file."""
    return float(np.quantile(np.abs(light - true) / (true + 0.1 * true.mean()), _MOST_PLACES))


def truth(room: TrialRoom) -> Truth:
    """Light at the places by more texels, rays and patches than any choice has."""
    laid = _laid(room, _TRUE_SIZE)
    return [_light_at(laid, _baked(laid, _TRUE_RAYS, _TRUE_PATCH), room)]


def _texel_errors(room: TrialRoom, true: Truth) -> FloatArray:
    errors = []
    for texels in TEXELS:
        laid = _laid(room, texels)
        errors.append(light_error(_light_at(laid, _baked(laid, _RAYS, _PATCH), room), true[0]))
    return np.array([errors])


def _ray_errors(room: TrialRoom, _true: Truth) -> FloatArray:
    """Against twice the most rays, of the same texels.

    The fewer rays are among these: noise itself is larger than the difference, by sqrt(1 - share).
    """
    laid = _laid(room, _SIZE)
    transport, lights = _baked(laid, RAYS[0], _PATCH), []
    for _ in RAYS:
        lights.append(_light_at(laid, transport, room))
        transport.add_rays(transport.rays)
    lights.append(_light_at(laid, transport, room))
    left = np.sqrt(1.0 - np.array(RAYS) / transport.rays)
    return np.array([[light_error(light, lights[-1]) for light in lights[:-1]]]) / left


def _patch_errors(room: TrialRoom, _true: Truth) -> FloatArray:
    """Against patches of a texel each."""
    laid = _laid(room, _SIZE)
    lights = [
        _light_at(laid, _baked(laid, _RAYS, float(edge)), room) for edge in (*PATCH_TEXELS, 1)
    ]
    return np.array([[light_error(light, lights[-1]) for light in lights[:-1]]])


def _bounce_errors(room: TrialRoom, _true: Truth) -> FloatArray:
    """Against a hundredth of what the last choice leaves."""
    laid = _laid(room, _SIZE)
    transport, lights = _baked(laid, _RAYS, _PATCH), []
    for one_in in (*BOUNCES, 100 * BOUNCES[-1]):
        transport.bounces_left = 1.0 / one_in
        lights.append(_light_at(laid, transport, room))
    return np.array([[light_error(light, lights[-1]) for light in lights[:-1]]])


def quality_error(room: TrialRoom, true: Truth, quality: TransportQuality) -> float:
    """With everything that a tolerance chooses."""
    laid = _laid(room, quality.texels)
    transport = _baked(laid, quality.rays, quality.patch_texels, quality.bounces_left)
    return light_error(_light_at(laid, transport, room), true[0])


def _timed(texels: int, rays: int, patch_texels: float) -> NDArray[Any]:
    room = _rooms(1, _SEEDS[0])[0]
    laid = _laid(room, texels)
    return _light_at(laid, _baked(laid, rays, patch_texels), room)


@lru_cache(maxsize=1)
def _timed_bake() -> tuple[TrialRoom, SceneTransport]:
    room = _rooms(1, _SEEDS[0])[0]
    return room, _baked(_laid(room, _TIMED_SIZE), _TIMED_RAYS, _PATCH)


def _timed_hour(bounces_left: float) -> NDArray[Any]:
    room, transport = _timed_bake()
    transport.bounces_left = bounces_left
    return transport.light(hour_of(room)).texels


KNOBS = ToleranceKnobs(
    fronts=FRONTS,
    knobs={
        "texels": Knob(TEXELS, _texel_errors, float, lambda n: _timed(n, _TIMED_RAYS, _PATCH)),
        "rays": Knob(RAYS, _ray_errors, float, lambda n: _timed(_TIMED_SIZE, n, _PATCH)),
        "patch_texels": Knob(
            PATCH_TEXELS,
            _patch_errors,
            lambda edge: 1.0 / edge**2,
            lambda edge: _timed(_TIMED_SIZE, _TIMED_RAYS, float(edge)),
        ),
        "bounces": Knob(BOUNCES, _bounce_errors, log, lambda one_in: _timed_hour(1.0 / one_in)),
    },
    samples=two_sets,
    truth=truth,
    picture_errors=lambda room, true, tolerance: [
        quality_error(room, true, quality_for(tolerance))
    ],
    # The truth itself is not surer than a few percent.
    tolerances=(0.3, 0.1, 0.05),
)
