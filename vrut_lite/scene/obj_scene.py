"""OBJ with its MTL and textures, read by trimesh through the checked folder."""

import re
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
import trimesh
from numpy.typing import NDArray
from PIL import Image
from trimesh.exchange.obj import load_obj
from trimesh.visual.material import SimpleMaterial

from vrut_lite.scene.file_checks import SceneFileError, SceneFolder, read_whole_file
from vrut_lite.scene.images import PixelBudget, decode_image
from vrut_lite.scene.materials import default_material, from_simple
from vrut_lite.scene.mesh import make_mesh
from vrut_lite.scene.placed import PlacedMesh

# How many words follow each option of a map statement (Wavefront MTL, "texture map options").
_OPTION_WORDS = {
    **dict.fromkeys(("-blendu", "-blendv", "-cc", "-clamp", "-bm", "-boost", "-texres"), 1),
    **dict.fromkeys(("-imfchan", "-type"), 1),
    "-mm": 2,
    **dict.fromkeys(("-o", "-s", "-t"), 3),
}
_MAP = re.compile(r"^\s*(map_\w+|bump|disp|decal|refl|norm)\s+(.+?)\s*$", re.I | re.M)
_STATEMENT = re.compile(r"^[ \t]*(v|vt|vn|f)[ \t]+", re.M)
_NEGATIVE_FACE = re.compile(r"^f .*-\d", re.M)
_ZERO_INDEX = re.compile(r"^f(?: .*)? 0(?:[/\s]|$)", re.M)


def read_obj_scene(path: Path) -> list[PlacedMesh]:
    """The meshes of an OBJ file, one for each material.

    Raises:
        SceneFileError: if it is damaged or names files that are missing or outside its folder.
    """
    text = _STATEMENT.sub(r"\1 ", _decoded(read_whole_file(path)))
    if _ZERO_INDEX.search(text):
        raise SceneFileError("a face refers to vertex 0, and OBJ counts from 1; export it again")
    if _NEGATIVE_FACE.search(text):
        text = _absolute_faces(text)
    folder = _ObjFolder(path.parent)
    geometry = _load(text, folder)
    if folder.fault is not None:
        raise folder.fault
    placed = []
    for name, parts in geometry.items():
        mesh = _mesh(name, parts)
        if mesh is not None:
            placed.append(PlacedMesh(name, mesh, np.eye(4)))
    return placed


class _ObjFolder(SceneFolder):
    """The scene's folder, minding how trimesh asks for what an MTL file names."""

    def __init__(self, folder: Path) -> None:
        super().__init__(folder)
        self._budget = PixelBudget()
        self._images: dict[str, bytes] = {}
        self._library: bytes | None = None

    def _get(self, name: str) -> bytes:
        if self._library is None:  # trimesh asks for the MTL file before all pictures.
            self._library = data = super()._get(name)
            for _, reference in _MAP.findall(_decoded(data)):
                self.locate(_without_options(reference))
            return data
        name = _without_options(name)
        if name not in self._images:
            data = super()._get(name)
            self._budget.admit(data, ascii(name))
            self._images[name] = _as_png(decode_image(data, ascii(name)))
        return self._images[name]


def _as_png(image: Image.Image) -> bytes:
    """What trimesh may open: it would try every format, and decode late."""
    out = BytesIO()
    image.save(out, "PNG", compress_level=0)
    return out.getvalue()


def _load(text: str, folder: SceneFolder) -> dict[str, dict[str, Any]]:
    """trimesh's arrays for each material."""
    try:
        loaded = load_obj(BytesIO(text.encode()), resolver=folder, group_material=True)
    except (MemoryError, SceneFileError):
        raise
    except Exception as fault:
        # trimesh meets damaged text with whatever its parsing happens to raise.
        raise SceneFileError(
            f"its OBJ text is damaged: {_reason(fault)}; export it again"
        ) from fault
    return dict(loaded.get("geometry", {}))


def _reason(fault: Exception) -> str:
    """In the words of the file: numpy's are about arrays that its author never saw."""
    if isinstance(fault, IndexError):
        return "a face refers to a corner that it does not have"
    if isinstance(fault, ValueError):
        return "where numbers belong stands something else, or too few of them"
    return " ".join(str(fault).split()) or type(fault).__name__


def _mesh(name: str, parts: dict[str, Any]) -> trimesh.Trimesh | None:
    visual = parts.get("visual")
    source = getattr(visual, "material", None)
    material = default_material()
    if isinstance(source, SimpleMaterial) and not _is_made_up(source):
        material = from_simple(source)
    return make_mesh(
        name,
        np.asarray(parts["vertices"]),
        _triangles(np.asarray(parts["faces"], dtype=np.int64)),
        material=material,
        normals=parts.get("vertex_normals"),
        uv=getattr(visual, "uv", None),
        colours=parts.get("vertex_colors"),
    )


def _is_made_up(material: SimpleMaterial) -> bool:
    """Whether trimesh put it where the file has none: with a picture that was never encoded."""
    return material.image is not None and material.image.format is None


def _triangles(faces: NDArray[np.int64]) -> NDArray[np.int64]:
    """Fans of triangles (n, 3) for the polygons (m, k) that trimesh leaves when all are alike."""
    if faces.ndim != 2 or faces.shape[1] < 3:
        return np.zeros((0, 3), dtype=np.int64)
    fans = [faces[:, [0, i, i + 1]] for i in range(1, faces.shape[1] - 1)]
    return np.stack(fans, axis=1).reshape(-1, 3)


def _decoded(data: bytes) -> str:
    return data.decode("utf-8", errors="replace").removeprefix("\ufeff").replace("\r\n", "\n")


def _without_options(reference: str) -> str:
    """The file name of a map statement, its options dropped."""
    words = reference.split()
    while len(words) > 1 and words[0].lower() in _OPTION_WORDS:
        most = _OPTION_WORDS[words.pop(0).lower()]
        taken = 0
        while taken < most and len(words) > 1 and (most == 1 or _is_number(words[0])):
            words.pop(0)
            taken += 1
    return " ".join(words)


def _is_number(word: str) -> bool:
    return re.fullmatch(r"[-+]?\d*\.?\d+(?:[eE][-+]?\d+)?", word) is not None


def _absolute_faces(text: str) -> str:
    """Faces that count backwards from the present line, made to count from the first.

    trimesh counts them from the end of the file.
    """
    counts = {"v": 0, "vt": 0, "vn": 0}
    lines = []
    for line in text.splitlines():
        kind, _, rest = line.partition(" ")
        if kind in counts:
            counts[kind] += 1
        elif kind == "f" and "-" in rest:
            line = "f " + " ".join(_absolute_corner(corner, counts) for corner in rest.split())
        lines.append(line)
    return "\n".join(lines)


def _absolute_corner(corner: str, counts: dict[str, int]) -> str:
    present = (counts["v"], counts["vt"], counts["vn"])
    numbers = []
    for word, count in zip(corner.split("/"), present, strict=False):
        if word.startswith("-") and word[1:].isdigit():
            absolute = count + 1 - int(word[1:])
            if absolute < 1:
                raise SceneFileError("a face counts back beyond the first vertex; export it again")
            word = str(absolute)
        numbers.append(word)
    return "/".join(numbers)
