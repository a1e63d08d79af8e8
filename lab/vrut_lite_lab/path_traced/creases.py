"""The light map's error at creases, against rays from the very points and against mitsuba.

    python -m vrut_lite_lab.path_traced.creases [--rooms 30] [--mitsuba 40] [SCENE ...]

Creases are places within two texels of a surface that faces otherwise by more than 20 degrees:
edges, corners, and the feet of what stands on a surface. At random visible points of them the map
is looked up as the frame does it. The reference are 4,096 rays from each point, spread around the
shading normal as the map's own, which end on the patches of a map of twice as many texels. Errors
are of luminance, without the key light's own, relative to the reference plus a twentieth of the
geometric mean of all points. Scenes have the light of noon in Prague; their points are those that
an eye at their own camera sees that turns around. Rooms, under an even sky and a sun, are random
ones with columns, tables and beams. With `--mitsuba N`, N of the points also have the light that
mitsuba finds there.
"""

import argparse
from collections.abc import Callable, Iterator
from typing import Any, NamedTuple

import numpy as np
from light_transport.hour.illumination import Illumination
from light_transport.layout.layout import Layout, lay_out
from light_transport.rays.ray_starts import OFF
from light_transport.rays.trace import first_hits
from light_transport.surfaces.surfaces import GROUND, Surfaces, surfaces_of
from light_transport.tolerance import quality_for
from light_transport.transport import SceneTransport
from light_transport.view.point_light import light_at
from path_tracer.library import load_mitsuba
from path_tracer.sky_map import sky_emitter
from scipy.spatial import cKDTree

from vrut_lite.geometry.colour import luminance
from vrut_lite.messages.scene import SceneOpened
from vrut_lite.messages.tolerance import DEFAULT_TOLERANCE
from vrut_lite.numeric_types import BoolArray, FloatArray, Vector
from vrut_lite_lab.path_traced.cases import light_of_state, states
from vrut_lite_lab.scenes.crease_rooms import crease_room, inside_of
from vrut_lite_lab.tolerance.light_transport import TrialRoom, hour_of, scene_of

SCENES = (
    "large/hall.toml", "work/indoor.glb", "work/room.glb", "work/ground.glb", "street.toml",
    "pavilion.gltf", "spheres.glb", "sundial.toml", "large/terrain.toml", "large/satellite.glb",
    "work/planet.glb",
)  # fmt: skip
HEADER = (
    "| scene | points | map rms | median | above 25 % | mean | reference to mitsuba | map to it |"
)
_POINTS, _RAYS, _CANDIDATES = 1500, 4096, 200_000
_TEXELS_AWAY = 2.0
# Cosines between which a surface faces otherwise; beyond are backs of plates.
_OTHERWISE = -0.9, np.cos(np.radians(20.0))
_LEAST_FREE, _LEAST_OF_MEAN = 0.9, 0.05
# Least harmonic mean distance of visible surfaces, in texels; excludes gaps that no eye looks into.
_LEAST_ROOM = 0.3
_SAMPLES, _BOUNCES = 2048, 24


class Points(NamedTuple):
    """Points (P) on surfaces: world places and normals (P, 3), places in the map (P, 2).

    `normal` are of faces, `shading` those interpolated between corners. `look_up_px` is where the
    frame looks: in charts of one texel's width that texel's middle.
    """

    place_m: FloatArray
    normal: FloatArray
    shading: FloatArray
    uv_px: FloatArray
    look_up_px: FloatArray


