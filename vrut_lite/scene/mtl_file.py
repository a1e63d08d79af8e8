"""MTL: the materials of an OBJ file and their pictures."""

import posixpath
import re
from collections.abc import Hashable, Iterator
from dataclasses import replace
from io import BytesIO
from itertools import takewhile

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from vrut_lite.scene.budget import SceneBudget
from vrut_lite.scene.file_checks import SceneFolder
from vrut_lite.scene.images import PixelBudget, decode_image
from vrut_lite.scene.import_warnings import Notices
from vrut_lite.scene.materials import SurfaceMaterial, default_material, from_mtl, tell_mtl
from vrut_lite.scene.scene_file_error import SceneFileError, UnreadFile
from vrut_lite.text_files import decoded, plain_text

# How many words follow each option of a map statement (Wavefront MTL, "texture map options").
_OPTION_WORDS = {
    **dict.fromkeys(("-blendu", "-blendv", "-cc", "-clamp", "-bm", "-boost", "-texres"), 1),
    **dict.fromkeys(("-imfchan", "-type"), 1),
    "-mm": 2,
    **dict.fromkeys(("-o", "-s", "-t"), 3),
}
_MAP_WORDS = ("bump", "disp", "decal", "refl", "norm")
_DRIVE = re.compile(r"[A-Za-z]:/")
# Number of trailing folders of a full path that are sought beside the scene.
_MOST_FOLDERS = 8
_NUMBER = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?", re.ASCII)
# Memory of a statement and of each of its words, as Python objects.
_STATEMENT_BYTES, _WORD_BYTES = 512, 64
_MOST_LINE_BYTES = 2**22
Statements = dict[str, list[str]]


class MtlMaterials:
    """The materials of MTL files by name, of two the later one; each picture is decoded once.

    Raises:
        SceneFileError: if a picture is damaged or too large.
    """

    def __init__(self, libraries: list[bytes], folder: SceneFolder, notices: Notices) -> None:
        self._folder = folder
        self._notices = notices
        self._pixels = PixelBudget(folder.budget)
        self._pictures: dict[Hashable, Image.Image] = {}
        self._statements: dict[str, Statements] = {}
        for data in libraries:
            self._statements |= _read(data, folder.budget)
        self._images = {
            name: self._picture(_file_name(statements["map_kd"], folder))
            for name, statements in self._statements.items()
            if "map_kd" in statements
        }

    def make(self, name: str | None, coloured: bool = False) -> SurfaceMaterial:
        """The material of this name, or the default one of faces with or without colours."""
        if name is not None and name not in self._statements:
            instead = "its vertices' colours instead" if coloured else "grey instead"
            self._notices.tell("material that no MTL defines", instead)
        elif name is not None:
            self._tell_unread(self._statements[name])
            tell_mtl(self._statements[name], self._notices)
        return self._made(name, coloured)

    def colour_rgba(self, name: str | None, coloured: bool = False) -> NDArray[np.float64]:
        """The colour (4,) of the material of this name; adds no warning."""
        return self._made(name, coloured).baseColorFactor

    def _made(self, name: str | None, coloured: bool) -> SurfaceMaterial:
        if name not in self._statements:
            # OBJ has no back faces.
            return replace(default_material(coloured), doubleSided=True)
        return from_mtl(name, self._statements[name], self._images.get(name), coloured)

    def _tell_unread(self, statements: Statements) -> None:
        """Tell maps, and options of the one that is read."""
        for kind, words in statements.items():
            if _is_map(kind) and kind != "map_kd":
                self._notices.tell(f"{kind} of the MTL", "left out")
            for word in words[:-1] if kind == "map_kd" else ():
                if word.lower() in _OPTION_WORDS:
                    self._notices.tell(f"map_kd's option {word.lower()}", "left out")

    def _picture(self, name: str) -> Image.Image | None:
        """The decoded picture; None, with a warning, if it is missing or outside the folder."""
        try:
            data = self._folder.get(name)
        except UnreadFile as fault:
            self._notices.tell(f"picture {name}", f"{fault.why}, left out")
            return None
        key = id(data)  # The folder gives the same file as the same object.
        if key not in self._pictures:
            self._pixels.admit(data, ascii(name))
            self._pictures[key] = decode_image(data, ascii(name))
        return self._pictures[key]


def _read(data: bytes, budget: SceneBudget) -> dict[str, Statements]:
    """The statements of each material."""
    materials: dict[str, Statements] = {}
    statements: Statements = {}
    for line in _lines(data):
        words = line.split()
        if len(words) < 2 or words[0].startswith("#"):
            continue
        budget.take(_STATEMENT_BYTES + _WORD_BYTES * len(words), "its materials")
        kind = words[0].lower()
        if kind == "newmtl":
            statements = materials[" ".join(words[1:])] = {}
            continue
        if not _is_map(kind):
            words = list(takewhile(lambda word: not word.startswith("#"), words))
        statements[kind] = words[1:]
    return materials


def portable_name(name: str, folder: SceneFolder) -> str:
    """A file name of an OBJ or MTL as other systems write it: with slashes, inside the folder.

    Programs on Windows write `maps\\brick.png`, and often a full path of the machine that they ran
    on, or one that climbs out of the folder: of those, the longest end that is a file beside the
    scene. A name of which no end is one stays as it is.
    """
    slashed = name.replace("\\", "/")
    if slashed[:1] != "/" and not _DRIVE.match(slashed):
        slashed = posixpath.normpath(slashed)
    parts = _DRIVE.sub("", slashed).split("/")
    if slashed[:1] != "/" and ".." not in parts and not _DRIVE.match(slashed):
        return slashed
    parts = [part for part in parts if part not in ("", ".", "..")]
    ends = ["/".join(parts[first:]) for first in range(len(parts))][-_MOST_FOLDERS:]
    return next((end for end in ends if folder.has(end)), slashed)


def _is_map(kind: str) -> bool:
    return kind.startswith("map_") or kind in _MAP_WORDS


def _lines(data: bytes) -> Iterator[str]:
    """Lines of text, one at a time: a list of all could be many times as large as the file."""
    for line in BytesIO(plain_text(data)):
        if len(line) > _MOST_LINE_BYTES:
            raise SceneFileError(
                f"a line in its MTL is longer than {_MOST_LINE_BYTES >> 20} MB; export it again"
            )
        yield decoded(line)


def _file_name(words: list[str], folder: SceneFolder) -> str:
    """The file that a map statement names, its options dropped."""
    at = 0
    while at < len(words) - 1 and words[at].lower() in _OPTION_WORDS:
        most = _OPTION_WORDS[words[at].lower()]
        at += 1
        end = min(at + most, len(words) - 1)
        while at < end and (most == 1 or _NUMBER.fullmatch(words[at])):
            at += 1
    return portable_name(" ".join(words[at:]), folder)
