"""Layers before the sky, such as clouds.

A module brings one by an entry point of the group `vrut_lite.sky_layers` that names a subclass of
`SkyLayer`. `SkySum` hears its message and asks it for the light of the sky behind it.
"""

import logging
from abc import ABC, abstractmethod
from functools import cache
from typing import Any, ClassVar, NamedTuple

from vrut_lite.errors import UserError
from vrut_lite.foreign_errors import sentence_of
from vrut_lite.interrupts import pass_interrupt
from vrut_lite.kernel.messages import Derived
from vrut_lite.messages.gpu_job import GpuPass
from vrut_lite.messages.sky_light import SkyLightChanged
from vrut_lite.numeric_types import FloatArray, Vector
from vrut_lite.package_facts import load_fitting, usable_points

GROUP = "vrut_lite.sky_layers"
_log = logging.getLogger(__name__)


class Viewpoint(NamedTuple):
    """The eye, and the level square around the middle on which the light falls.

    `eye_m` lies over the scene's `middle_m`, which is on the ground.
    """

    eye_m: Vector
    middle_m: Vector
    half_width_m: float


class SkyLayer(ABC):
    """A module's layer before the sky; its methods are pure functions of its message `hears`."""

    hears: ClassVar[type[Derived]]

    @abstractmethod
    def is_there(self, message: Any) -> bool:
        """Whether there is anything before the sky."""

    def levels_m(self, message: Any) -> tuple[float, ...]:
        """Altitudes near which the layer looks otherwise to an eye that rises."""
        return ()

    def looks_same(self, now: Any, before: Any, height_m: float) -> bool:
        """Whether an eye at a height can tell two layers apart; unequal objects."""
        return False

    @abstractmethod
    def light_under(
        self, message: Any, clear: SkyLightChanged, view: Viewpoint, size: int, source: str
    ) -> SkyLightChanged:
        """The light of a sky, of which radiance is known, behind the layer and with its own light.

        Runs in a background job; `size`: approximate edge of the background in texels.
        """

    def transmittance(
        self, message: Any, directions: FloatArray, eye_m: Vector
    ) -> FloatArray | None:
        """Share (n,) of light from far away, from unit directions (n, 3), that passes the layer to
        an eye; None where the layer cannot tell it.
        """
        return None

    def card_trials(self, message: Any, eye_height_m: float) -> float | None:
        """Work of a texel by `card_passes` (`device_choice`); None where there is no program.

        `eye_height_m` is the eye's above the ground: a card's cube is that of the ground.
        """
        return None

    def card_passes(
        self, message: Any, clear: SkyLightChanged, view: Viewpoint, size: int, scale: float
    ) -> tuple[GpuPass, ...]:
        """Programs of a `GpuJob` that put the layer before the sky, as seen from `view.middle_m`.

        Runs in a background job, beside `light_under`. Image unit 0 holds the cube map of the sky
        behind the layer, in radiance over `scale`, and below the horizon the ground under it;
        units 2 and 3 hold two images for what the programs keep.
        """
        raise NotImplementedError


@cache
def sky_layers() -> dict[str, SkyLayer]:
    """Layers by the names of their entry points; one that fails to load is left out, warned."""
    found = {}
    for point in usable_points(GROUP):
        try:
            layer = load_fitting(point)
            if not (isinstance(layer, type) and issubclass(layer, SkyLayer)):
                raise UserError("it names no subclass of SkyLayer")
            found[point.name] = layer()
        except BaseException as error:
            pass_interrupt(error)
            _log.warning("the sky layer %s failed to load: %s", point.name, sentence_of(error))
    return found
