"""Files that outlive a window: last session and its name, recent files, layout, switched off
modules."""

import os
from base64 import b64decode, b64encode
from collections.abc import Iterable
from hashlib import blake2b
from pathlib import Path
from typing import Any, NamedTuple, Self

from platformdirs import user_state_path

from vrut_lite.app.json_files import read_object, set_aside, write_object
from vrut_lite.errors import UserError
from vrut_lite.project import Project, daylight_inputs, load_project, save_project, view_inputs
from vrut_lite.write_atomic import make_folder

_MOST_RECENT = 10
# The existence of at most so many files is checked.
_MOST_LISTED = 100
_SESSION, _WINDOW = "session.toml", "window.json"


class WindowShape(NamedTuple):
    """The window's geometry and the state of its docks, as Qt encodes them."""

    geometry: bytes
    docks: bytes


class NamedProject(NamedTuple):
    """A project's file, and whether the present project differs from it."""

    path: str
    is_changed: bool = False


class Kept:
    """Files in one folder, created with the first file; without a folder nothing is kept.

    A damaged file counts as missing; it is renamed before a new one is written.
    """

    def __init__(self, folder: Path | None):
        self._folder = folder

    @classmethod
    def of_user(cls) -> Self:
        """In the user's state folder."""
        return cls(user_state_path("vrut_lite"))

    @property
    def recent(self) -> list[str]:
        """Scenes and projects that exist, the latest first."""
        listed = self._read().get("recent")
        paths = listed if isinstance(listed, list) else []
        texts = [path for path in paths[:_MOST_LISTED] if isinstance(path, str)]
        # Unlike Path.is_file it accepts invalid names.
        return [path for path in dict.fromkeys(texts) if os.path.isfile(path)]

    def add_recent(self, path: str) -> None:
        """Note that a file was opened."""
        full = str(Path(path).resolve())
        others = [other for other in self.recent if other != full]
        self._write(recent=[full, *others][:_MOST_RECENT])

    def session(self) -> Project | None:
        """The project when a window was last closed, if it can be opened again."""
        if self._folder is None:
            return None
        try:
            project = load_project(self._folder / _SESSION)
            # Raises if the place, the hour or the camera is impossible.
            _ = daylight_inputs(project), view_inputs(project)
        except UserError:
            return None
        return project if os.path.isfile(project.scene) else None

    def keep_session(self, project: Project) -> None:
        """Keep the session's project; UserError if it cannot be written."""
        if project.scene and self._folder is not None:
            make_folder(self._folder)
            file = self._folder / _SESSION
            try:
                load_project(file)
            except UserError:
                set_aside(file)
            save_project(file, project)

    @property
    def named(self) -> NamedProject | None:
        """The file of the session's project, if it had one that still exists."""
        facts = self._read()
        path, is_changed = facts.get("project"), facts.get("project_is_changed")
        if not isinstance(path, str) or not os.path.isfile(path):
            return None
        return NamedProject(path, is_changed is not False)

    def keep_named(self, named: NamedProject | None) -> None:
        """Keep the file of the session's project; None if it has none."""
        path, is_changed = named or (None, False)
        self._write(project=path, project_is_changed=is_changed)

    def shape(self) -> WindowShape | None:
        """The window's shape when it was last closed."""
        facts = self._read()
        try:
            shape = WindowShape(b64decode(facts["geometry"]), b64decode(facts["docks"]))
        except (KeyError, TypeError, ValueError):
            return None
        # Qt trusts the sizes in a damaged state, and takes memory by them.
        return shape if facts.get("digest") == _digest(shape) else None

    def keep_shape(self, shape: WindowShape) -> None:
        """Keep the window's shape."""
        texts = {name: b64encode(data).decode() for name, data in shape._asdict().items()}
        self._write(**texts, digest=_digest(shape))

    @property
    def switched_off(self) -> frozenset[str]:
        """Names of the modules that were off when the window was last closed."""
        listed = self._read().get("switched_off")
        names = listed if isinstance(listed, list) else []
        return frozenset(name for name in names if isinstance(name, str))

    def keep_switched_off(self, names: Iterable[str]) -> None:
        """Keep the names of modules to switch off at the next start."""
        self._write(switched_off=sorted(names))

    def _read(self) -> dict[str, Any]:
        return {} if self._folder is None else read_object(self._folder / _WINDOW)

    def _write(self, **changes: Any) -> None:
        if self._folder is not None:
            write_object(self._folder / _WINDOW, {**self._read(), **changes})


def _digest(shape: WindowShape) -> str:
    return blake2b(b"".join(shape), digest_size=16).hexdigest()
