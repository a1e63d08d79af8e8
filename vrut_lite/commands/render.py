"""`vrut-lite render`: a picture of a scene under the daylight of a place and an hour."""

import math
from typing import Any, get_args

import click
import msgspec

from vrut_lite.commands.options import Command, daylight_options, said, with_options
from vrut_lite.commands.scene_options import scene_options, with_scene_options
from vrut_lite.errors import UserError
from vrut_lite.messages.picture import LARGEST_PICTURE_PX
from vrut_lite.pictures.image_files import DISPLAY_FORMATS, check_all_writable, picture_format
from vrut_lite.plain_numbers import plain_float, plain_int
from vrut_lite.project import SMALLEST_PICTURE_PX, CameraView, Project, project_of_path
from vrut_lite.render.gl_environment import compile_quickly
from vrut_lite.scene.scene_state import Shown
from vrut_lite.studio.engines import GL, engine_options, with_engine
from vrut_lite.studio.number_types import FiniteRange
from vrut_lite.studio.panorama_pictures import PanoramaPlan, default_size_px
from vrut_lite.studio.pictures import (
    PicturePlan,
    bits_option,
    make_pictures,
    picture_bits,
    said_of,
)
from vrut_lite.studio.scene_pictures import ScenePlan
from vrut_lite.studio.time_span import span_options, wanted_pictures
from vrut_lite.studio.workers import worker_options, workers_of

# Pixels of all pictures of a command up to which optimised GL programs take longer to compile than
# they save: on two cores they cost 1 to 5 s of CPU, and save 0.1 to 0.2 s a megapixel of a still.
_LITTLE_DRAWING_PX = 8_000_000
_POINTS = "--eye and --target go together, each X,Y,Z in metres: --eye 5,2,8 --target 0,1,0"


def _size(text: str) -> tuple[int, int]:
    try:
        width, height = map(plain_int, text.lower().split("x"))
    except ValueError:
        raise UserError(f"--size {text} is not of the form WIDTHxHEIGHT, as 960x540") from None
    low, high = SMALLEST_PICTURE_PX, LARGEST_PICTURE_PX
    if not (low <= width <= high and low <= height <= high):
        raise UserError(f"--size {text}: width and height are {low} to {high:,} pixels")
    return width, height


def _point(text: str) -> tuple[float, ...]:
    try:
        x, y, z = map(plain_float, text.split(","))
    except ValueError:
        raise UserError(_POINTS) from None
    return x, y, z


def _exposure(text: str) -> dict[str, Any]:
    if text == "auto":
        return {"mode": "auto"}
    try:
        return {"mode": "manual", "ev100": plain_float(text)}
    except ValueError:
        raise UserError(f"--exposure {text} is neither 'auto' nor a number") from None


def _white(text: str) -> dict[str, float]:
    kelvin, comma, duv = text.partition(",")
    try:
        white = {"white_temperature_k": plain_float(kelvin)}
        return {**white, "white_duv": plain_float(duv)} if comma else white
    except ValueError:
        raise UserError(f"--white {text} is not of the form KELVIN or KELVIN,DUV") from None


def _view_options(command: Command) -> Command:
    """Add the options on the picture: its size, camera, exposure, and what it shows."""
    for option in reversed((
        click.option("--size", type=_size, metavar="WxH", help="Picture size in pixels, as "
                     "960x540."),
        click.option("--eye", "eye_m", type=_point, metavar="X,Y,Z", help="Camera position in "
                     "metres, world axes."),
        click.option("--target", "target_m", type=_point, metavar="X,Y,Z", help="Where the camera "
                     "looks, with --eye."),
        click.option("--fov", "vertical_field_of_view_deg", type=FiniteRange(1.0, 150.0),
                     metavar="DEG", help="Vertical view angle, with --eye and --target or a "
                     "project's camera."),
        click.option("--exposure", "exposed", type=_exposure, metavar="EV100", help="'auto' "
                     "(default) or a fixed EV100."),
        click.option("--compensation", "compensation_ev", type=FiniteRange(-20.0, 20.0),
                     metavar="EV", help="Brighter by so many stops."),
        click.option("--tone-map", metavar="agx|exponential|none", help="Like film (default), "
                     "1 - exp(-k L) as in papers, or cut off."),
        click.option("--night-look", metavar="eye|exposure", help="By night as the eye sees "
                     "(default): dark, without colour; or a long exposure, brighter, with "
                     "colours."),
        click.option("--white", type=_white, metavar="KELVIN[,DUV]", help="Show daylight of this "
                     "colour temperature white; DUV leads off the daylight locus, towards green. "
                     "Default 6504: colours as they are."),
        click.option("--glare", type=FiniteRange(0.0, 1.0), metavar="SHARE", help="Show light "
                     "that an eye scatters around lamps and the sun: 1 all of it, 0 (default) "
                     "none. EXR has none."),
        click.option("--air/--no-air", default=None, help="See the scene through the air "
                     "(default)."),
        click.option("--light-shafts/--no-light-shafts", default=None, help="Let the scene's "
                     "shadows show in the air. Default: no."),
        click.option("--polariser", "polariser_deg", type=FiniteRange(-180.0, 180.0),
                     metavar="DEG", help="Put a polariser before the camera; 0 passes vibration "
                     "along the picture's vertical, angles count counter-clockwise."),
        click.option("--projection", type=click.Choice(("perspective", "equirectangular")),
                     default="perspective", show_default=True, help="Equirectangular shows all "
                     "around --eye, true north in the middle, for viewers of 360-degree pictures."),
        click.option("--stereo", is_flag=True, help="Draw an equirectangular picture for two "
                     "eyes, the left one's on top."),
        click.option("--show", "shows", type=click.Choice(get_args(Shown)[1:]), help="Instead of "
                     "the picture, in false colours with a legend: lux on surfaces, the edge of "
                     "the light map's texels, or the noise that its rays leave. EXR holds the "
                     "values."),
    )):  # fmt: skip
        command = option(command)
    return command


