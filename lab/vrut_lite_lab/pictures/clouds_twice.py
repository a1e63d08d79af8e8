"""The same clouds by the frame, by `vrut-lite sky`, by the path tracer and in a mirror.

    python -m vrut_lite_lab.pictures.clouds_twice PICTURE.jpg

Prints correlation and mean ratio of each one's luminance with the frame's, where the view is more
than 6 degrees above the horizon.
"""

import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
import OpenEXR
import trimesh

from vrut_lite.geometry.colour import luminance
from vrut_lite.numeric_types import FloatArray
from vrut_lite_lab.pictures.drawing import sheet

_COMMAND = "from vrut_lite.cli import main; main()"
_WIDTH, _HEIGHT, _FIELD_OF_VIEW_DEG, _LEAST_SINE = 240, 160, 65.0, 0.1
_RISE = 0.7
_CLOUDS = ["--at", "2026-06-21T10:00", "--genus", "Cu", "--coverage", "0.45"]


def drawn(folder: Path, *typed: str) -> FloatArray:
    """The radiance (h, w, 3) that a command writes."""
    file = folder / "drawn.exr"
    command = [sys.executable, "-c", _COMMAND, *typed, "-o", str(file), *_CLOUDS]
    subprocess.run(command, check=True)
    with OpenEXR.File(str(file)) as picture:
        return np.asarray(picture.channels()["RGB"].pixels, dtype=float)


def mirror(folder: Path) -> Path:
    """A scene of a level mirror of 50 m at the origin."""
    material = trimesh.visual.material.PBRMaterial(metallicFactor=1.0, roughnessFactor=0.0)
    plane = trimesh.Trimesh(
        np.array([[-25.0, 0, 25], [25, 0, 25], [25, 0, -25], [-25, 0, -25]]),
        [[0, 1, 2], [0, 2, 3]],
        visual=trimesh.visual.TextureVisuals(material=material),
    )
    plane.export(folder / "mirror.glb")
    return folder / "mirror.glb"


def directions() -> FloatArray:
    """Unit directions (h, w, 3) of the view's pixels, in world axes."""
    ahead = np.array([-1.0, _RISE, -1.0]) / np.sqrt(2.0 + _RISE * _RISE)
    right = np.cross(ahead, [0.0, 1.0, 0.0])
    right /= np.linalg.norm(right)
    half = np.tan(np.radians(_FIELD_OF_VIEW_DEG) / 2.0)
    across = ((2 * np.arange(_WIDTH) + 1) / _WIDTH - 1.0) * half * _WIDTH / _HEIGHT
    up = (1.0 - (2 * np.arange(_HEIGHT) + 1) / _HEIGHT) * half
    rays = ahead + across[:, None] * right + up[:, None, None] * np.cross(right, ahead)
    return np.asarray(rays / np.linalg.norm(rays, axis=-1, keepdims=True))


def looked_up(panorama: FloatArray, rays: FloatArray) -> FloatArray:
    """A panorama with north in its middle, in directions (..., 3): its nearest pixels."""
    height, width = panorama.shape[:2]
    turn = np.arctan2(rays[..., 0], -rays[..., 2]) / (2.0 * np.pi) + 0.5
    row = (0.5 - np.arcsin(rays[..., 1]) / np.pi) * height
    column = (turn * width).astype(int) % width
    return panorama[np.clip(row.astype(int), 0, height - 1), column]


def main(target: str) -> None:
    """Draw the four and compare them."""
    rays = directions()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        scene = str(mirror(folder))
        size = ["--size", f"{_WIDTH}x{_HEIGHT}", "--fov", f"{_FIELD_OF_VIEW_DEG:g}"]
        view = ["render", scene, *size, "--eye", "0,2,0", "--target"]
        up, down = f"-1,{2 + _RISE:g},-1", f"-1,{2 - _RISE:g},-1"
        traced = ["--engine", "path-tracer", "--spp", "4"]
        pictures = {
            "frame": drawn(folder, *view, up),
            "vrut-lite sky": looked_up(drawn(folder, "sky", "--size", "512"), rays),
            "path tracer": drawn(folder, *view, up, *traced),
            "a mirror in the frame": drawn(folder, *view, down)[::-1],
        }
    seen = rays[..., 1] > _LEAST_SINE
    frame = luminance(pictures["frame"])[seen]
    white = np.percentile(pictures["frame"], 90)
    shown = []
    for caption, picture in pictures.items():
        light = luminance(picture)[seen]
        alike = float(np.corrcoef(frame, light)[0, 1])
        print(f"{caption}: correlation {alike:.3f}, mean {light.mean() / frame.mean():.3f}")
        toned = (1.0 - np.exp(-1.2 * picture / white)).clip(0.0, 1.0) ** (1.0 / 2.2)
        shown.append((caption, np.asarray(255.0 * toned, dtype=np.uint8)))
    sheet(shown, 2, (480, 320)).save(target, quality=85)


if __name__ == "__main__":
    main(sys.argv[1])
