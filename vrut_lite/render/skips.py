"""Which work a frame leaves out; each may be switched off, to see that the picture stays."""

from dataclasses import dataclass


@dataclass(frozen=True)
class FrameSkips:
    """What is left out, True for each that is.

    Attributes:
        meshes: meshes outside the view.
        sky: samples of the sky that meshes cover.
        shadow: the shadow map when the sun is down, or neither scene nor sun have changed.
        unlit: the sky and its reflection where they light nothing, in a closed room.
        reflection: filtering a sky that is not seen to differ, or that nothing in view mirrors.
    """

    meshes: bool = True
    sky: bool = True
    shadow: bool = True
    unlit: bool = True
    reflection: bool = True
