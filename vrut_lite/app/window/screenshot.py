"""Screenshots of the picture, with its overlays and read-outs."""

from collections.abc import Iterator
from itertools import count
from pathlib import Path

from vrut_lite.app.engine.session_project import project_of
from vrut_lite.app.window.desk import Desk
from vrut_lite.errors import UserError


def save_screenshot(desk: Desk, folder: Path) -> Path:
    """Write the viewport as PNG, named by scene and local hour; no file is overwritten.

    Raises:
        UserError: the folder cannot be written to.
    """
    path = next(path for path in _names(folder, _title(desk)) if not path.exists())
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise UserError(f"cannot make {folder}: {error.strerror or error}") from None
    if not desk.viewport.grab().save(str(path)):
        raise UserError(f"cannot write {path}: is there room, and may you write there?")
    return path


def _title(desk: Desk) -> str:
    project, day = project_of(desk.session), desk.scout.day
    scene = Path(project.scene).stem or "picture"
    if day is None or not project.at:
        return scene
    return f"{scene} {project.instant().astimezone(day.zone):%Y-%m-%d %H.%M.%S}"


def _names(folder: Path, title: str) -> Iterator[Path]:
    yield folder / f"{title}.png"
    yield from (folder / f"{title} ({number}).png" for number in count(2))
