"""A project's scene with the sky of its hour, as a GLB file."""

from dataclasses import dataclass

import numpy as np

from vrut_lite.array import Array
from vrut_lite.geometry.encoding import decode_float16
from vrut_lite.project import Project
from vrut_lite.scene.glb_scene import scene_glb
from vrut_lite.scene.glb_sky import GlbSky
from vrut_lite.studio.picture_metadata import hour_text, picture_metadata
from vrut_lite.studio.scene_kernel import SceneKernel

_CONSUMER = "export"
# Edge of the scene's own cube maps, which nobody draws.
_BACKGROUND_PX = 16
# Names of a picture's metadata that hold for the sky of a scene too.
_FACTS = (
    "utc", "latitudeDeg", "longitudeDeg", "altitudeM", "northOffsetDeg", "skyModel",
    "sunElevationDeg", "sunAzimuthDeg",
)  # fmt: skip


@dataclass(frozen=True, eq=False)
class ExportedScene:
    """The file's bytes, import warnings, sentences on omitted content, and the hour as text."""

    data: bytes
    notices: tuple[str, ...]
    left_out: list[str]
    caption: str


def exported(project: Project, height_px: int) -> ExportedScene:
    """Open the scene under its sky, and write both.

    Raises:
        UserError: the project has an invalid value, or its scene cannot be read.
    """
    # A cube whose texels are no wider than the panorama's pixels.
    cube_px = int(2 ** np.ceil(np.log2(max(64, height_px))))
    kernel = SceneKernel(project, _CONSUMER, cube_px, _BACKGROUND_PX)
    try:
        light, scene = kernel.light, kernel.scene
        lighting = light.lighting
        # Without GL no GPU job runs, so the cube is an array.
        assert isinstance(lighting.cube, Array)
        facts = picture_metadata(project, kernel.kernel)
        sky = GlbSky(
            cube=decode_float16(lighting.cube.values, lighting.radiance_scale),
            height_px=height_px,
            key_light=light.key_light,
            facts={name: facts[name] for name in _FACTS if name in facts},
        )
        made = scene_glb(scene, sky)
        return ExportedScene(made.data, scene.notices, made.left_out, hour_text(facts))
    finally:
        kernel.close()
