"""`vrut-lite render`: a picture of a scene under the daylight of a place and an hour."""

from typing import Any, get_args

import click
import msgspec

from vrut_lite.commands.engines import engine_options, with_engine
from vrut_lite.commands.number_types import FiniteRange
from vrut_lite.commands.options import daylight_options, with_options
from vrut_lite.commands.pictures import bits_option, make_pictures, picture_bits, said_of
from vrut_lite.commands.scene_options import scene_options, with_scene_options
from vrut_lite.commands.scene_pictures import ScenePlan
from vrut_lite.commands.time_span import span_options, wanted_pictures
from vrut_lite.commands.workers import worker_options, workers_of
from vrut_lite.errors import UserError
from vrut_lite.pictures.image_files import check_all_writable, picture_format
from vrut_lite.plain_numbers import plain_float, plain_int
from vrut_lite.project import CameraView, Exposure, Project, in_words, project_of_path
from vrut_lite.scene.scene_state import Shown

FORMATS = (".png", ".jpg", ".exr")


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
@click.option("--size", metavar="WxH", help="Picture size in pixels, as 960x540.")
@click.option("--eye", metavar="X,Y,Z", help="Camera position in metres, world axes.")
@click.option("--target", metavar="X,Y,Z", help="Where the camera looks, with --eye.")
@click.option(
    "--fov",
    "field_of_view_deg",
    type=FiniteRange(1.0, 150.0),
    metavar="DEG",
    help="Vertical view angle.",
)
@click.option("--exposure", metavar="EV100", help="'auto' (default) or a fixed EV100.")
@click.option(
    "--compensation",
    type=FiniteRange(-20.0, 20.0),
    metavar="EV",
    help="Brighter by so many stops.",
)
@click.option(
    "--tone-map",
    metavar="agx|exponential|none|eye",
    help="Like film (default), 1 - exp(-k L) as in papers, cut off, or as the eye sees by night.",
)
@click.option(
    "--white",
    metavar="KELVIN[,DUV]",
    help="Show daylight of this colour temperature white; DUV leads off the daylight "
    "locus, towards green. Default 6504: colours as they are.",
)
@click.option("--air/--no-air", default=None, help="See the scene through the air (default).")
@click.option(
    "--light-shafts/--no-light-shafts",
    default=None,
    help="Let the scene's shadows show in the air. Default: no.",
)
@click.option(
    "--show",
    "shows",
    type=click.Choice(get_args(Shown)[1:]),
    help="Instead of the picture, in false colours with a legend: lux on surfaces, the edge of "
    "the light map's texels, or the noise that its rays leave. EXR holds the values.",
)
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
    """Render SCENE (glTF, GLB, OBJ, USD, or a project .toml) to a picture, or to many of a day.

    PNG is exposed and tone-mapped; EXR holds linear sRGB radiance in W m^-2 sr^-1. Automatic
    exposure meters each picture by itself; --exposure EV100 holds it for all of a day.

    Example: vrut-lite render scenes/street.obj -o dusk.png --at 2026-06-21T21:40
    --place 50.0755,14.4378 --turbidity 3 --albedo 0.1

    Example: vrut-lite render scenes/street.toml -o day_%04d.png --at 2026-06-21T00:00
    --from 05:00 --to 21:00 --step 10m
    """
    suffix = picture_format(output, FORMATS)
    project = with_scene_options(project_of_path(scene), options)
    project = _with_view(with_options(project, options), options)
    project, engine = with_engine(project, options)
    wanted = wanted_pictures(output, project, options)
    check_all_writable([path for _, path in wanted])
    plan = ScenePlan(project, picture_bits(bits, suffix), engine)
    with workers_of(jobs, dask, len(wanted)) as workers:
        captions = make_pictures(plan, wanted, workers)
    click.echo(said_of(wanted, captions))


def _with_view(project: Project, options: dict[str, Any]) -> Project:
    """The project with this command's own options."""
    if options["size"] is not None:
        project = msgspec.structs.replace(project, size=_size(options["size"]))
    camera = _camera(project.camera, options)
    of_view = ("air", "light_shafts", "shows")
    seen = {name: options[name] for name in of_view if options[name] is not None}
    project = msgspec.structs.replace(project, camera=camera, **seen)
    exposure = msgspec.structs.asdict(project.exposure)
    if options["exposure"] is not None:
        exposure.update(_exposure(options["exposure"]))
    if options["compensation"] is not None:
        exposure["compensation_ev"] = options["compensation"]
    if options["tone_map"] is not None:
        exposure["tone_map"] = options["tone_map"]
    if options["white"] is not None:
        exposure.update(_white(options["white"]))
    return msgspec.structs.replace(project, exposure=_convert("exposure", exposure, Exposure))


def _size(text: str) -> tuple[int, int]:
    try:
        width, height = map(plain_int, text.lower().split("x"))
    except ValueError:
        raise UserError(f"--size {text} is not of the form WIDTHxHEIGHT, as 960x540") from None
    if not all(16 <= side <= 16384 for side in (width, height)):
        raise UserError(f"--size {text} must lie between 16x16 and 16384x16384 pixels")
    return width, height


def _camera(camera: CameraView | None, options: dict[str, Any]) -> CameraView | None:
    """The project's camera with --eye, --target and --fov applied."""
    view: dict[str, Any] = {} if camera is None else msgspec.structs.asdict(camera)
    if options["eye"] is not None or options["target"] is not None:
        for name in ("eye", "target"):
            view[f"{name}_m"] = _point(options[name])
    if options["field_of_view_deg"] is not None:
        if not view:
            raise UserError("--fov needs --eye and --target, or a project with a camera")
        view["vertical_field_of_view_deg"] = options["field_of_view_deg"]
    return _convert("camera", view, CameraView) if view else None


def _point(text: str | None) -> tuple[float, ...]:
    try:
        return tuple(plain_float(part) for part in (text or "").split(","))
    except ValueError:
        raise UserError(
            "--eye and --target go together, each X,Y,Z in metres: --eye 5,2,8 --target 0,1,0"
        ) from None


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


def _convert(what: str, values: dict[str, Any], kind: type[Any]) -> Any:
    try:
        return msgspec.convert(values, kind)
    except msgspec.ValidationError as error:
        raise UserError(f"{what}: {in_words(error)}") from None