@click.command(name="render")
@daylight_options
@scene_options
@click.argument("scene")
@click.option(
    "-o",
    "--output",
    required=True,
    metavar="PICTURE",
    help="A .png, .jpg or .exr file; with --from a name for many, as day_%04d.png.",
)
@_view_options
@engine_options
@bits_option
@span_options
@worker_options
def render(
    scene: str,
    output: str,
    bits: str | None,
    jobs: int,
    dask: str | None,
    **options: Any,
) -> None:
    """Render SCENE to a picture, or to many of a day.

    SCENE is glTF, GLB, OBJ, USD, IFC, COLLADA, STL, PLY, OFF, 3MF, or a project
    .toml.

    PNG is exposed and tone-mapped; EXR holds linear sRGB radiance in W m^-2 sr^-1. Automatic
    exposure meters each picture by itself; --exposure EV100 holds it for all of a day.

    Example: vrut-lite render scenes/street.obj -o dusk.png --at 2026-06-21T21:40
    --place 50.0755,14.4378 --turbidity 3 --albedo 0.1

    Example: vrut-lite render scenes/street.toml -o day_%04d.png --at 2026-06-21T00:00
    --from 05:00 --to 21:00 --step 10m

    Example: vrut-lite render scenes/street.toml -o street_360.jpg --projection equirectangular
    """
    eyes = _eyes_around(options)
    suffix = picture_format(output, DISPLAY_FORMATS)
    project = _with_view(with_scene_options(project_of_path(scene), options), options)
    project = with_options(project, options)
    project, engine = with_engine(project, options)
    wanted = wanted_pictures(output, project, options)
    check_all_writable([path for _, path in wanted])
    if len(wanted) * math.prod(project.size) <= _LITTLE_DRAWING_PX:
        compile_quickly()
    channel_bits = picture_bits(bits, suffix)
    plan: PicturePlan = ScenePlan(project, channel_bits, engine)
    if eyes:
        if engine != GL:
            raise UserError(
                f"--projection equirectangular is for OpenGL: leave --engine {engine} out"
            )
        plan = PanoramaPlan(project, stereo=eyes == 2, bits=channel_bits)
    with workers_of(jobs, dask, len(wanted)) as workers:
        captions = make_pictures(plan, wanted, workers)
    click.echo(said_of(wanted, captions))


def _eyes_around(options: dict[str, Any]) -> int:
    """Eyes that see an equirectangular picture, 0 for a perspective one.

    Takes --projection and --stereo out of `options`, and sets the size if none was said.
    """
    around, stereo = options.pop("projection") == "equirectangular", options.pop("stereo")
    if not around:
        if stereo:
            raise UserError("--stereo needs --projection equirectangular")
        return 0
    if options["vertical_field_of_view_deg"] is not None:
        raise UserError(
            "--fov is for perspective pictures: an equirectangular one shows all around"
        )
    options["size"] = options["size"] or default_size_px(stereo)
    return 2 if stereo else 1


def _with_view(project: Project, options: dict[str, Any]) -> Project:
    """The project with camera and exposure; takes their keys out of `options`."""
    exposure = said(options, ("compensation_ev", "tone_map", "night_look", "glare"))
    for values in (options.pop("exposed"), options.pop("white")):
        exposure |= values or {}
    return msgspec.structs.replace(
        project,
        camera=_camera(project.camera, options),
        exposure=msgspec.structs.replace(project.exposure, **exposure),
    )


def _camera(camera: CameraView | None, options: dict[str, Any]) -> CameraView | None:
    """The project's camera with --eye, --target and --fov applied."""
    points = said(options, ("eye_m", "target_m"))
    angle = said(options, ("vertical_field_of_view_deg",))
    if len(points) == 1:
        raise UserError(_POINTS)
    if angle and not (points or camera):
        raise UserError("--fov needs --eye and --target, or a project with a camera")
    known = {} if camera is None else msgspec.structs.asdict(camera)
    return CameraView(**known | points | angle) if points or angle else camera
