"""glTF's lamps: KHR_lights_punctual and EXT_lights_ies.

A lamp shines along its node's -Z, and a node's scale does not change it. `range` is a hint for
renderers that must end a lamp's light somewhere: it is not read. Directional lights are not drawn:
the sun is the host's.
"""

import numpy as np

from vrut_lite.messages.lamps import ALL_AROUND
from vrut_lite.scene.gltf_file import GltfFile, item_at
from vrut_lite.scene.gltf_nodes import PlacedNode
from vrut_lite.scene.gltf_schema import Lamp, Spot
from vrut_lite.scene.ies_file import read_ies
from vrut_lite.scene.lamps import PlacedLamp
from vrut_lite.scene.photometry import Photometry
from vrut_lite.scene.scene_file_error import SceneFileError


class GltfLamps:
    """The lamps of a document; each of its IES files is read once."""

    def __init__(self, file: GltfFile) -> None:
        self._file = file
        self._photometries: dict[int, Photometry] = {}

    def placed(self, nodes: list[PlacedNode]) -> list[PlacedLamp]:
        """The lamps that these nodes carry.

        Raises:
            SceneFileError: for references or values that do not hold.
        """
        punctual = [lamp for one in nodes for lamp in self._punctual(one)]
        return punctual + [lamp for one in nodes for lamp in self._luminaires(one)]

    def tell_unread(self, nodes: list[PlacedNode]) -> None:
        """Tell what of them is not drawn."""
        for one in nodes:
            lamp = self._lamp(one)
            if lamp is not None and lamp.type == "directional":
                self._file.notices.tell("directional light", "the sun of the hour shines instead")

    def _lamp(self, placed: PlacedNode) -> Lamp | None:
        reference = placed.node.extensions.lamp
        if reference is None:
            return None
        return item_at(self._file.document.extensions.punctual.lights, reference.light, "light")

    def _punctual(self, placed: PlacedNode) -> list[PlacedLamp]:
        lamp = self._lamp(placed)
        if lamp is None or lamp.type == "directional":
            return []
        return [
            PlacedLamp(
                names=(placed.node.name, lamp.name),
                world_from_lamp=placed.scene_from_node,
                colour_rgb=np.array(lamp.color),
                candela=lamp.intensity,
                cone_cos=_cone_cos(lamp.name, lamp.spot) if lamp.type == "spot" else ALL_AROUND,
                photometry=None,
            ).checked()
        ]

    def _luminaires(self, placed: PlacedNode) -> list[PlacedLamp]:
        instance = placed.node.extensions.ies
        if instance is None:
            return []
        profiles = self._file.document.extensions.ies.lights
        profile = item_at(profiles, instance.light, "light profile")
        photometry = self._photometry(instance.light)
        return [
            PlacedLamp(
                names=(placed.node.name, profile.name),
                world_from_lamp=placed.scene_from_node,
                colour_rgb=np.clip(instance.color, 0.0, 1.0),
                candela=photometry.candela * instance.multiplier,
                cone_cos=ALL_AROUND,
                photometry=photometry,
            ).checked()
        ]

    def _photometry(self, number: int) -> Photometry:
        if number not in self._photometries:
            profile = self._file.document.extensions.ies.lights[number]
            if profile.uri is not None:
                data = bytes(self._file.folder.get_uri(profile.uri))
            elif profile.buffer_view is not None:
                data = bytes(self._file.view_bytes(profile.buffer_view))
            else:
                raise SceneFileError("a light profile of it has no data; export it again")
            self._photometries[number] = read_ies(data).photometry()
        return self._photometries[number]


def _cone_cos(name: str, spot: Spot) -> tuple[float, float]:
    if not spot.inner_cone_angle <= spot.outer_cone_angle:
        raise SceneFileError(
            f"the spot {ascii(name)[:60]} has an inner cone wider than its outer one; mend it"
        )
    return float(np.cos(spot.inner_cone_angle)), float(np.cos(spot.outer_cone_angle))
