"""`vrut-lite share`: one HTML file in which a browser shows a scene's daylight at any hour."""

from pathlib import Path
from typing import Any

import click

from share.page_file import check_built, check_name
from vrut_lite.headless import (
    busy_with,
    daylight_options,
    project_of_path,
    scene_options,
    with_options,
    with_scene_options,
)
from vrut_lite.lazy import lazy
from vrut_lite.write_atomic import atomic_output, check_writable

# Numpy and the kernel take a second to import, which --help need not wait for.
_shared_page = lazy("share.shared_page")
_stills = lazy("share.stills")

# Bytes above which a file is said to be large: mail servers refuse more.
_LARGE_BYTES = 15_000_000


@click.command(name="share")
@daylight_options
@scene_options
@click.argument("scene")
@click.option("-o", "--output", required=True, metavar="PAGE.html", help="The file to write.")
@click.option(
    "--texels",
    type=click.IntRange(500, 400_000),
    help="About how many texels the light map has. Default: by the tolerance.",
)
@click.option(
    "--terms",
    type=click.IntRange(4, 64),
    default=40,
    show_default=True,
    help="Basis maps of the light, rounded up to fours: more are larger and closer.",
)
@click.option(
    "--stills/--no-stills",
    default=True,
    help="Put pictures of four hours inside, for browsers without WebGL2 (default).",
)
@click.option(
    "--numbers",
    metavar="FOLDER",
    help="Show the numbers that `vrut-lite daylight` has written there: a daylight factor, a year.",
)
def share(
    scene: str,
    output: str,
    texels: int | None,
    terms: int,
    stills: bool,
    numbers: str | None,
    **options: Any,
) -> None:
    """Write SCENE into one HTML file that anybody opens: its daylight at any hour of the year.

    The file needs no server and no network. It has sliders of hour and day, sun and moon with their
    shadows, lux under the pointer and false colours. Printed is how far its light is off.

    Example: vrut-lite share scenes/work/indoor.glb -o room.html --at 2026-06-21T12:30
    """
    path = Path(output)
    check_name(path)
    check_built()
    project = with_options(with_scene_options(project_of_path(scene), options), options)
    check_writable(path)
    with busy_with(f"sharing {project.scene}"):
        pictures = _stills.stills_of(project) if stills else []
        title = Path(project.scene).stem
        folder = None if numbers is None else Path(numbers)
        page = _shared_page.shared_page(project, title, texels, terms, pictures, folder)
    with atomic_output(path) as target:
        target.write_text(page.text, encoding="utf-8")
    size = path.stat().st_size
    click.echo(f"{output}: {size / 1e6:.1f} MB, {page.texels:,} texels, {page.terms} terms")
    if size > _LARGE_BYTES:
        click.echo("it is large for mail: --texels or --terms make it smaller", err=True)
    if page.left_out:
        click.echo(f"left out of its sky: {', '.join(page.left_out)}", err=True)
    for error in page.errors:
        click.echo(f"  {error.line()}")