def crease_points(
    transport: SceneTransport,
    surfaces: Surfaces,
    layout: Layout,
    which: Callable[[FloatArray, SceneTransport], BoolArray],
) -> Points:
    """Random points at creases, evenly by area: `which` of places (P, 3), world axes."""
    count = _POINTS
    rng = np.random.default_rng(0)
    texels, radius = transport.texels, surfaces.radius_m
    faces = surfaces.face_normals()
    fronts = int(np.count_nonzero(texels.side > 0.0))
    own = np.flatnonzero(np.isfinite(layout.uv_px).all(axis=(1, 2)))
    a, b, c = np.moveaxis(surfaces.corners_m[own], 1, 0)
    area = 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1)
    drawn = np.minimum(
        np.searchsorted(np.cumsum(area) / area.sum(), rng.random(_CANDIDATES)), len(own) - 1
    )
    root, along = np.sqrt(rng.random(_CANDIDATES)), rng.random(_CANDIDATES)
    weights = np.stack([1.0 - root, root * (1.0 - along), root * along], axis=1)
    place = np.einsum("pk,pkc->pc", weights, surfaces.corners_m[own[drawn]])
    uv = np.einsum("pk,pkc->pc", weights, layout.uv_px[own[drawn]].astype(float))
    look_up = np.einsum("pk,pkc->pc", weights, look_ups_px(layout)[own[drawn]])
    shading = np.einsum("pk,pkc->pc", weights, surfaces.normals[own[drawn]].astype(float))
    length = np.linalg.norm(shading, axis=1)[:, None]
    shading = np.where(length > 1e-6, shading / np.maximum(length, 1e-6), faces[own[drawn]])
    found = Points(place, faces[own[drawn]], shading, uv, look_up)
    share = np.full(_CANDIDATES, area.sum() / _CANDIDATES)
    ground = _ground_points(transport, rng)
    found = Points(*(np.concatenate(both) for both in zip(found, ground[0], strict=True)))
    share = np.concatenate([share, ground[1] * radius**2])
    column, row = np.floor(found.uv_px).astype(int).T
    texel = texels.row_of[row, column]
    others = cKDTree(texels.place[:fronts] * radius)
    facing = faces[texels.triangle[:fronts]]
    width = texels.width[np.maximum(texel, 0)] * radius
    off = 10.0 * OFF * radius * found.normal
    kept = np.flatnonzero((texel >= 0) & which(found.place_m + surfaces.centre_m + off, transport))
    if len(kept) > 40 * count:
        kept = rng.choice(kept, 40 * count, replace=False, p=share[kept] / share[kept].sum())
        share = np.ones(len(share))
    near = others.query_ball_point(found.place_m[kept], _TEXELS_AWAY * width[kept])
    is_crease = np.array(
        [
            _faces_otherwise(facing[each], n)
            for each, n in zip(near, found.normal[kept], strict=True)
        ]
    )
    kept = kept[is_crease]
    chance = share[kept] / share[kept].sum()
    kept = rng.choice(kept, min(3 * count, int(np.count_nonzero(chance))), replace=False, p=chance)
    return Points(
        found.place_m[kept] + surfaces.centre_m,
        *(each[kept] for each in found[1:]),
    )


def in_box(corners_m: FloatArray) -> Callable[[FloatArray, SceneTransport], BoolArray]:
    """Those within a box, by two of its corners (2, 3)."""
    return lambda place_m, _: ((place_m > corners_m[0]) & (place_m < corners_m[1])).all(axis=1)


def seen_from(eye_m: Vector) -> Callable[[FloatArray, SceneTransport], BoolArray]:
    """Those that an eye sees that turns around."""

    def which(place_m: FloatArray, transport: SceneTransport) -> BoolArray:
        surfaces = transport.surfaces
        places = (place_m - surfaces.centre_m) / surfaces.radius_m
        towards = (np.asarray(eye_m) - surfaces.centre_m) / surfaces.radius_m - places
        distance = np.linalg.norm(towards, axis=1)
        _, free = first_hits(transport.tree, places, towards / distance[:, None])
        return np.asarray(free >= distance)

    return which


def look_ups_px(layout: Layout) -> FloatArray:
    """Where the frame looks corners (F, 3, 2) of triangles up, by the layout's message."""
    message, found, first = layout.message, np.full(layout.uv_px.shape, np.nan), 0
    for part, number in enumerate(message.part_shape.values.tolist()):
        if number < 0:
            first += int(np.argmax(~np.isnan(layout.uv_px[first:, 0, 0])))
            continue
        shape = message.shape(number)
        rows = slice(first, first + len(shape.triangles))
        found[rows] = shape.uv[shape.triangles] + message.part_corner_px.values[part]
        first = rows.stop
    return found


def _faces_otherwise(facing: FloatArray, normal: FloatArray) -> bool:
    alike = facing @ normal
    return bool(np.any((alike > _OTHERWISE[0]) & (alike < _OTHERWISE[1])))


def _ground_points(
    transport: SceneTransport, rng: np.random.Generator
) -> tuple[Points, FloatArray]:
    """A point in each texel of the ground's chart, in metres from the centre, and its area."""
    texels, geometry, radius = (
        transport.texels,
        transport.receivers.geometry,
        transport.surfaces.radius_m,
    )
    rows = np.flatnonzero(geometry.on_ground[texels.triangle] & (texels.side > 0.0))
    at = texels.pixel[rows] + rng.random((len(rows), 2))
    corner, steps, half, warp = geometry.ground[:2], *geometry.ground[2:5]
    share = np.clip((at - corner - 0.5) / max(steps, 1.0) * 2.0 - 1.0, -1.0, 1.0)
    away = half * np.sinh(warp * share) / np.sinh(max(warp, 1e-9))
    x, z = (away + geometry.ground[5:7]).T
    place = np.stack([x, np.full(len(x), geometry.ground[7]), z], axis=1) * radius
    normal = np.tile([0.0, 1.0, 0.0], (len(rows), 1))
    return Points(place, normal, normal, at, at), texels.area[rows].astype(float)


