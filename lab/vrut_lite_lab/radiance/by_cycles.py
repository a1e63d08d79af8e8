"""A scene's light by Cycles, under the sky of an hour as a panorama and its sun as a lamp."""

import os
import subprocess
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
import OpenEXR
from light_transport.hour.illumination import Illumination
from light_transport.surfaces.surfaces import GROUND, Surfaces

from vrut_lite.geometry.cube_map import sample_cube
from vrut_lite.geometry.panorama import lat_long_directions
from vrut_lite.messages.camera import MoveCamera, look_at
from vrut_lite.numeric_types import FloatArray
from vrut_lite_lab.radiance.scene_files import turned

_ROWS = 512


def irradiance_by_cycles(
    surfaces: Surfaces, hour: Illumination, places_m: FloatArray, samples: int, seed: int
) -> tuple[FloatArray, float]:
    """Irradiance (P, 3) of level planes without the key light's own, W m^-2, and CPU seconds."""
    found, spent_s = _asked(surfaces, hour, samples, seed, places=turned(places_m))
    return found["irradiance"], spent_s


def picture_by_cycles(
    surfaces: Surfaces,
    hour: Illumination,
    camera: MoveCamera,
    size_px: tuple[int, int],
    samples: int,
    seed: int,
) -> tuple[FloatArray, float]:
    """Radiance (height, width, 3) through the middles of pixels, and CPU seconds."""
    pose = np.eye(4)
    # Rows of the view's matrix are the camera's axes.
    pose[:3, :3] = turned(look_at(camera.eye_m, camera.target_m)[:3, :3]).T
    pose[:3, 3] = turned(np.asarray(camera.eye_m))
    angle = camera.vertical_field_of_view_rad
    found, spent_s = _asked(
        surfaces, hour, samples, seed, pose=pose, size=np.array(size_px), angle=angle
    )
    return found["picture"], spent_s


def _asked(
    surfaces: Surfaces, hour: Illumination, samples: int, seed: int, **wanted: Any
) -> tuple[dict[str, FloatArray], float]:
    reflectance = surfaces.reflectance_rgb.copy()
    reflectance[surfaces.part == GROUND] = hour.ground_albedo_rgb
    colours, paint = np.unique(reflectance, axis=0, return_inverse=True)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        np.savez(
            folder / "scene.npz",
            corners=turned(surfaces.corners_m + surfaces.centre_m),
            paint=paint.ravel(),
            colours=colours,
            sun=turned(np.asarray(hour.key_direction, float)),
            irradiance=np.asarray(hour.key_irradiance_rgb, float),
            **wanted,
        )
        _write_world(hour, folder / "world.exr")
        files = [folder / file for file in ("scene.npz", "world.exr", "out.npz")]
        script = Path(__file__).with_name("in_cycles.py")
        subprocess.run(
            [os.environ["BLENDER_PYTHON"], script, *files, str(samples), str(seed)],
            check=True,
            capture_output=True,
        )
        found = dict(np.load(folder / "out.npz"))
        return found, float(found["cpu_s"])


def _write_world(hour: Illumination, path: Path) -> None:
    """The sky as Blender's panorama, +Y (our north) a quarter left of its edge, ground below."""
    directions = lat_long_directions(_ROWS)
    up = directions[..., 1:2]
    # Half a texel above the horizon no ground is mixed in.
    raised = directions.copy()
    raised[..., 1] = np.maximum(raised[..., 1], 1.0 / hour.sky.shape[1])
    picture = np.where(up > 0.0, sample_cube(hour.sky, raised), hour.ground_radiance_rgb)
    # Blender's middle is +X, which is our east.
    turned_right = np.roll(picture, -_ROWS // 2, axis=1).astype(np.float32)
    OpenEXR.File({"type": OpenEXR.scanlineimage}, {"RGB": turned_right}).write(str(path))
