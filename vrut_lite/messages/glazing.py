"""Transmittance of panes, given by name of a scene's material."""

import math
from typing import Annotated

import msgspec

Share = Annotated[float, msgspec.Meta(ge=0, le=1)]
# Refractive index of clear glass, and reflectance of one face at normal incidence.
IOR = 1.5
_FACE = ((IOR - 1.0) / (IOR + 1.0)) ** 2


class Glazing(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Transmittance of panes at normal incidence, times their colour in linear sRGB; the number of
    panes decides its fall towards grazing angles."""

    transmittance: Share
    colour: tuple[Share, Share, Share] = (1.0, 1.0, 1.0)
    panes: Annotated[int, msgspec.Meta(ge=1, le=4)] = 2


class GlazingFile(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Measured glazing: a Window XML file, and the vector that is up in it, world axes."""

    file: str
    up: tuple[float, float, float] = (0.0, 1.0, 0.0)

    def __post_init__(self) -> None:
        length = math.hypot(*self.up)
        if not 0.0 < length < math.inf:
            raise ValueError(f"up is {self.up}: give a finite vector of some length")


def clear_at_right_angles(panes: int) -> float:
    """Transmittance of clear panes at normal incidence, with all reflections between them."""
    return (1.0 - _FACE) / (1.0 + (2 * panes - 1) * _FACE)