def looked_up(texels: FloatArray, uv_px: FloatArray) -> FloatArray:
    """Values (P,) of the map (height, width) at places (P, 2), linear between texels."""
    at = uv_px - 0.5
    low = np.clip(np.floor(at).astype(int), 0, np.array(texels.shape)[::-1] - 2)
    x, y = (at - low).T
    column, row = low.T
    top = (1.0 - x) * texels[row, column] + x * texels[row, column + 1]
    below = (1.0 - x) * texels[row + 1, column] + x * texels[row + 1, column + 1]
    return np.asarray((1.0 - y) * top + y * below, float)


class Found(NamedTuple):
    """Light (P,) as luminance at visible points, by the map and by the reference."""

    points: Points
    by_map: FloatArray
    true: FloatArray
    least: float

    @property
    def error(self) -> FloatArray:
        """Relative (P,)."""
        return (self.by_map - self.true) / (self.true + self.least)


def found_in(
    scene: SceneOpened, hour: Illumination, which: Callable[[FloatArray, SceneTransport], BoolArray]
) -> tuple[Found, SceneTransport, Surfaces]:
    """The light of both at crease points of a scene, at the usual quality."""
    quality = quality_for(DEFAULT_TOLERANCE)
    surfaces = surfaces_of(scene)
    layout = lay_out(scene, surfaces, None, quality.texels)
    transport = SceneTransport(surfaces, layout, 2, quality.patch_texels, quality.bounces_left)
    transport.add_rays(quality.rays)
    fine = SceneTransport(
        surfaces, lay_out(scene, surfaces, None, 2 * quality.texels), 2, 2.0, 1e-3, transport.tree
    )
    fine.add_rays(64)
    points = crease_points(transport, surfaces, layout, which)
    # An even chance for points on facets: a hair off the surface, as the map's own rays.
    places_m = points.place_m + OFF * surfaces.radius_m * points.normal
    true = light_at(fine, places_m, points.shading, fine.light(hour), _RAYS // 32, 2)
    column, line = np.floor(points.uv_px).astype(int).T
    width_m = transport.texels.width[transport.texels.row_of[line, column]] * surfaces.radius_m
    seen = (true.free >= _LEAST_FREE) & (true.room_m >= _LEAST_ROOM * width_m)
    seen = np.flatnonzero(seen)[:_POINTS]
    points = Points(*(each[seen] for each in points))
    true = light_at(fine, places_m[seen], points.shading, fine.light(hour), _RAYS, 2)
    by_map = luminance(transport.light(hour).texels[..., :3].astype(float))
    light = looked_up(by_map, points.look_up_px)
    expected = np.asarray(luminance(true.irradiance_rgb), float)
    mean = float(np.exp(np.mean(np.log(expected + 1e-3 * expected.mean()))))
    return Found(points, light, expected, _LEAST_OF_MEAN * mean), transport, surfaces


def by_mitsuba(surfaces: Surfaces, hour: Illumination, points: Points) -> FloatArray:
    """Luminance (P,) of the irradiance at points without the key light's own, path traced."""
    mi = load_mitsuba("scalar")
    parts: dict[str, Any] = {"type": "scene", "sky": sky_emitter(mi, hour.sky)}
    if np.any(np.asarray(hour.key_irradiance_rgb) > 0.0):
        parts["sun"] = {
            "type": "directional",
            "direction": [-float(value) for value in hour.key_direction],
            "irradiance": {"type": "rgb", "value": [float(v) for v in hour.key_irradiance_rgb]},
        }
    reflectance = surfaces.reflectance_rgb.copy()
    reflectance[surfaces.part == GROUND] = hour.ground_albedo_rgb
    paints = np.concatenate([reflectance, surfaces.emitted_rgb], axis=1)
    colours, which = np.unique(paints, axis=0, return_inverse=True)
    for number, colour in enumerate(colours):
        own = surfaces.corners_m[which.ravel() == number].reshape(-1, 3)
        paint = {"type": "rgb", "value": colour[:3].tolist()}
        properties = mi.Properties()
        properties["bsdf"] = mi.load_dict(
            {"type": "twosided", "bsdf": {"type": "diffuse", "reflectance": paint}}
        )
        if np.any(colour[3:] > 0.0):
            glow = {"type": "rgb", "value": (colour[3:] / np.pi).tolist()}
            properties["emitter"] = mi.load_dict({"type": "area", "radiance": glow})
        mesh = mi.Mesh(f"m{number}", len(own), len(own) // 3, props=properties)
        values = mi.traverse(mesh)
        values["vertex_positions"] = own.astype(np.float32).ravel()
        values["faces"] = np.arange(len(own), dtype=np.uint32)
        values.update()
        parts[f"m{number}"] = mesh
    scene = mi.load_dict(parts)
    integrator = mi.load_dict({"type": "path", "max_depth": _BOUNCES})
    light = np.empty(len(points.place_m))
    places = points.place_m - surfaces.centre_m + 2.0 * OFF * surfaces.radius_m * points.normal
    sampler = mi.load_dict({"type": "independent"})
    rng = np.random.default_rng(1)
    for n, (place, normal) in enumerate(zip(places, points.shading, strict=True)):
        sampler.seed(n)
        across = np.cross(normal, np.eye(3)[np.argmin(np.abs(normal))])
        across /= np.linalg.norm(across)
        u, turn = rng.random(_SAMPLES), 2.0 * np.pi * rng.random(_SAMPLES)
        u = (np.arange(_SAMPLES) + u) / _SAMPLES
        level = np.sqrt(u)[:, None]
        ways = (
            level
            * (np.cos(turn)[:, None] * across + np.sin(turn)[:, None] * np.cross(normal, across))
            + np.sqrt(1.0 - u)[:, None] * normal
        )
        total = np.zeros(3)
        for way in ways:
            ray = mi.RayDifferential3f(mi.Point3f(place), mi.Vector3f(way))
            total += np.asarray(integrator.sample(scene, sampler, ray)[0])
        light[n] = luminance(np.pi * total / _SAMPLES)
    return light


def row(
    caption: str,
    scene: SceneOpened,
    hour: Illumination,
    which: Callable[[FloatArray, SceneTransport], BoolArray],
    traced: int,
) -> tuple[str, FloatArray]:
    """A line of the table, and the errors."""
    found, _, surfaces = found_in(scene, hour, which)
    error = found.error
    cells = [
        f"{len(error)}", f"{_rms(error):.1%}", f"{np.median(np.abs(error)):.1%}",
        f"{np.mean(np.abs(error) > 0.25):.1%}", f"{np.mean(error):+.1%}",
    ]  # fmt: skip
    if traced:
        some = slice(0, traced)
        true = by_mitsuba(surfaces, hour, Points(*(each[some] for each in found.points)))
        for light in (found.true, found.by_map):
            cells.append(f"{_rms((light[some] - true) / (true + found.least)):.1%}")
    else:
        cells += ["", ""]
    return f"| {caption} | {' | '.join(cells)} |", error


def _rms(error: FloatArray | BoolArray) -> float:
    return float(np.sqrt(np.mean(np.square(error))))


def rooms(count: int) -> Iterator[tuple[str, TrialRoom]]:
    """Random rooms, always the same."""
    for seed in range(count):
        yield f"room {seed}", crease_room(np.random.default_rng(seed))


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition(":")[0])
    parser.add_argument("scenes", nargs="*", default=SCENES)
    parser.add_argument("--rooms", type=int, default=30)
    parser.add_argument("--mitsuba", type=int, default=0)
    chosen = parser.parse_args()
    print(f"{HEADER}\n|---|{'---:|' * 7}", flush=True)
    for name in chosen.scenes:
        for case, state in states(name, "dynamic_skylight", ("12:30",)):
            assert state.scene is not None
            assert state.camera is not None
            which, hour = seen_from(state.camera.eye_m), light_of_state(state)
            line, _ = row(case.caption, state.scene, hour, which, chosen.mitsuba)
            print(line, flush=True)
    errors = []
    for caption, room in rooms(chosen.rooms):
        which = in_box(inside_of(room))
        line, error = row(caption, scene_of(room), hour_of(room), which, chosen.mitsuba)
        errors.append(error)
        print(line, flush=True)
    if errors:
        every = np.concatenate(errors)
        median = np.median([_rms(error) for error in errors])
        print(f"| all rooms | {len(every)} | {_rms(every):.1%}, of rooms {median:.1%} | | | | | |")


if __name__ == "__main__":
    main()
