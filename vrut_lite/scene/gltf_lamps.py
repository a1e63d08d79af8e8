"""glTF's lamps (KHR_lights_punctual, EXT_lights_ies) in world axes.

A lamp shines along its node's -Z, and a node's scale does not change it. `range` is a hint for
renderers that must end a lamp's light somewhere: it is not read. Directional lights are not drawn:
the sun is the host's.
"""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from vrut_lite.array import Array
from vrut_lite.daylight.lamps import (
    ALL_AROUND,
    MOST_LAMPS,
    NONE,
    TABLE_SHAPE,
    SceneLamps,
    brightest_first,
)
from vrut_lite.geometry.colour import LUMENS_PER_WATT, luminance
from vrut_lite.numeric_types import FloatArray
from vrut_lite.scene.gltf_file import GltfFile, item_at
from vrut_lite.scene.gltf_schema import IesInstance, LampIndex, Node
from vrut_lite.scene.ies_file import Photometry, read_ies
from vrut_lite.scene.scene_file_error import SceneFileError

_LONGEST_NAME = 80
_MOST_INTENSITY = 1e12
# A node's own axis that lies along the light, but for rounding.
_LEVEL = 1e-9


class _Lamp(NamedTuple):
    name: str
    world_from_node: NDArray[np.float64]
    intensity_rgb: FloatArray
    cone_cos: tuple[float, float]
    photometry: Photometry | None


def read_gltf_lamps(
    file: GltfFile,
    nodes: list[tuple[Node, NDArray[np.float64]]],
    luminaires: Mapping[str, bytes],
) -> SceneLamps | None:
    """The lamps that these nodes with their matrices (4, 4) to world axes carry, None without any.

    `luminaires` are IES files by the name of a lamp or of its node: such a lamp has the file's
    candela, in its own colour.

    Raises:
        SceneFileError: for values that are impossible, or a name that no lamp has.
    """
    reader = _Reader(file, luminaires)
    for node, world_from_node in nodes:
        reader.read(node, world_from_node)
    reader.check_names()
    return _packed(reader.lamps)


class _Reader:
    """Collects lamps; each IES file is read once."""

    def __init__(self, file: GltfFile, luminaires: Mapping[str, bytes]) -> None:
        self.lamps: list[_Lamp] = []
        self._file = file
        self._luminaires = luminaires
        self._used: set[str] = set()
        self._read: dict[int, Photometry] = {}

    def read(self, node: Node, world_from_node: NDArray[np.float64]) -> None:
        """Take the lamps of a node."""
        punctual, profile = node.extensions.lamp, node.extensions.ies
        if punctual is not None:
            self._read_punctual(node, world_from_node, punctual)
        if profile is not None:
            self._read_profile(node, world_from_node, profile)

    def _read_punctual(
        self, node: Node, world_from_node: NDArray[np.float64], reference: LampIndex
    ) -> None:
        lamps = self._file.document.extensions.punctual.lights
        lamp = item_at(lamps, reference.light, "light")
        if lamp.type == "directional":
            self._file.notices.tell("directional light", "the sun of the hour shines instead")
            return
        colour, candela = np.array(lamp.color), lamp.intensity
        cone, photometry = ALL_AROUND, self._named(node.name, lamp.name)
        if photometry is not None:
            # The file's candela, in the lamp's colour.
            colour = colour / max(float(luminance(colour)), 1e-9) if colour.any() else colour
            candela = photometry.candela
        elif lamp.type == "spot":
            if not lamp.spot.inner_cone_angle <= lamp.spot.outer_cone_angle:
                raise SceneFileError(
                    f"the spot {_shown(lamp.name)} has an inner cone wider than its outer one; "
                    "mend it"
                )
            cone = (
                float(np.cos(lamp.spot.inner_cone_angle)),
                float(np.cos(lamp.spot.outer_cone_angle)),
            )
        self._add(node.name or lamp.name, world_from_node, colour * candela, cone, photometry)

    def _read_profile(
        self, node: Node, world_from_node: NDArray[np.float64], instance: IesInstance
    ) -> None:
        profiles = self._file.document.extensions.ies.lights
        profile = item_at(profiles, instance.light, "light profile")
        if instance.light not in self._read:
            if profile.uri is not None:
                data = bytes(self._file.folder.get_uri(profile.uri))
            elif profile.buffer_view is not None:
                data = bytes(self._file.view_bytes(profile.buffer_view))
            else:
                raise SceneFileError("a light profile of it has no data; export it again")
            self._read[instance.light] = read_ies(data)
        photometry = self._named(node.name, profile.name) or self._read[instance.light]
        colour = np.clip(instance.color, 0.0, 1.0) * instance.multiplier
        candela = colour * photometry.candela
        self._add(node.name or profile.name, world_from_node, candela, ALL_AROUND, photometry)

    def _named(self, *names: str) -> Photometry | None:
        """The luminaire that one of these names was given."""
        for name in names:
            if name and name in self._luminaires:
                self._used.add(name)
                return read_ies(self._luminaires[name])
        return None

    def _add(
        self,
        name: str,
        world_from_node: NDArray[np.float64],
        candela_rgb: FloatArray,
        cone_cos: tuple[float, float],
        photometry: Photometry | None,
    ) -> None:
        if not (np.all(candela_rgb >= 0.0) and np.all(candela_rgb <= _MOST_INTENSITY)):
            raise SceneFileError(f"the lamp {_shown(name)} has an impossible intensity; mend it")
        if not np.all(np.isfinite(world_from_node)):
            raise SceneFileError(f"the lamp {_shown(name)} stands nowhere; mend its node")
        if not candela_rgb.any():
            return
        if len(self.lamps) == MOST_LAMPS:
            raise SceneFileError(f"it has more than {MOST_LAMPS} lamps; remove some")
        intensity = np.asarray(candela_rgb, float) / LUMENS_PER_WATT
        self.lamps.append(_Lamp(name, world_from_node, intensity, cone_cos, photometry))

    def check_names(self) -> None:
        """Raise for a luminaire whose name no lamp has."""
        for name in self._luminaires.keys() - self._used:
            there = ", ".join(_shown(lamp.name) for lamp in self.lamps[:8]) or "none"
            raise SceneFileError(
                f"the project gives a luminaire to the lamp {_shown(name)}, which it does not "
                f"have; its lamps are {there}"
            )


