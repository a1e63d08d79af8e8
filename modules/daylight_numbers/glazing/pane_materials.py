"""Which triangles of a scene are panes of measured glazing, by names of materials."""

from collections.abc import Mapping
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from light_transport.public import Surfaces

from daylight_numbers.glazing.glass import Glass
from daylight_numbers.glazing.window_xml import MeasuredGlazing, read_window_xml
from vrut_lite.errors import UserError
from vrut_lite.messages.glazing import GlazingFile
from vrut_lite.messages.scene import SceneOpened
from vrut_lite.numeric_types import FloatArray, IntArray


class PaneMaterials(NamedTuple):
    """Glazings (G) by their materials' `names`, their vectors `up` (G, 3), and the glazing of each
    triangle (F,), -1 for none."""

    names: tuple[str, ...]
    glazings: tuple[MeasuredGlazing, ...]
    up: FloatArray
    of_triangle: IntArray

    def opaque(self, surfaces: Surfaces) -> Surfaces:
        """Surfaces on which panes are opaque, have two sides and send back what they do indoors."""
        is_pane = self.of_triangle >= 0
        back = np.array([glazing.reflectance_in for glazing in self.glazings])
        reflectance = np.where(
            is_pane[:, None], back[self.of_triangle][:, None], surfaces.reflectance_rgb
        )
        return replace(
            surfaces,
            opacity=np.where(is_pane, 1.0, surfaces.opacity).astype(np.float32),
            double_sided=surfaces.double_sided | is_pane,
            reflectance_rgb=reflectance.astype(np.float32),
        )

    def without(self, glass: Glass) -> Glass:
        """The glass of the other materials."""
        is_pane = self.of_triangle >= 0
        return glass._replace(tint=np.where(is_pane[:, None], np.float32(0.0), glass.tint))

    def opened(self, glass: Glass) -> Glass:
        """The glass of the other materials, and panes as if they were openings."""
        is_pane = self.of_triangle >= 0
        return Glass(
            np.where(is_pane[:, None], np.float32(1.0), glass.tint),
            np.where(is_pane, np.float32(1.0), glass.ior),
            np.where(is_pane, np.int32(1), glass.panes),
        )


def pane_materials(
    scene: SceneOpened, surfaces: Surfaces, files: Mapping[str, GlazingFile]
) -> PaneMaterials | None:
    """Reads the glazings of materials by their names; returns None without files.

    Raises:
        UserError: no material has a name, no surface a material, or a file cannot be read.
    """
    if not files:
        return None
    materials = scene.materials.all()
    known = sorted({material.name for material in materials})
    if unknown := sorted(set(files) - set(known)):
        raise UserError(
            f"bsdf: the scene has no material '{unknown[0]}'; it has {', '.join(known)}"
        )
    names = tuple(files)
    number = {name: n for n, name in enumerate(names)}
    of_part = [
        number.get(materials[scene.geometry.mesh(mesh).material].name, -1)
        for mesh in scene.geometry.part_mesh.values.tolist()
    ]
    # The last stands for the ground, whose part is -1.
    of_triangle = np.array([*of_part, -1], np.int64)[surfaces.part]
    for n, name in enumerate(names):
        if not np.any(of_triangle == n):
            raise UserError(f"bsdf: no surface of the scene has the material '{name}'")
    up = np.array([file.up for file in files.values()], float)
    glazings = tuple(read_window_xml(file.file) for file in files.values())
    return PaneMaterials(names, glazings, up, of_triangle)
