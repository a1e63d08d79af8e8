"""Light at creases as finished stills show it: points of the picture over the map.

    python -m vrut_lite_lab.path_traced.still_creases [--rooms N]

Each random room of `creases` is looked at from two sides, one towards its window, at 960 x 540. The
columns are rms errors at the crease points in view: by the map alone, by the picture's points
alone, and mixed as the frame does; CPU seconds of the points.
"""

import argparse
from collections.abc import Iterator
from time import process_time
from typing import NamedTuple

import numpy as np
from light_transport.giving_up import always
from light_transport.rays.ray_starts import OFF
from light_transport.view.view_light import ViewLight, view_light

from vrut_lite.geometry.colour import luminance
from vrut_lite.messages.camera import MoveCamera
from vrut_lite.numeric_types import BoolArray, FloatArray
from vrut_lite_lab.path_traced.creases import Points, found_in, in_box, rooms, seen_from
from vrut_lite_lab.scenes.crease_rooms import inside_of
from vrut_lite_lab.tolerance.light_transport import TrialRoom, hour_of, scene_of

SIZE_PX, EDGE_PX = (960, 540), 4
# As in surface_light.glsl.
_FINE_POINTS, _SAME_PLANE, _SAME_FACING, _FEW_POINTS = 0.5, 2e-3, 0.97, 0.1
# Shares of a room's width, height and depth: eye and target of its two views.
_VIEWS = (((0.5, 0.55, 0.9), (0.45, 0.25, 0.2)), ((0.45, 0.55, 0.1), (0.5, 0.25, 0.8)))
_CLEAR_M, _ASIDE_M = 0.15, (0.11, 0.0, 0.013)


class Seen(NamedTuple):
    """Points (P) in a picture: pixels (P, 2) from the top left, and how far points of the view lie
    apart there (P,), in metres. `is_shown` (P,): within the picture."""

    at_px: FloatArray
    apart_m: FloatArray
    is_shown: BoolArray


def seen_in(camera: MoveCamera, points: Points) -> Seen:
    """Where a camera sees points."""
    away = points.place_m - np.asarray(camera.eye_m)
    forward = np.subtract(camera.target_m, camera.eye_m)
    forward = forward / np.linalg.norm(forward)
    right = np.cross(forward, (0.0, 1.0, 0.0))
    right /= np.linalg.norm(right)
    up = np.cross(right, forward)
    width, height = SIZE_PX
    pixel = 2.0 * np.tan(0.5 * camera.vertical_field_of_view_rad) / height
    depth = away @ forward
    at_px = np.stack(
        [
            0.5 * width + away @ right / depth / pixel,
            0.5 * height - away @ up / depth / pixel,
        ],
        axis=1,
    )
    shown = (
        (depth > 0.0) & (at_px > 1.0).all(axis=1) & (at_px < np.subtract(SIZE_PX, 1)).all(axis=1)
    )
    apart_m = np.zeros(len(away))
    level = np.einsum("pi,pi->p", away, points.normal)
    for axis in (right, up):
        beside = away + depth[:, None] * pixel * axis
        met = beside * (level / np.einsum("pi,pi->p", beside, points.normal))[:, None]
        apart_m = np.maximum(apart_m, np.linalg.norm(met - away, axis=1))
    return Seen(at_px, EDGE_PX * apart_m, shown)


