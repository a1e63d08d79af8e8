"""`vrut-lite sky`: the sky alone, as a cube, latitude-longitude or fisheye picture."""

from typing import Any

import click

from vrut_lite.commands.options import daylight_options, with_options
from vrut_lite.errors import UserError
from vrut_lite.pictures.image_files import check_all_writable, picture_format
from vrut_lite.project import Project
from vrut_lite.studio.number_types import FiniteRange, WholeRange
from vrut_lite.studio.pictures import bits_option, make_pictures, picture_bits, said_of
from vrut_lite.studio.sky_pictures import (
    PROJECTIONS,
    STOKES_FORMATS,
    Projection,
    SkyPlan,
    sidecar_of,
)
from vrut_lite.studio.time_span import span_options, wanted_pictures
from vrut_lite.studio.workers import worker_options, workers_of


@click.command(name="sky")
@daylight_options
@click.option(
    "-o",
    "--output",
    required=True,
    metavar="FILE",
    help=".exr, .hdr, .png or .npz; with --from a name for many, as sky_%04d.exr.",
)
@click.option("--projection", type=click.Choice(PROJECTIONS), default="lat-long", show_default=True)
@click.option(
    "--size",
    type=WholeRange(16, 4096),
    default=512,
    show_default=True,
    help="Edge of a cube face, or height of the other pictures, in pixels.",
)
@click.option(
    "--height",
    "height_m",
    type=FiniteRange(0.0, 1e9),
    default=0.0,
    help="Of the observer above the place, in metres: into the air, and to space.",
)
@click.option(
    "--sun-disc/--no-sun-disc",
    default=False,
    show_default=True,
    help="Draw the sun's disc, darkened to its limb and right to the watt.",
)
@click.option(
    "--stars/--no-stars",
    default=False,
    show_default=True,
    help="Draw stars, planets and the moon's disc, right to the watt.",
)
@click.option(
    "--rotate",
    "turned_deg",
    type=FiniteRange(-360.0, 360.0),
    default=0.0,
    show_default=True,
    metavar="DEG",
    help="Azimuth in the middle, clockwise of north: 90 for Blender, 180 for Mitsuba.",
)
@click.option(
    "--stokes",
    is_flag=True,
    help="Write also how the light is polarised, to .exr or .npz: Q and U, and degree (dolp) and "
    "angle (aolp) of its luminance. By each view's vertical plane: Q > 0 vibrates in it, U > 0 at "
    "45 degrees counter-clockwise from it, as the observer sees it.",
)
@click.option("--sidecar", is_flag=True, help="Write the header also beside it, as FILE.json.")
@bits_option
@span_options
@worker_options
def sky(
    output: str,
    projection: Projection,
    size: int,
    height_m: float,
    sun_disc: bool,
    stars: bool,
    turned_deg: float,
    stokes: bool,
    sidecar: bool,
    bits: str | None,
    jobs: int,
    dask: str | None,
    **options: Any,
) -> None:
    """Write the sky of a place and an hour, or of many, as an environment map.

    EXR, HDR and npz hold linear sRGB radiance in W m^-2 sr^-1; the sun's direction and
    irradiance stand in the metadata. A cube unfolds into a cross, in npz it stays (6, n, n, 3).

    North lies in the middle of a latitude-longitude map, east right of it; at the top of a
    fisheye; on a cube's -Z face. --rotate 90 turns a latitude-longitude map so that Blender's +Y
    is north and +X east, as in a glTF scene that it imports; --rotate 180 so that Mitsuba's -Z
    is north and +X east, the scene's own axes. Then place Blender's or Mitsuba's sun lamp by the
    metadata, or draw the disc with --sun-disc.

    With --stokes an EXR has the channels Q.R to U.B, dolp and aolp beside R, G and B; an npz the
    arrays q, u, dolp and aolp. The ground, stars, glows and clouds are unpolarised.

    Example: vrut-lite sky -o sky.exr --at 2026-06-21T18:30 --place 50.0755,14.4378

    Example: vrut-lite sky -o sky_%04d.exr --from 05:00 --to 21:00 --step 30m --jobs 2
    """
    suffix = picture_format(output)
    if stokes and suffix not in STOKES_FORMATS:
        raise UserError(f"{suffix} holds no polarisation: name an .exr or .npz file for --stokes")
    project = with_options(Project(), options)
    wanted = wanted_pictures(output, project, options)
    paths = [path for _, path in wanted]
    check_all_writable([*paths, *(map(sidecar_of, paths) if sidecar else ())])
    plan = SkyPlan(
        project=project,
        projection=projection,
        size=size,
        height_m=height_m,
        turned_deg=turned_deg,
        sun_disc=sun_disc,
        stars=stars,
        stokes=stokes,
        bits=picture_bits(bits, suffix),
        sidecar=sidecar,
        bar=len(wanted) == 1,
    )
    with workers_of(jobs, dask, len(wanted)) as workers:
        captions = make_pictures(plan, wanted, workers)
    click.echo(said_of(wanted, captions))
