"""`vrut-lite sky`: the sky alone, as a cube, latitude-longitude or fisheye picture."""

from typing import Any

import click
import numpy as np
from numpy.typing import NDArray
from rich.progress import track

from vrut_lite.commands.open_kernel import open_kernel, require_sky
from vrut_lite.commands.options import daylight_options, with_options
from vrut_lite.commands.picture_metadata import picture_metadata
from vrut_lite.daylight_kernel import FaultCollector, demand_light
from vrut_lite.geometry.encoding import decode_float16
from vrut_lite.geometry.panorama import (
    fisheye_directions,
    lat_long_directions,
    sample_sky,
    unfold_cube,
)
from vrut_lite.kernel.array import Array
from vrut_lite.project import Project, daylight_inputs, setting_inputs
from vrut_lite.render.display import display_picture
from vrut_lite.render.image_files import (
    Metadata,
    check_writable,
    picture_format,
    write_exr,
    write_hdr,
    write_npz,
    write_png,
)

_ROWS_AT_A_TIME, _ROWS_WORTH_A_BAR = 64, 1000
PROJECTIONS = ("lat-long", "cube", "fisheye")


@click.command(name="sky")
@click.option("-o", "--output", required=True, metavar="FILE", help=".exr, .hdr, .png or .npz.")
@click.option("--projection", type=click.Choice(PROJECTIONS), default="lat-long", show_default=True)
@click.option(
    "--size",
    type=click.IntRange(16, 4096),
    default=512,
    show_default=True,
    help="Edge of a cube face, or height of the other pictures, in pixels.",
)
@daylight_options
def sky(output: str, projection: str, size: int, **options: Any) -> None:
    """Write the sky of a place and an hour, without the sun's disc.

    EXR, HDR and npz hold linear sRGB radiance in W m^-2 sr^-1; the sun's direction and
    irradiance stand in the metadata. A cube unfolds into a cross, in npz it stays (6, n, n, 3).

    Example: vrut-lite sky -o sky.exr --at 2026-06-21T18:30 --place 50.0755,14.4378
    """
    suffix = picture_format(output)
    check_writable(output)
    project = with_options(Project(), options)
    cube, metadata = compute_cube(project, size if projection == "cube" else _fine(size))
    if suffix == ".npz" and projection == "cube":
        write_npz(output, {"cube": cube}, metadata)
    else:
        _write(output, suffix, _project(cube, projection, size, project), metadata)
    click.echo(f"{output}: {metadata['time']}, sun {metadata['sunElevationDeg']:.1f} deg high")


def _write(output: str, suffix: str, radiance: NDArray[np.float32], metadata: Metadata) -> None:
    if suffix == ".npz":
        write_npz(output, {"radiance": radiance}, metadata)
    elif suffix == ".exr":
        write_exr(output, radiance, metadata)
    elif suffix == ".hdr":
        write_hdr(output, radiance, metadata)
    else:
        write_png(output, display_picture(radiance), metadata)


def compute_cube(project: Project, size: int) -> tuple[NDArray[np.float32], Metadata]:
    """The cube map (6, size, size, 3) of whichever module holds the sky, and its metadata."""
    kernel = open_kernel()
    faults = FaultCollector(kernel)
    for message in [*setting_inputs(project, kernel), *daylight_inputs(project)]:
        kernel.inject(message)
    demand_light(kernel, "sky command", size)
    kernel.pump_until_idle()
    faults.raise_first()
    background = require_sky(kernel)
    kernel.close()
    # Nobody runs GPU jobs in a kernel without GL: the cube is an array.
    assert isinstance(background.cube, Array)
    cube = decode_float16(background.cube.values, background.radiance_scale)
    return cube, picture_metadata(project, kernel)


def _fine(size: int) -> int:
    """A cube whose texels are no wider than a pixel of a panorama of this height."""
    return int(2 ** np.ceil(np.log2(max(64, size))))


def _project(
    cube: NDArray[np.float32], projection: str, size: int, project: Project
) -> NDArray[np.float32]:
    north_offset_rad = np.radians(project.north_offset_deg)
    if projection == "cube":
        return unfold_cube(cube).astype(np.float32)
    if projection == "lat-long":
        return _sampled(cube, lat_long_directions(size, north_offset_rad))
    directions, inside = fisheye_directions(size, north_offset_rad)
    return _sampled(cube, directions) * inside[..., None]


def _sampled(cube: NDArray[np.float32], directions: NDArray[np.float64]) -> NDArray[np.float32]:
    """The cube map at directions (h, w, 3), some rows at a time: a large picture needs room."""
    picture = np.empty(directions.shape, np.float32)
    starts = range(0, len(directions), _ROWS_AT_A_TIME)
    quick = len(directions) < _ROWS_WORTH_A_BAR
    for start in track(starts, "drawing", disable=quick, transient=True):
        rows = slice(start, start + _ROWS_AT_A_TIME)
        picture[rows] = sample_sky(cube, directions[rows])
    return picture
