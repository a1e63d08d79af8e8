"""Height of the eye."""

from vrut_lite.kernel.module import Link
from vrut_lite.messages.camera import MoveCamera
from vrut_lite.messages.scene import SceneNeeds


def eye_height_m(link: Link) -> float:
    """The eye's height above the ground, at least 0.

    It is that of the shown view, also of a scene's own camera; without a scene manager that of the
    moved camera.
    """
    needs = link.last(SceneNeeds)
    if needs is not None:
        return max(needs.eye_height_m, 0.0)
    camera = link.last(MoveCamera)
    return max(camera.eye_m[1], 0.0) if camera is not None else 0.0
