"""A user's choices among the parts of a scene's files, by name or counted from 1."""

from collections.abc import Sequence

from vrut_lite.scene.placed import SceneCamera
from vrut_lite.scene.scene_file_error import SceneFileError


def chosen_camera(cameras: Sequence[SceneCamera], asked: str) -> SceneCamera | None:
    """The camera that is asked for; the first, if there is one, where nothing is.

    Raises:
        SceneFileError: there is no such camera.
    """
    if not asked:
        return cameras[0] if cameras else None
    return cameras[_number([camera.name for camera in cameras], asked, "camera")]


def chosen_variant(names: Sequence[str], asked: str) -> str:
    """The name of the variant of materials that is asked for; "" where nothing is.

    Raises:
        SceneFileError: there is no such variant.
    """
    return names[_number(names, asked, "variant")] if asked else ""


def _number(names: Sequence[str], asked: str, what: str) -> int:
    if asked in names:
        return names.index(asked)
    if asked.isdecimal() and 1 <= int(asked) <= len(names):
        return int(asked) - 1
    there = ", ".join(f"{number} ({ascii(name)[1:-1]})" for number, name in enumerate(names, 1))
    raise SceneFileError(
        f"it has no {what} {ascii(asked)[:60]}: there are {there[:200]}"
        if names
        else f"it has no {what} {ascii(asked)[:60]}, for it has no {what}s; leave it out"
    )
