"""`vrut-lite run`: the desktop application."""

import sys
from pathlib import Path
from typing import Any

import click
import msgspec

from vrut_lite.commands.options import daylight_options, with_options
from vrut_lite.errors import UserError
from vrut_lite.interrupts import interrupts_held
from vrut_lite.project import PROJECT_SUFFIX, Project, load_project

# What a checkout shows who names nothing: a summer evening in a street.
_FIRST_SCENE = Path(__file__).parents[2] / "scenes" / "street.toml"
_FIRST_HOUR = "2026-06-21T18:40"


@click.command(name="run")
@click.argument("scene", required=False)
@daylight_options
def run(scene: str | None, **options: Any) -> None:
    """Open SCENE (glTF, GLB, OBJ, or a project file .toml) in a window.

    Example: vrut-lite run scenes/street.toml --at 2026-06-21T18:40
    """
    project = with_options(_project(scene), options)
    if project.scene and not Path(project.scene).is_file():
        raise UserError(f"cannot open {project.scene}: there is no such file")
    from vrut_lite.app.desktop import require_desktop

    require_desktop()
    with interrupts_held():
        from vrut_lite.app.main import run_app
    sys.exit(run_app(project))


def _project(scene: str | None) -> Project:
    if scene is None:
        return _first_project()
    is_project = Path(scene).suffix.lower() == PROJECT_SUFFIX
    return load_project(scene) if is_project else Project(scene=scene)


def _first_project() -> Project:
    if not _FIRST_SCENE.is_file():
        return Project()
    return msgspec.structs.replace(load_project(_FIRST_SCENE), at=_FIRST_HOUR)
