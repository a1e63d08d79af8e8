"""Glass that is named for a scene: what panes of a material let through."""

from typing import Annotated

import msgspec

Share = Annotated[float, msgspec.Meta(ge=0, le=1)]
# Of clear glass, and what a face of it reflects of light at right angles.
IOR = 1.5
_FACE = ((IOR - 1.0) / (IOR + 1.0)) ** 2


class Glazing(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """What panes of a material let through of light that meets them at right angles, times their
    colour in linear sRGB; how many stand behind each other decides how it falls at the edge."""

    transmittance: Share
    colour: tuple[Share, Share, Share] = (1.0, 1.0, 1.0)
    panes: Annotated[int, msgspec.Meta(ge=1, le=4)] = 2


def clear_at_right_angles(panes: int) -> float:
    """What clear panes let through at right angles, with all that bounces between them."""
    return (1.0 - _FACE) / (1.0 + (2 * panes - 1) * _FACE)
