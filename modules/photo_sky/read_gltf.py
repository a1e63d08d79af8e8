"""Reads the sky of a glTF file: the panorama of OMI_environment_sky, and its sun.

The sky is the one that the default scene names; the sun the brightest directional light of
KHR_lights_punctual in it. The panorama has +Z in its middle: it is turned to have -Z there, as
other panoramas here.
"""

import base64
import binascii
import io
import struct
from pathlib import Path
from typing import Any, NamedTuple
from urllib.parse import unquote

import msgspec
import numpy as np

from photo_sky.read_png16 import is_png16, png16_size, read_png16
from vrut_lite.errors import UserError
from vrut_lite.geometry.colour import LUMENS_PER_WATT, luminance, srgb_decode
from vrut_lite.numeric_types import FloatArray

SUFFIXES = (".glb", ".gltf")
_NAME, _LIGHTS = "OMI_environment_sky", "KHR_lights_punctual"
_DATA_URI = "data:"
# Luminance of the texel value 1 where the file does not state it: as in files of radiance.
_USUAL_CD_M2 = LUMENS_PER_WATT
_DEEPEST = 1000


class GltfSun(NamedTuple):
    """A directional light: the unit vector (3,) towards it, world axes, and its lux (3,)."""

    direction: FloatArray
    illuminance_lx: FloatArray


class GltfSky(NamedTuple):
    """A sky as stored.

    Attributes:
        pixels: linear (h, w, 3) in [0, 1], the zenith on the top row, -Z in the middle.
        cd_m2_per_unit: luminance of the value 1.
        sun: None without a directional light.
    """

    pixels: FloatArray
    cd_m2_per_unit: float
    sun: GltfSun | None


def read_gltf_sky(path: Path, most_pixels: int) -> GltfSky:
    """The sky of a .glb or .gltf file.

    Raises:
        UserError: it has no equirectangular sky, or a larger one.
        OSError, ValueError, KeyError, IndexError, TypeError, AttributeError: it is damaged.
    """
    document, binary = _parts(path)
    scenes = document.get("scenes") or [{}]
    scene = scenes[document.get("scene", 0)]
    skies = document.get("extensions", {}).get(_NAME, {}).get("skies", [])
    number = scene.get("extensions", {}).get(_NAME, {}).get("sky", 0)
    sky = skies[number] if skies else {}
    texture = sky.get("panorama", {}).get("equirectangular", -1)
    if texture < 0:
        raise UserError(
            f"{path} has no equirectangular sky of {_NAME}: name a file that `vrut-lite export` "
            "wrote, or an EXR or HDR panorama"
        )
    image = document["images"][document["textures"][texture]["source"]]
    pixels = _decoded(path, _image_bytes(path, document, binary, image), most_pixels)
    scale = float(sky.get("extras", {}).get("cd_m2_per_unit", _USUAL_CD_M2))
    if not (np.isfinite(scale) and scale > 0.0):
        raise ValueError("an impossible scale")
    turned = np.roll(pixels, pixels.shape[1] // 2, axis=1)
    return GltfSky(turned, scale, _sun(document, scene))


def _parts(path: Path) -> tuple[dict[str, Any], bytes]:
    """The document, and a GLB's binary chunk."""
    data = path.read_bytes()
    if path.suffix.lower() == ".gltf":
        return msgspec.json.decode(data, type=dict[str, Any]), b""
    if data[:4] != b"glTF":
        raise ValueError("no GLB")
    length, _ = struct.unpack_from("<I4s", data, 12)
    document = msgspec.json.decode(data[20 : 20 + length], type=dict[str, Any])
    return document, data[28 + length :]


def _image_bytes(
    path: Path, document: dict[str, Any], binary: bytes, image: dict[str, Any]
) -> bytes:
    if "uri" in image:
        return _of_uri(path, image["uri"])
    view = document["bufferViews"][image["bufferView"]]
    buffer = document["buffers"][view["buffer"]]
    data = _of_uri(path, buffer["uri"]) if "uri" in buffer else binary
    start = view.get("byteOffset", 0)
    return data[start : start + view["byteLength"]]


def _of_uri(path: Path, uri: str) -> bytes:
    """Bytes of a data URI, or of a file in the document's own folder or below it."""
    if uri.startswith(_DATA_URI):
        try:
            return base64.b64decode(uri.partition(",")[2], validate=True)
        except binascii.Error:
            raise ValueError("a damaged data URI") from None
    folder = path.parent.resolve()
    named = (folder / unquote(uri)).resolve()
    if not named.is_relative_to(folder):
        raise UserError(f"{path} names the file {uri} outside its folder: put it beside it")
    return named.read_bytes()


def _decoded(path: Path, data: bytes, most_pixels: int) -> FloatArray:
    # Imported when used: whoever lists modules needs none of it.
    from PIL import Image

    deep = is_png16(data)
    if deep:
        width, height = png16_size(data)
    else:
        picture = Image.open(io.BytesIO(data), formats=("PNG", "JPEG", "WEBP"))
        width, height = picture.size
    if width * height > most_pixels:
        raise UserError(
            f"the sky of {path} is too large: it has over {most_pixels // 10**6} megapixels"
        )
    if deep:
        return srgb_decode(read_png16(data) / 65535.0)
    return srgb_decode(np.asarray(picture.convert("RGB")) / 255.0)


def _sun(document: dict[str, Any], scene: dict[str, Any]) -> GltfSun | None:
    """The brightest directional light of the scene."""
    lights = document.get("extensions", {}).get(_LIGHTS, {}).get("lights", [])
    nodes = document.get("nodes", [])
    found: list[GltfSun] = []
    waiting = [(number, np.eye(3), 0) for number in scene.get("nodes", [])]
    while waiting:
        number, world_from_parent, depth = waiting.pop()
        if depth > _DEEPEST:
            raise ValueError("nodes in a circle")
        node = nodes[number]
        world_from_node = world_from_parent @ _axes(node)
        carried = node.get("extensions", {}).get(_LIGHTS)
        if carried is not None and lights[carried["light"]]["type"] == "directional":
            found.append(_as_sun(lights[carried["light"]], world_from_node))
        waiting += [(child, world_from_node, depth + 1) for child in node.get("children", [])]
    return max(found, key=lambda sun: float(luminance(sun.illuminance_lx)), default=None)


def _as_sun(light: dict[str, Any], world_from_node: FloatArray) -> GltfSun:
    back = world_from_node[:, 2]
    lux = float(light.get("intensity", 1.0)) * np.asarray(light.get("color", [1.0] * 3), float)
    length = float(np.linalg.norm(back))
    if not (length > 0.0 and lux.shape == (3,) and np.isfinite(lux).all() and (lux >= 0.0).all()):
        raise ValueError("an impossible light")
    # It shines along its node's -Z, so that the sun stands along +Z.
    return GltfSun(back / length, lux)


def _axes(node: dict[str, Any]) -> FloatArray:
    """The rotation and scale (3, 3) of a node in its parent's axes."""
    if "matrix" in node:
        return np.reshape(np.asarray(node["matrix"], float), (4, 4)).T[:3, :3]
    x, y, z, w = np.asarray(node.get("rotation", (0.0, 0.0, 0.0, 1.0)), float)
    turn = np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )
    return turn * np.asarray(node.get("scale", (1.0, 1.0, 1.0)), float)
