"""Scenes in three renderers under the very same sky, pixel for pixel: ours, Radiance, Cycles.

    BLENDER_PYTHON=PYTHON python -m vrut_lite_lab.radiance.pictures SHEET.webp [SCENE ...]

PYTHON has the package bpy. As in `three_renderers` all have the scene's triangles as Lambert's, the
sky of 12:30 as data and the sun. Ours: the sun by one ray from each pixel's surface, all other
light by rays that end on the light map. Prints a line for each renderer: mean and noise of its
pixels' luminance against the mean of the other two, and CPU seconds.
"""

import argparse
import os
import time
from pathlib import Path

import numpy as np
from light_transport.hour.illumination import Illumination
from light_transport.rays.trace import MISS, first_hits
from light_transport.surfaces.surfaces import GROUND
from light_transport.view.point_light import light_at

from vrut_lite.geometry.colour import luminance
from vrut_lite.geometry.cube_map import sample_cube
from vrut_lite.messages.camera import MoveCamera, pixel_rays
from vrut_lite.messages.picture import SetExposure
from vrut_lite.numeric_types import FloatArray
from vrut_lite.pictures.display import developed
from vrut_lite.pictures.exposure import automatic_ev100
from vrut_lite_lab.path_traced.cases import light_of_state, states
from vrut_lite_lab.pictures.drawing import Captioned, sheet
from vrut_lite_lab.radiance.by_cycles import picture_by_cycles
from vrut_lite_lab.radiance.grids import GRIDS, Baked, MeasuredPoints
from vrut_lite_lab.radiance.irradiance import RadianceEffort, radiance_by_radiance
from vrut_lite_lab.radiance.three_renderers import HOUR, SKY

_SIZE = (240, 150)
_RAYS, _RADIANCE_RAYS, _SAMPLES = 256, 64, 128
# Of the scene's radius: shadow rays begin so far above a surface.
_CLEARANCE = 1e-5
_BLACK = 1e-3


def our_picture(baked: Baked, hour: Illumination, camera: MoveCamera, rays: int) -> FloatArray:
    """Radiance (height, width, 3), W m^-2 sr^-1, through the middles of pixels."""
    surfaces, tree = baked.surfaces, baked.transport.tree
    directions = _directions(camera)
    eye = (np.asarray(camera.eye_m) - surfaces.centre_m) / surfaces.radius_m
    hits, distances = first_hits(tree, np.broadcast_to(eye, directions.shape), directions)
    found = hits != MISS
    seen, hit = directions[found], hits[found]
    corners = surfaces.corners_m[hit]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    normals *= -np.sign(np.sum(normals * seen, axis=1, keepdims=True))
    places = eye + distances[found, None] * seen + _CLEARANCE * normals
    towards = np.asarray(hour.key_direction, float)
    shadow, _ = first_hits(tree, places, np.broadcast_to(towards, places.shape))
    sunlit = np.where(shadow == MISS, np.maximum(normals @ towards, 0.0), 0.0)
    places_m = places * surfaces.radius_m + surfaces.centre_m
    light = light_at(
        baked.transport, places_m, normals, baked.transport.light(hour), rays
    ).irradiance_rgb
    light = light + sunlit[:, None] * np.asarray(hour.key_irradiance_rgb)
    reflectance = surfaces.reflectance_rgb[hit].astype(float)
    reflectance[surfaces.part[hit] == GROUND] = hour.ground_albedo_rgb
    up = directions[:, 1:2]
    radiance = np.where(up > 0.0, sample_cube(hour.sky, directions), hour.ground_radiance_rgb)
    radiance[found] = light * reflectance / np.pi
    return radiance.reshape(_SIZE[1], _SIZE[0], 3)


def _directions(camera: MoveCamera) -> FloatArray:
    x, y = np.meshgrid(np.arange(_SIZE[0]), np.arange(_SIZE[1]))
    return pixel_rays(camera, _SIZE, x, y).reshape(-1, 3)


def pictures(
    baked: Baked, hour: Illumination, camera: MoveCamera
) -> dict[str, tuple[FloatArray, float]]:
    """Each renderer's picture and CPU seconds."""
    start = time.process_time()
    ours = our_picture(baked, hour, camera, _RAYS)
    ours_s = time.process_time() - start
    before = os.times()
    theirs = radiance_by_radiance(
        baked.surfaces, hour, camera.eye_m, _directions(camera), RadianceEffort(_RADIANCE_RAYS)
    )
    radiance_s = os.times().children_user - before.children_user
    cycles = picture_by_cycles(baked.surfaces, hour, camera, _SIZE, _SAMPLES, 0)
    return {
        "vrut_lite": (ours, ours_s),
        "Radiance": (theirs.reshape(ours.shape), radiance_s),
        "Cycles": cycles,
    }


def _lines(found: dict[str, tuple[FloatArray, float]]) -> list[str]:
    """Each against the mean of the other two, in shares of the picture's mean."""
    values = {name: np.asarray(luminance(picture)) for name, (picture, _) in found.items()}
    lines = []
    for name, own in values.items():
        others = [value for key, value in values.items() if key != name]
        expected = np.mean(others, axis=0)
        # Edges of shadows: the sun's disc is a point to ours and to Radiance.
        error = (own - expected) / np.maximum(expected, _BLACK * expected.mean())
        mean = own.mean() / expected.mean() - 1.0
        middle = np.median(np.abs(error))
        lines.append(f"| {name} | {mean:+.2%} | {middle:.2%} | {found[name][1]:.1f} |")
    return lines


def drawn(grid: MeasuredPoints) -> list[Captioned]:
    """The row of a scene; its lines are printed."""
    ((case, state),) = states(grid.file, SKY, (HOUR,))
    assert state.scene is not None
    assert state.camera is not None
    found = pictures(Baked(state.scene), light_of_state(state), state.camera)
    print(f"| **{case.caption}** | | | |")
    print("\n".join(_lines(found)), flush=True)
    ev100 = automatic_ev100(found["vrut_lite"][0].astype(np.float32))
    exposure = SetExposure(mode="manual", ev100=ev100)
    return [
        (
            f"{Path(grid.scene).stem}, {name}",
            developed(picture.astype(np.float32), exposure).display,
        )
        for name, (picture, _) in found.items()
    ]


def main() -> None:
    """Draw the sheet."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition(":")[0])
    parser.add_argument("sheet", type=Path)
    names = [grid.scene for grid in GRIDS]
    parser.add_argument("scenes", nargs="*", default=names, help=f"of {', '.join(names)}")
    wanted = parser.parse_args()
    print("| | mean | median pixel | CPU s |\n|---|---:|---:|---:|")
    rows = [drawn(grid) for grid in GRIDS if grid.scene in wanted.scenes]
    sheet([picture for row in rows for picture in row], 3).save(wanted.sheet, quality=85)


if __name__ == "__main__":
    main()