def light_of_points(
    view: ViewLight, camera: MoveCamera, points: Points, at_px: FloatArray
) -> FloatArray:
    """Luminance (P,) that a frame takes from the points of a view, NaN where from none."""
    light = luminance(view.light[..., :3].astype(float))
    away = points.place_m - np.asarray(camera.eye_m)
    reach = _SAME_PLANE * np.linalg.norm(away, axis=1)
    at = at_px / EDGE_PX - 0.5
    first = np.floor(at).astype(int)
    share = at - first

    def sums(offsets: range) -> tuple[FloatArray, FloatArray]:
        total, found = np.zeros((2, len(away)))
        for x in offsets:
            for y in offsets:
                column = np.clip(first[:, 0] + x, 0, light.shape[1] - 1)
                row = np.clip(first[:, 1] + y, 0, light.shape[0] - 1)
                plane = view.plane[row, column].astype(float)
                same = np.einsum("pi,pi->p", plane[:, :3], points.normal) >= _SAME_FACING
                off = np.einsum("pi,pi->p", plane[:, :3], away) - plane[:, 3]
                near = np.maximum(1.0 - np.abs((x, y) - share), 1e-3).prod(axis=1)
                weight = np.where(same & (np.abs(off) <= reach), near, 0.0)
                total, found = total + weight, found + weight * light[row, column]
        return total, found

    (four, of_four), (more, of_more) = sums(range(2)), sums(range(-1, 3))
    total = np.where(four < _FEW_POINTS, more, four)
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.asarray(np.where(four < _FEW_POINTS, of_more, of_four) / total)


def cameras(room: TrialRoom) -> Iterator[MoveCamera]:
    """Two views of a room from points in its air."""
    lower, upper = inside_of(room)
    boxes = np.array(room.boxes)
    for eye, target in _VIEWS:
        eye_m = lower + eye * (upper - lower)
        while np.any(
            ((eye_m > boxes[:, :3] - _CLEAR_M) & (eye_m < boxes[:, 3:] + _CLEAR_M)).all(1)
        ):
            eye_m = eye_m + _ASIDE_M
        x, y, z = (lower + target * (upper - lower)).tolist()
        yield MoveCamera(
            eye_m=tuple(eye_m.tolist()), target_m=(x, y, z), vertical_field_of_view_rad=1.0
        )


def errors(room: TrialRoom) -> Iterator[tuple[FloatArray, FloatArray, FloatArray, float]]:
    """For each view the errors (P,) by the map, by points and by both, and CPU seconds."""
    hour = hour_of(room)
    found, transport, surfaces = found_in(scene_of(room), hour, in_box(inside_of(room)))
    points, lit = found.points, transport.light(hour)
    column, row = np.floor(points.uv_px).astype(int).T
    width_m = transport.texels.width[transport.texels.row_of[row, column]] * surfaces.radius_m
    off_m = points.place_m + 10.0 * OFF * surfaces.radius_m * points.normal
    for camera in cameras(room):
        began_s = process_time()
        view = view_light(transport, hour, lit, camera, SIZE_PX, EDGE_PX, transport.rays, 2, always)
        took_s = process_time() - began_s
        seen = seen_in(camera, points)
        own = light_of_points(view, camera, points, seen.at_px)
        own = np.where(np.isfinite(own), own, found.by_map)
        x = np.clip(seen.apart_m / width_m / _FINE_POINTS - 1.0, 0.0, 1.0)
        both = own + x * x * (3.0 - 2.0 * x) * (found.by_map - own)
        shown = seen.is_shown & seen_from(camera.eye_m)(off_m, transport)
        by_map, by_points, mixed = (
            ((light - found.true) / (found.true + found.least))[shown]
            for light in (found.by_map, own, both)
        )
        yield by_map, by_points, mixed, took_s


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition(":")[0])
    parser.add_argument("--rooms", type=int, default=12)
    print(f"| room, view | points | map | picture's points | both | CPU s |\n|---|{'---:|' * 5}")
    every: list[tuple[FloatArray, ...]] = []
    for caption, room in rooms(parser.parse_args().rooms):
        for number, (*kinds, took_s) in enumerate(errors(room)):
            every.append(tuple(kinds))
            cells = " | ".join(f"{_rms(kind):.1%}" for kind in kinds)
            print(f"| {caption}, {number} | {len(kinds[0])} | {cells} | {took_s:.1f} |", flush=True)
    whole = [np.concatenate(kind) for kind in zip(*every, strict=True)]
    cells = " | ".join(f"{_rms(kind):.1%}" for kind in whole)
    print(f"| all | {len(whole[0])} | {cells} | |")


def _rms(error: FloatArray) -> float:
    return float(np.sqrt(np.mean(np.square(error))))


if __name__ == "__main__":
    main()