def _packed(lamps: list[_Lamp]) -> SceneLamps | None:
    if not lamps:
        return None
    order = brightest_first(np.array([lamp.intensity_rgb for lamp in lamps]))
    lamps = [lamps[number] for number in order]
    tables: dict[bytes, int] = {}
    numbers = [_table_number(lamp.photometry, tables) for lamp in lamps]
    joined = np.frombuffer(b"".join(tables), np.float32).reshape(-1, *TABLE_SHAPE)
    names = "\n".join(" ".join(lamp.name.split())[:_LONGEST_NAME] for lamp in lamps)
    return SceneLamps(
        names=Array(np.frombuffer(names.encode(errors="replace"), np.uint8)),
        position_m=Array(np.array([lamp.world_from_node[:3, 3] for lamp in lamps])),
        axes=Array(np.array([_axes(lamp.world_from_node) for lamp in lamps])),
        intensity_rgb=Array(np.array([lamp.intensity_rgb for lamp in lamps])),
        cone_cos=Array(np.array([lamp.cone_cos for lamp in lamps])),
        table=Array(np.array(numbers, np.int32)),
        tables=Array(joined),
    )


def _table_number(photometry: Photometry | None, tables: dict[bytes, int]) -> int:
    if photometry is None:
        return NONE
    return tables.setdefault(photometry.table.tobytes(), len(tables))


def _axes(world_from_node: NDArray[np.float64]) -> FloatArray:
    """Rows -Z, +X and +Y of a node, made unit and upright; of one without a direction -Z's."""
    x, y, z = world_from_node[:3, :3].T
    forward = -z / np.linalg.norm(z) if np.any(z) else np.array([0.0, -1.0, 0.0])
    across = x - (x @ forward) * forward
    if not np.linalg.norm(across) > _LEVEL * np.linalg.norm(x):
        helper = np.eye(3)[np.argmin(np.abs(forward))]
        across = helper - (helper @ forward) * forward
    across /= np.linalg.norm(across)
    side = np.cross(across, forward)
    # A mirrored node has mirrored luminaires.
    return np.array([forward, across, -side if side @ y < 0.0 else side])


def _shown(name: str) -> str:
    return ascii(name)[:60]
