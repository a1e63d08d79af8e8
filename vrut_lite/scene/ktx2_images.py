"""Pictures of Basis Universal in KTX 2 files (glTF extension KHR_texture_basisu)."""

import struct

import numpy as np
from PIL import Image

from vrut_lite.scene.scene_file_error import SceneFileError

_MAGIC = b"\xabKTX 20\xbb\r\n\x1a\n"
_HEADER = struct.Struct("<9I")
_MISSING = (
    "is a KTX 2 picture, and the Python package opengl_basisu is not installed: `pip install "
    "'vrut-lite[formats]'`, or make a PNG of it with `ktx extract` of KTX-Software"
)


def is_ktx2(data: bytes | memoryview) -> bool:
    """Whether the bytes begin as a KTX 2 file does."""
    return bytes(data[: len(_MAGIC)]) == _MAGIC


def ktx2_size(data: bytes | memoryview, name: str) -> tuple[int, int]:
    """Width and height in pixels by the header (KTX 2.0, section 3).

    Raises:
        SceneFileError: it is cut short, or no flat picture.
    """
    if len(data) < len(_MAGIC) + _HEADER.size:
        raise SceneFileError(f"the image {name} is cut short; export it again")
    _, _, width, height, depth, layers, faces, _, _ = _HEADER.unpack_from(data, len(_MAGIC))
    if not width or not height or depth or layers > 1 or faces != 1:
        raise SceneFileError(f"the image {name} is a KTX 2 file of no flat picture; export it anew")
    return width, height


def decode_ktx2(data: bytes | memoryview, name: str) -> Image.Image:
    """The picture in full size, RGB or RGBA with 8 bits.

    Raises:
        SceneFileError: it is damaged or of another codec, or the package is missing.
    """
    try:
        import opengl_basisu
    except ImportError as fault:
        raise SceneFileError(f"the image {name} {_MISSING}") from fault
    size = ktx2_size(data, name)
    try:
        texture = opengl_basisu.open(bytes(data))
        pixels = np.array(texture.transcode("rgba8").data)
    except (ValueError, IndexError, RuntimeError) as fault:
        raise SceneFileError(f"the image {name} is damaged ({fault}); export it again") from fault
    if pixels.shape != (size[1], size[0], 4):
        raise SceneFileError(f"the image {name} has another size than it says; export it again")
    return Image.fromarray(pixels if texture.has_alpha else np.ascontiguousarray(pixels[..., :3]))
