"""Screenshots of the picture, with its overlays and read-outs."""

from collections.abc import Iterator
from itertools import count
from pathlib import Path

from vrut_lite.app.panels.file_title import file_title
from vrut_lite.app.window.panel_context import PanelContext
from vrut_lite.errors import UserError


def save_screenshot(desk: PanelContext, folder: Path) -> Path:
    """Write the viewport as PNG, named by scene, place and local hour; no file is overwritten.

    Raises:
        UserError: the folder cannot be written to.
    """
    path = next(path for path in _names(folder, file_title(desk.session)) if not path.exists())
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise UserError(f"cannot make {folder}: {error.strerror or error}") from None
    if not desk.viewport.grab().save(str(path)):
        raise UserError(f"cannot write {path}: is there room, and may you write there?")
    return path


def _names(folder: Path, title: str) -> Iterator[Path]:
    yield folder / f"{title}.png"
    yield from (folder / f"{title} ({number}).png" for number in count(2))
