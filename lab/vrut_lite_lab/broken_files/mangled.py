"""Good scene files, damaged as files get damaged; each number gives the same damage every time."""

import json
import struct
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from vrut_lite_lab.broken_files.bombs import Files
from vrut_lite_lab.checkout import ROOT

SCENES, MODELS = ROOT / "scenes", ROOT / "tests" / "data" / "models"
# A scene and the files it needs beside it.
GOOD = {
    "sundial.glb": (SCENES, ()),
    "spheres.glb": (SCENES, ()),
    "pmndrs.glb": (MODELS, ()),
    "pmndrs_draco.glb": (MODELS, ()),
    "pavilion.gltf": (SCENES, ("pavilion.bin", "pavilion_floor.png")),
    "street.obj": (SCENES, ("street.mtl", "street_brick.png", "street_paving.png")),
}
_STRANGE: tuple[Any, ...] = (
    *(-1, 0, 1, 7, 255, 65536, 2**31, 2**63, 2**200, -0.5, 1e300, True, None),
    *("", "x", "../x", "POSITION", "file:///etc/passwd", "data:,", "NaN", "\0", "é" * 300),
    *([], {}, [0], [[]], {"a": 1}, [1e308] * 16, [None]),
)


def broken(number: int) -> tuple[str, Files]:
    """The scene's name and all files, one of them broken."""
    random = np.random.default_rng(number)
    name = list(GOOD)[number % len(GOOD)]
    folder, beside = GOOD[name]
    files = {file: (folder / file).read_bytes() for file in (name, *beside)}
    victim = name if random.random() < 0.75 else str(random.choice(list(files)))
    ways = _ways(victim)
    way = ways[int(random.integers(len(ways)))]
    files[victim] = way(files[victim], random)
    return name, files


def _ways(name: str) -> list[Callable[[bytes, np.random.Generator], bytes]]:
    if name.endswith(".glb"):
        return [_glb_document, _glb_document, _glb_document, _cut, _noise, _head_noise, _moved]
    if name.endswith(".gltf"):
        return [_document, _document, _document, _cut, _noise]
    if name.endswith((".obj", ".mtl")):
        return [_lines, _lines, _words, _words, _cut, _noise]
    return [_cut, _noise, _head_noise, _moved]


def _cut(data: bytes, random: np.random.Generator) -> bytes:
    return data[: int(random.integers(len(data)))]


def _noise(data: bytes, random: np.random.Generator) -> bytes:
    """Some bytes are others now."""
    values = np.frombuffer(data, np.uint8).copy()
    at = random.integers(len(values), size=int(2 ** random.integers(1, 9)))
    values[at] = random.integers(256, size=at.size)
    return values.tobytes()


def _head_noise(data: bytes, random: np.random.Generator) -> bytes:
    return _noise(data[:64], random) + data[64:]


def _moved(data: bytes, random: np.random.Generator) -> bytes:
    """A part is missing, doubled, or made of zeros, as after a bad copy."""
    first, last = sorted(int(at) for at in random.integers(len(data), size=2))
    middle = [b"", data[first:last] * 2, bytes(last - first)][int(random.integers(3))]
    return data[:first] + middle + data[last:]


def _lines(data: bytes, random: np.random.Generator) -> bytes:
    lines = data.split(b"\n")
    for _ in range(int(random.integers(1, 4))):
        lines.insert(int(random.integers(len(lines))), lines[int(random.integers(len(lines)))])
        del lines[int(random.integers(len(lines)))]
    return b"\n".join(lines)


def _words(data: bytes, random: np.random.Generator) -> bytes:
    """Some words of a text are strange."""
    strange = [b"nan", b"inf", b"-1", b"0", b"99999999", b"1e999", b"a/b/c", b"//", b"\xff", b"f"]
    words = data.split(b" ")
    for _ in range(int(random.integers(1, 5))):
        words[int(random.integers(len(words)))] = strange[int(random.integers(len(strange)))]
    return b" ".join(words)


def _document(data: bytes, random: np.random.Generator) -> bytes:
    """A value of the document is strange, or gone."""
    document = json.loads(data)
    for _ in range(int(random.integers(1, 3))):
        places = list(_places(document))
        holder, key = places[int(random.integers(len(places)))]
        if random.random() < 0.25:
            del holder[key]
        else:
            holder[key] = _STRANGE[int(random.integers(len(_STRANGE)))]
    return json.dumps(document).encode()


def _places(value: Any) -> Iterator[tuple[Any, Any]]:
    """Every place in a document, as what holds it and its key; long lists by their start."""
    keys = list(value) if isinstance(value, dict) else range(min(len(value), 20))
    for key in keys:
        yield value, key
        if isinstance(value[key], dict | list):
            yield from _places(value[key])


def _glb_document(data: bytes, random: np.random.Generator) -> bytes:
    """A GLB whose frame is right and whose document is not."""
    size = struct.unpack_from("<I", data, 12)[0]
    text = _document(data[20 : 20 + size], random)
    text += b" " * (-len(text) % 4)
    rest = data[20 + size :]
    head = struct.pack("<4sII", b"glTF", 2, 20 + len(text) + len(rest))
    return head + struct.pack("<I4s", len(text), b"JSON") + text + rest
