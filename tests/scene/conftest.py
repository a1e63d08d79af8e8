"""Fixtures that write small scene files."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from scene_files import SQUARE, TRIANGLES, square_document

Edit = Callable[[dict[str, Any]], None]


@pytest.fixture
def write_square(tmp_path: Path) -> Callable[..., Path]:
    """Writes the square as glTF, its document edited first."""

    def write(edit: Edit = lambda document: None, data: bytes | None = None) -> Path:
        folder = tmp_path / "scene"
        folder.mkdir(exist_ok=True)
        buffer = SQUARE.tobytes() + TRIANGLES.tobytes() if data is None else data
        document = square_document(buffer)
        edit(document)
        (folder / "square.bin").write_bytes(buffer)
        path = folder / "square.gltf"
        path.write_text(json.dumps(document))
        return path

    return write


@pytest.fixture
def write_obj(tmp_path: Path) -> Callable[..., Path]:
    """Writes an OBJ file of one textured square, with the given MTL text."""

    def write(mtl: str | None = None, faces: str = "f 1/1 2/2 3/3 4/4", vertices: str = "") -> Path:
        folder = tmp_path / "scene"
        folder.mkdir(exist_ok=True)
        lines = ["mtllib square.mtl"] if mtl is not None else []
        lines += vertices.splitlines() or ["v 0 0 0", "v 1 0 0", "v 1 1 0", "v 0 1 0"]
        lines += ["vt 0 0", "vt 1 0", "vt 1 1", "vt 0 1", "usemtl paint", faces]
        if mtl is not None:
            (folder / "square.mtl").write_text(mtl)
        path = folder / "square.obj"
        path.write_text("\n".join(lines) + "\n")
        return path

    return write
