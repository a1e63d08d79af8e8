"""Where the observer stands, for modules whose light depends on it."""

from vrut_lite.daylight.camera import MoveCamera
from vrut_lite.daylight.scene import SceneNeeds
from vrut_lite.kernel.module import Link


def eye_height_m(link: Link) -> float:
    """Height of the eye above the place's ground, at least 0.

    That of the view that is shown, be it a scene's own; where no scene manager says so, that of
    the camera as it was moved.
    """
    needs = link.last(SceneNeeds)
    if needs is not None:
        return max(needs.eye_height_m, 0.0)
    camera = link.last(MoveCamera)
    return max(camera.eye_m[1], 0.0) if camera is not None else 0.0
