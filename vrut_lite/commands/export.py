"""`vrut-lite export`: a scene and its sky of an hour as one glTF file."""

from pathlib import Path
from typing import Any

import click

from vrut_lite.commands.options import daylight_options, with_options
from vrut_lite.commands.scene_options import scene_options, with_scene_options
from vrut_lite.errors import UserError
from vrut_lite.lazy import lazy
from vrut_lite.project import project_of_path
from vrut_lite.studio.number_types import WholeRange
from vrut_lite.studio.pictures import tell_notices
from vrut_lite.studio.progress import busy_with
from vrut_lite.write_atomic import atomic_output, check_writable

# The kernel takes a second to import, which --help need not wait for.
_exported = lazy("vrut_lite.studio.scene_export:exported")

_SUFFIX = ".glb"


@click.command(name="export")
@daylight_options
@scene_options
@click.argument("scene")
@click.option("-o", "--output", required=True, metavar="FILE.glb", help="The file to write.")
@click.option(
    "--size",
    "height_px",
    type=WholeRange(16, 4096),
    default=512,
    show_default=True,
    help="Height of the sky's panorama in pixels; it is twice as wide.",
)
def export(scene: str, output: str, height_px: int, **options: Any) -> None:
    """Write SCENE with the sky of an hour as one GLB for other programs.

    The sky is a panorama of OMI_environment_sky, in 16 bits; its extras state the luminance of
    the texel value 1. The sun is a directional light of KHR_lights_punctual in lux.

    Example: vrut-lite export scenes/street.toml -o street.glb --at 2026-06-21T18:30
    """
    path = Path(output)
    if path.suffix.lower() != _SUFFIX:
        raise UserError(f"cannot write {output}: the name of a scene with its sky ends with .glb")
    project = with_options(with_scene_options(project_of_path(scene), options), options)
    if not project.scene:
        raise UserError(f"{scene} names no scene to export: name a scene file or a project")
    check_writable(path)
    with busy_with(f"exporting {project.scene}"):
        made = _exported(project, height_px)
    tell_notices(made.notices)
    for line in made.left_out:
        click.echo(f"vrut-lite: {line}", err=True)
    with atomic_output(path) as target:
        target.write_bytes(made.data)
    click.echo(f"{output}: {path.stat().st_size / 1e6:.1f} MB, {made.caption}")
