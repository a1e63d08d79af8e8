"""The common parts of scripts that draw pictures: scenes, shots, cameras, captioned sheets."""

from collections.abc import Iterator, Sequence
from typing import Any

import msgspec
import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

from vrut_lite.messages.camera import look_at
from vrut_lite.numeric_types import FloatArray
from vrut_lite.project import Project, load_project
from vrut_lite.studio.scene_pictures import ScenePlan, SceneShot
from vrut_lite_lab.checkout import ROOT

SCENES = ROOT / "scenes"
SKIES = {"dynamic_skylight": "Hosek-Wilkie", "bruneton_sky": "Bruneton"}
# Of pictures of a sky alone.
WIDTH, HEIGHT = 480, 300
_FIELD_OF_VIEW_DEG = 62.0
_CAPTION_PX = 18

Captioned = tuple[str, NDArray[np.integer]]


def scene_project(scene: str, **changes: Any) -> Project:
    """The project of a file in `scenes/`, a scene or a project file, with some fields changed."""
    path = SCENES / scene
    project = load_project(path) if path.suffix == ".toml" else Project(scene=str(path))
    return msgspec.structs.replace(project, **changes)


def shots(project: Project, times: Sequence[str]) -> Iterator[SceneShot]:
    """The project's scene at local times such as 2026-06-21T07:00."""
    studio = ScenePlan(project).open()
    try:
        for time in times:
            yield studio.shoot(msgspec.structs.replace(project, at=time).instant())
    finally:
        studio.close()


def sheet(
    pictures: Sequence[Captioned], columns: int, size: tuple[int, int] | None = None
) -> Image.Image:
    """Pictures of one size in rows, captions above them; scaled to a size (width, height)."""
    height, width = pictures[0][1].shape[:2]
    width, height = size or (width, height)
    pitch = height + _CAPTION_PX
    rows = -(-len(pictures) // columns)
    paper = Image.new("RGB", (columns * width, rows * pitch), (24, 24, 24))
    pen, font = ImageDraw.Draw(paper), ImageFont.load_default(12)
    for number, (caption, pixels) in enumerate(pictures):
        left, top = width * (number % columns), pitch * (number // columns)
        picture = Image.fromarray(pixels)
        if picture.size != (width, height):
            picture = picture.resize((width, height), Image.Resampling.LANCZOS)
        paper.paste(picture, (left, top + _CAPTION_PX))
        pen.text((left + 4, top + 2), caption, (230, 230, 230), font=font)
    return paper


def sun_direction(elevation_deg: float, azimuth_deg: float) -> FloatArray:
    """Unit vector (3,) to the sun in world axes; azimuth from north, clockwise."""
    elevation, azimuth = np.radians(elevation_deg), np.radians(azimuth_deg)
    level = np.cos(elevation)
    return np.array([level * np.sin(azimuth), np.sin(elevation), -level * np.cos(azimuth)])


def view_directions(pitch_deg: float) -> FloatArray:
    """Unit world directions (HEIGHT, WIDTH, 3) of a camera that looks north and up."""
    pitch = np.radians(pitch_deg)
    view = look_at((0.0, 0.0, 0.0), (0.0, float(np.sin(pitch)), float(-np.cos(pitch))))
    half = np.tan(np.radians(_FIELD_OF_VIEW_DEG) / 2)
    x = (2 * np.arange(WIDTH) + 1) / WIDTH - 1
    y = 1 - (2 * np.arange(HEIGHT) + 1) / HEIGHT
    rays: Any = np.stack(
        np.broadcast_arrays(half * WIDTH / HEIGHT * x, half * y[:, None], -1.0), axis=-1
    )
    rays = rays / np.linalg.norm(rays, axis=-1, keepdims=True)
    return np.asarray(rays @ view[:3, :3])
