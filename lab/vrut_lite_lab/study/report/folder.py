"""The folder of a study: files are written beside it and moved into place when all are complete."""

import csv
import os
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from vrut_lite.errors import UserError
from vrut_lite.write_atomic import check_writable
from vrut_lite_lab.study.report.page import in_text

PAGE = "index.html"


class Folder:
    """Takes the files of a study, one after another."""

    def __init__(self, path: Path) -> None:
        self.path = path

    def picture(self, name: str, image: NDArray[np.uint8]) -> str:
        """Write a picture as PNG; the file's name."""
        Image.fromarray(image).save(self.path / f"{name}.png", optimize=True)
        return f"{name}.png"

    def content(self, name: str, content: bytes) -> str:
        """Write bytes; the file's name."""
        (self.path / name).write_bytes(content)
        return name

    def csv(self, name: str, header: Sequence[str], rows: Sequence[Sequence[object]]) -> str:
        """Write a table; the file's name."""
        with (self.path / f"{name}.csv").open("w", newline="", encoding="utf-8") as file:
            writer = csv.writer(file)
            writer.writerow(header)
            writer.writerows([_cell(value) for value in row] for row in rows)
        return f"{name}.csv"


@contextmanager
def study_folder(target: Path) -> Iterator[Folder]:
    """A folder to write to whose files go to `target` when the block ends well.

    Files of an older study stay as they are until then, and others always. The page goes last.

    Raises:
        UserError: the folder cannot be made or written.
    """
    try:
        target.mkdir(parents=True, exist_ok=True)
        check_writable(target / PAGE)
        with TemporaryDirectory(prefix=".study-", dir=target) as beside:
            yield Folder(Path(beside))
            files = sorted(Path(beside).iterdir(), key=lambda file: file.name == PAGE)
            for file in files:
                os.replace(file, target / file.name)
    except OSError as error:
        raise UserError(f"cannot write {target}: {error.strerror or error}") from error


def _cell(value: object) -> object:
    return in_text(value) if isinstance(value, tuple) else value
