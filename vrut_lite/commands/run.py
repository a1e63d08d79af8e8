"""`vrut-lite run`: the desktop application."""

import importlib
import os
import sys
from contextlib import suppress
from typing import Any

import click
import msgspec

from vrut_lite.app.desktop import require_desktop
from vrut_lite.app.window.kept import Kept, NamedProject
from vrut_lite.bundled.examples import example_named
from vrut_lite.commands.options import daylight_options, with_options
from vrut_lite.commands.scene_options import scene_options, with_scene_options
from vrut_lite.errors import UserError
from vrut_lite.interrupts import interrupts_held
from vrut_lite.lazy import lazy
from vrut_lite.project import PROJECT_SUFFIX, Project, load_project, project_of_path

begin_probe = lazy("vrut_lite.render.gl_environment:begin_probe")
run_app = lazy("vrut_lite.app.main:run_app")

# Shown if no scene is given and no session was kept: a summer evening in a street.
_FIRST_SCENE, _FIRST_HOUR = "street", "2026-06-21T18:40"


@click.command(name="run")
@daylight_options
@scene_options
@click.argument("scene", required=False)
@click.option(
    "--safe-mode",
    is_flag=True,
    help="Only the host and the default sun and sky; the last session is left alone.",
)
def run(scene: str | None, safe_mode: bool, **options: Any) -> None:
    """Open SCENE (glTF, OBJ, USD, IFC, COLLADA, STL, PLY, OFF, 3MF, or a .toml) in a window.

    Without SCENE, the session of the last closed window.

    Example: vrut-lite run scenes/street.toml --at 2026-06-21T18:40
    """
    kept = Kept(None) if safe_mode else Kept.of_user()
    opened, named = _project(scene, kept)
    project = with_options(with_scene_options(opened, options), options)
    if project.scene and not os.path.isfile(project.scene):
        raise UserError(f"cannot open {project.scene}: there is no such file")
    require_desktop(meanwhile=_import_host)
    with interrupts_held():
        start = run_app.load()
    sys.exit(start(project, kept, safe_mode, named))


def _import_host() -> None:
    """Import what draws and computes: before Qt, which reads the source of each later import."""
    # Without OpenGL; who needs it says so in its own words.
    with interrupts_held(), suppress(ImportError):
        begin_probe()
        importlib.import_module("vrut_lite.numba_compiler")
        importlib.import_module("vrut_lite.host")


def _project(scene: str | None, kept: Kept) -> tuple[Project, NamedProject | None]:
    """The project to open, and its file if it has one."""
    if scene is not None:
        is_file = scene.lower().endswith(PROJECT_SUFFIX)
        return project_of_path(scene), NamedProject(scene) if is_file else None
    session = kept.session()
    return (_first_project(), None) if session is None else (session, kept.named)


def _first_project() -> Project:
    try:
        scene = example_named(_FIRST_SCENE).opens
    except UserError:  # The packages were copied without the examples.
        return Project()
    return msgspec.structs.replace(load_project(scene), at=_FIRST_HOUR)
