"""What outlives a window: what was open, which files were opened lately, and its shape."""

import json
from base64 import b64decode, b64encode
from pathlib import Path
from typing import Any, NamedTuple, Self

from platformdirs import user_state_path

from vrut_lite.app.project_file import save_project
from vrut_lite.errors import UserError
from vrut_lite.project import Project, load_project
from vrut_lite.render.write_atomic import atomic_output

_MOST_RECENT = 10
_SESSION, _WINDOW = "session.toml", "window.json"


class WindowShape(NamedTuple):
    """Where the window was and how its docks lay, in Qt's own form."""

    geometry: bytes
    docks: bytes


class Kept:
    """Files in one folder, made when there is something to keep; without a folder nothing is.

    A damaged file counts as one that was never there.
    """

    def __init__(self, folder: Path | None):
        self._folder = folder

    @classmethod
    def of_user(cls) -> Self:
        """In the folder that the system has for such things."""
        return cls(user_state_path("vrut_lite"))

    @property
    def recent(self) -> list[str]:
        """Scenes and projects, the latest first, that are still there."""
        listed = self._read().get("recent")
        paths = listed if isinstance(listed, list) else []
        return [path for path in paths if isinstance(path, str) and Path(path).is_file()]

    def add_recent(self, path: str) -> None:
        """Note that a file was opened."""
        full = str(Path(path).resolve())
        others = [other for other in self.recent if other != full]
        self._write(recent=[full, *others][:_MOST_RECENT])

    def session(self) -> Project | None:
        """What was open when a window was last closed, if it can be opened again."""
        if self._folder is None:
            return None
        try:
            project = load_project(self._folder / _SESSION)
        except UserError:
            return None
        return project if Path(project.scene).is_file() else None

    def keep_session(self, project: Project) -> None:
        """Keep what is open; as all that keeps, raises UserError where nothing can be written."""
        if project.scene and self._folder is not None:
            _make(self._folder)
            save_project(self._folder / _SESSION, project)

    def shape(self) -> WindowShape | None:
        """The window's shape when it was last closed."""
        facts = self._read()
        try:
            return WindowShape(b64decode(facts["geometry"]), b64decode(facts["docks"]))
        except (KeyError, TypeError, ValueError):
            return None

    def keep_shape(self, shape: WindowShape) -> None:
        """Keep the window's shape."""
        texts = {name: b64encode(data).decode() for name, data in shape._asdict().items()}
        self._write(**texts)

    def _read(self) -> dict[str, Any]:
        if self._folder is None:
            return {}
        try:
            facts = json.loads((self._folder / _WINDOW).read_text(encoding="utf-8"))
        except (OSError, ValueError):
            return {}
        return facts if isinstance(facts, dict) else {}

    def _write(self, **changes: Any) -> None:
        if self._folder is None:
            return
        _make(self._folder)
        with atomic_output(self._folder / _WINDOW) as beside:
            beside.write_text(json.dumps({**self._read(), **changes}, indent=1), encoding="utf-8")


def _make(folder: Path) -> None:
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise UserError(f"cannot make the folder {folder}: {error.strerror}") from None
