"""Options on the scene: --up, --metres-per-unit, --scene-camera, --variant and --animation."""

from typing import Any

import click
import msgspec

from vrut_lite.commands.options import Command, said
from vrut_lite.errors import UserError
from vrut_lite.messages.placement import LEAST_METRES_PER_UNIT, MOST_METRES_PER_UNIT, UP_AXES
from vrut_lite.plain_numbers import plain_float
from vrut_lite.project import Project
from vrut_lite.studio.number_types import FiniteRange


def _animation(text: str) -> dict[str, Any]:
    if text in ("rest", "clock"):
        return {"animation": text}
    try:
        return {"animation": "time", "animation_time_s": plain_float(text)}
    except ValueError:
        raise UserError(
            f"--animation {text} is neither rest nor clock nor a number of seconds"
        ) from None


def scene_options(command: Command) -> Command:
    """Add the options."""
    for option in (
        click.option("--animation", "animated", type=_animation, metavar="rest|clock|SECONDS",
                     help="The scene's own animations: at rest (default), by the clock, or at a "
                     "time."),
        click.option("--scene-camera", metavar="NAME|N", help="Which of the scene's own cameras to "
                     "look through, by name or counted from 1. Default: the first."),
        click.option("--variant", metavar="NAME|N", help="Which of the scene's variants of "
                     "materials to show, by name or counted from 1."),
        click.option("--metres-per-unit", metavar="METRES",
                     type=FiniteRange(LEAST_METRES_PER_UNIT, MOST_METRES_PER_UNIT),
                     help="Length of the scene file's unit, 0.01 if it is in centimetres. Default: "
                     "glTF's metre; guessed for OBJ."),
        click.option("--up", type=click.Choice(UP_AXES), help="The scene file's vertical axis. "
                     "Default: glTF's y; guessed for OBJ."),
    ):  # fmt: skip
        command = option(command)
    return command


def with_scene_options(project: Project, options: dict[str, Any]) -> Project:
    """The project with what they say; takes their keys out of `options`.

    Raises:
        UserError: there is no scene that they could be about.
    """
    animated = options.pop("animated") or {}
    placed = said(options, ("up", "metres_per_unit"))
    chosen = said(options, ("scene_camera", "variant"))
    if (placed or chosen) and not project.scene:
        raise UserError(
            "--up, --metres-per-unit, --scene-camera and --variant need a scene: name one"
        )
    if "scene_camera" in chosen:
        # The scene's own camera is asked for: the project's gives way to it.
        chosen["camera"] = None
    placement = msgspec.structs.replace(project.placement, **placed)
    return msgspec.structs.replace(project, placement=placement, **animated, **chosen)
