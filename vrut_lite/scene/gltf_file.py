"""glTF and GLB containers: the document, its bytes, and typed arrays out of them."""

import struct
from collections.abc import Hashable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, TypeVar

import msgspec
import numpy as np
from numpy.typing import NDArray

from vrut_lite.scene.budget import SceneBudget
from vrut_lite.scene.file_checks import SceneFolder
from vrut_lite.scene.gltf_extensions import check_extensions
from vrut_lite.scene.gltf_schema import Accessor, Gltf, Image, MeshoptView, Sparse
from vrut_lite.scene.gltf_variants import with_variant
from vrut_lite.scene.import_warnings import Notices
from vrut_lite.scene.meshopt_views import admit_meshopt, unpack_meshopt
from vrut_lite.scene.scene_file_error import SceneFileError
from vrut_lite.scene.spec_gloss import as_metallic_roughness

_GLB_MAGIC, _JSON_CHUNK, _BINARY_CHUNK = b"glTF", b"JSON", b"BIN\0"
_DTYPES = {5120: "<i1", 5121: "<u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
_COMPONENTS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT2": 4, "MAT3": 9, "MAT4": 16}
# Measured memory of the document's objects and of their values.
_OBJECT_BYTES, _VALUE_BYTES = 256, 96
_TO_GLTF_2 = "export it as glTF 2, or `npx gltf-pipeline -i OLD -o NEW`"
Item = TypeVar("Item")


class _Gltf1(msgspec.Struct):
    """A document whose lists are objects by names: glTF 1.0, which need not state its version."""

    meshes: dict[str, msgspec.Raw]


@dataclass(frozen=True)
class GltfFile:
    """A parsed document and its buffers in memory; buffers of the same bytes are one object.

    `notices` takes what a reader leaves out. `variant` is that of the materials, "" by default.
    """

    document: Gltf
    buffers: tuple[bytes | memoryview, ...]
    folder: SceneFolder
    notices: Notices
    variant: str = ""
    _sparse: dict[int, NDArray[Any]] = field(default_factory=dict)
    _unpacked: dict[int, bytes] = field(default_factory=dict)

    def array(self, index: int) -> NDArray[Any]:
        """Elements (count, components) of an accessor as they are stored, sparse ones resolved.

        Unless sparse, it is a view into the buffer: it takes no memory and must not be written to.

        Raises:
            SceneFileError: if it reaches beyond its buffer.
        """
        accessor = self.accessor(index)
        if accessor.sparse is None:
            return self._dense(index)
        if index not in self._sparse:
            values = self._dense(index)
            self.folder.budget.take(values.size * values.itemsize, f"accessor {index}")
            self._sparse[index] = self._replaced(f"accessor {index}", values, accessor.sparse)
        return self._sparse[index]

    def _dense(self, index: int) -> NDArray[Any]:
        accessor = self.accessor(index)
        dtype = np.dtype(_DTYPES[accessor.component_type])
        shape = (accessor.count, _COMPONENTS[accessor.type])
        if accessor.buffer_view is None:
            return np.broadcast_to(np.zeros(1, dtype), shape)
        start = (accessor.buffer_view, accessor.byte_offset)
        return self._slice(f"accessor {index}", start, shape, dtype)

    def accessor_bytes(self, index: int) -> int:
        """The declared size of an accessor in bytes; its buffer is not looked at."""
        accessor = self.accessor(index)
        dtype = np.dtype(_DTYPES[accessor.component_type])
        replaced = 0 if accessor.sparse is None else accessor.sparse.count
        return (accessor.count + replaced) * _COMPONENTS[accessor.type] * dtype.itemsize

    def is_share(self, key: str, index: int) -> bool:
        """Whether whole numbers of an attribute stand for [0, 1] or [-1, 1].

        Colours always do: some writers leave the flag out, and 255 is no reflectance.
        """
        found = self.accessor(index)
        if key == "COLOR_0" and not found.normalized and _DTYPES[found.component_type] != "<f4":
            self.notices.tell_once(
                "COLOR_0 of whole numbers without `normalized`", "as if they had it"
            )
            return True
        return found.normalized

    def accessor(self, index: int) -> Accessor:
        """The accessor of this number."""
        return item_at(self.document.accessors, index, "accessor")

    def image_source(self, image: Image) -> tuple[Hashable, bytes | memoryview]:
        """A key and the encoded bytes of an image in a file, data URI or buffer view.

        Images of the same bytes in the same place have the same key.
        """
        if image.uri is not None:
            data = self.folder.get_uri(image.uri)
            return id(data), data
        if image.buffer_view is None:
            raise SceneFileError("an image in it has no source; export the scene again")
        view = item_at(self.document.buffer_views, image.buffer_view, "buffer view")
        key = (id(item_at(self.buffers, view.buffer, "buffer")), view.byte_offset, view.byte_length)
        return key, self._view(image.buffer_view)

    def view_bytes(self, index: int) -> bytes:
        """The bytes of a buffer view."""
        return bytes(self._view(index))

    def _view(self, index: int) -> memoryview:
        view = item_at(self.document.buffer_views, index, "buffer view")
        data = item_at(self.buffers, view.buffer, "buffer")
        if view.packed is not None and not len(data):
            return self._unpacked_view(index, view.packed)
        if view.byte_offset + view.byte_length > len(data):
            raise SceneFileError(
                f"buffer view {index} reaches beyond buffer {view.buffer}, which has "
                f"{len(data)} bytes; export the scene again"
            )
        return memoryview(data)[view.byte_offset : view.byte_offset + view.byte_length]

    def _unpacked_view(self, index: int, packed: MeshoptView) -> memoryview:
        if index not in self._unpacked:
            data = item_at(self.buffers, packed.buffer, "buffer")
            end = packed.byte_offset + packed.byte_length
            if end > len(data):
                raise SceneFileError(
                    f"packed buffer view {index} reaches beyond its buffer; export it again"
                )
            inside = memoryview(data)[packed.byte_offset : end]
            self._unpacked[index] = unpack_meshopt(inside, packed)
        return memoryview(self._unpacked[index])

    def _slice(
        self, what: str, start: tuple[int, int], shape: tuple[int, int], dtype: np.dtype[Any]
    ) -> NDArray[Any]:
        """Elements (count, components) that start at a (buffer view, byte offset)."""
        view, offset = self._view(start[0]), start[1]
        packed = shape[1] * dtype.itemsize
        stride = self.document.buffer_views[start[0]].byte_stride or packed
        if stride < packed or offset + (shape[0] - 1) * stride + packed > len(view):
            raise SceneFileError(
                f"{what} counts {shape[0]} elements, more than its buffer view holds; "
                "export the scene again"
            )
        strides = (stride, dtype.itemsize)
        return np.ndarray(shape, dtype, view, offset, strides)

    def _replaced(self, what: str, values: NDArray[Any], sparse: Sparse) -> NDArray[Any]:
        where = sparse.indices
        at = self._slice(
            what,
            (where.buffer_view, where.byte_offset),
            (sparse.count, 1),
            np.dtype(_DTYPES[where.component_type]),
        )[:, 0]
        if at.max() >= len(values):
            raise SceneFileError(f"{what} replaces elements it has not; export the scene again")
        start = (sparse.values.buffer_view, sparse.values.byte_offset)
        replaced = values.copy()
        replaced[at] = self._slice(what, start, (sparse.count, values.shape[1]), values.dtype)
        return replaced


def read_gltf_file(
    path: Path, budget: SceneBudget, notices: Notices, variant: str = ""
) -> GltfFile:
    """Parse a .gltf or .glb file and fetch its buffers; tell the extensions that are not read.

    Raises:
        SceneFileError: if it is damaged, requires an unsupported extension, names files that are
            missing or outside its folder, other than pictures, or does not fit the budget.
    """
    folder = SceneFolder(path.parent, budget)
    data = folder.read(path)
    chunk, binary = _glb_chunks(data) if path.suffix.lower() == ".glb" else (data, None)
    text = bytes(chunk)
    document = _parse(text, budget)
    _check_version(document)
    check_extensions(text, document.extensions_used, document.extensions_required, notices)
    materials = [as_metallic_roughness(material) for material in document.materials]
    document = with_variant(msgspec.structs.replace(document, materials=materials), variant)
    buffers = _fetch_buffers(document, folder, binary)
    for view in document.buffer_views:
        if view.packed is not None and not len(item_at(buffers, view.buffer, "buffer")):
            admit_meshopt(view.packed, budget)
    return GltfFile(document, buffers, folder, notices, variant)


def item_at(items: Sequence[Item], index: int, what: str) -> Item:
    """`items[index]`.

    Raises:
        SceneFileError: the item is missing; the sentence names it.
    """
    if not 0 <= index < len(items):
        raise SceneFileError(f"it refers to {what} {index}, which is missing; export it again")
    return items[index]


def _parse(text: bytes, budget: SceneBudget) -> Gltf:
    objects, values = text.count(b"{"), text.count(b",")
    size = len(text) + objects * _OBJECT_BYTES + values * _VALUE_BYTES
    budget.take(size, "its glTF document")
    try:
        return msgspec.json.decode(text.removeprefix(b"\xef\xbb\xbf"), type=Gltf)
    except msgspec.ValidationError as fault:
        _refuse_gltf_1(text)
        raise SceneFileError(
            f"its glTF document is not valid ({fault}); export it again"
        ) from fault
    except (msgspec.DecodeError, UnicodeDecodeError, RecursionError) as fault:
        raise SceneFileError(f"its glTF document is not JSON ({fault}); export it again") from fault


def _refuse_gltf_1(text: bytes) -> None:
    try:
        msgspec.json.decode(text, type=_Gltf1)
    except (msgspec.MsgspecError, UnicodeDecodeError, RecursionError):
        return
    raise SceneFileError(f"it is glTF 1.0, which is not read; {_TO_GLTF_2}")


def _check_version(document: Gltf) -> None:
    if document.asset.version.split(".")[0] != "2":
        raise SceneFileError(
            f"it is glTF {ascii(document.asset.version)[:20]}, not glTF 2; {_TO_GLTF_2}"
        )


def _glb_chunks(data: bytes) -> tuple[bytes | memoryview, memoryview | None]:
    """The JSON chunk and the binary chunk of a GLB file (glTF 2.0, section 4.4)."""
    if data[:4] != _GLB_MAGIC or len(data) < 20:
        raise SceneFileError(
            "it is not a GLB file, for it does not begin with 'glTF'; export again"
        )
    version, length = struct.unpack_from("<II", data, 4)
    if version != 2:
        raise SceneFileError(
            f"it is GLB version {version}, as glTF {version}.0 has it; {_TO_GLTF_2}"
        )
    if length > len(data):
        raise SceneFileError(
            f"it is cut short: its header promises {length} bytes, there are {len(data)}; "
            "fetch or export it again"
        )
    chunks = _split_chunks(memoryview(data)[:length])
    if not chunks or chunks[0][0] != _JSON_CHUNK:
        raise SceneFileError("its first chunk is not the glTF document; export it again")
    binary = chunks[1][1] if len(chunks) > 1 and chunks[1][0] == _BINARY_CHUNK else None
    return chunks[0][1], binary


def _split_chunks(data: memoryview) -> list[tuple[bytes, memoryview]]:
    """The first two chunks; nothing in the others is read."""
    chunks: list[tuple[bytes, memoryview]] = []
    at = 12
    while at + 8 <= len(data) and len(chunks) < 2:
        size, kind = struct.unpack_from("<I4s", data, at)
        at += 8
        if size > len(data) - at:
            raise SceneFileError("it is cut short inside a chunk; fetch or export it again")
        chunks.append((kind, data[at : at + size]))
        at += size
    return chunks


def _fetch_buffers(
    document: Gltf, folder: SceneFolder, binary: memoryview | None
) -> tuple[bytes | memoryview, ...]:
    buffers: list[bytes | memoryview] = []
    for index, buffer in enumerate(document.buffers):
        if buffer.uri is not None:
            data: bytes | memoryview = folder.get_uri(buffer.uri)
        elif index == 0 and binary is not None:
            data = binary
        elif buffer.may_be_empty:
            buffers.append(b"")
            continue
        else:
            raise SceneFileError(f"buffer {index} has no data; export the scene again")
        if len(data) < buffer.byte_length:
            raise SceneFileError(
                f"buffer {index} is cut short: {buffer.byte_length} bytes are promised, "
                f"{len(data)} are there; fetch or export it again"
            )
        buffers.append(data)
    return tuple(buffers)


def normalised(values: NDArray[Any]) -> NDArray[Any]:
    """Integers as numbers in [0, 1] or [-1, 1] (glTF 2.0, section 3.6.2.2)."""
    if values.dtype.kind == "f":
        return values
    return np.maximum(values / float(np.iinfo(values.dtype).max), -1.0)
