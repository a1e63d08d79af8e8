"""Projects written as TOML."""

import os
from pathlib import Path
from typing import Any

import msgspec

from vrut_lite.errors import UserError
from vrut_lite.project import Project
from vrut_lite.write_atomic import atomic_output


def save_project(path: str | Path, project: Project) -> None:
    """Write a project file; the scene's path is told from where the file lies.

    Raises:
        UserError: it cannot be written.
    """
    file = Path(path)
    scene = os.path.relpath(Path(project.scene).resolve(), file.resolve().parent)
    text = project_text(msgspec.structs.replace(project, scene=Path(scene).as_posix()))
    try:
        with atomic_output(file) as beside:
            beside.write_text(text, encoding="utf-8")
    except OSError as error:
        raise UserError(f"cannot write {file}: {error.strerror or error}") from None


def project_text(project: Project) -> str:
    """A project as TOML."""
    values = msgspec.to_builtins(project)
    camera, exposure, slots, settings = (
        values.pop(key) for key in ("camera", "exposure", "slots", "settings")
    )
    tables = {"camera": camera, "exposure": exposure, "slots": slots}
    tables |= {f"settings.{module}": table for module, table in settings.items()}
    # TOML has no none; what is left out is none by default.
    lines = [_line(*item) for item in values.items() if item[1] is not None]
    for title, table in tables.items():
        if table:
            lines += ["", f"[{title}]", *(_line(*item) for item in table.items())]
    return "\n".join(lines) + "\n"


def _line(key: str, value: Any) -> str:
    return f"{key} = {_toml(value)}"


def _toml(value: Any) -> str:
    if value is None:
        return '"none"'
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        # JSON's escapes are TOML's.
        return msgspec.json.encode(value).decode()
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(_toml(part) for part in value) + "]"
    return repr(value)
