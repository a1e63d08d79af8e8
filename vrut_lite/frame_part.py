"""Frame parts: what modules draw into the picture. The interface is provisional until 1.0.

A module brings a part by an entry point of the group `vrut_lite.frame_parts` that names a subclass
of `FramePart`. The scene manager hears the messages that it names in `hears`; the renderer makes
one instance on its GL thread, hands it those messages and lets it draw. Nobody else knows of it.
"""

import logging
from collections.abc import Mapping
from functools import cache
from importlib.metadata import entry_points
from pathlib import Path
from typing import Any, ClassVar, Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray

from vrut_lite.errors import UserError
from vrut_lite.foreign_errors import sentence_of
from vrut_lite.interrupts import pass_interrupt
from vrut_lite.kernel.ledger import Ledger
from vrut_lite.kernel.messages import Derived

GROUP = "vrut_lite.frame_parts"
Heard = Mapping[type[Derived], Derived]
D = TypeVar("D", bound=Derived)
_log = logging.getLogger(__name__)


class PartView(Protocol):
    """The camera of a picture."""

    @property
    def eye_m(self) -> NDArray[np.float64]:
        """The eye (3,), world axes."""

    @property
    def projection(self) -> NDArray[np.float64]:
        """Matrix (4, 4) from the camera's axes to clip space; depth is reversed."""

    @property
    def clip_from_eye(self) -> NDArray[np.float64]:
        """Matrix (4, 4) from positions relative to the eye, in world axes, to clip space."""


class Screen(Protocol):
    """A fragment shader for every pixel; its input `ray` is the pixel's direction from the eye."""

    program: Any

    def set(self, name: str, value: Any) -> None:
        """Set a uniform, a number or numbers, unless the compiler found it unused."""

    def draw(self, view: PartView, box_px: tuple[int, int, int, int] | None = None) -> None:
        """Draw into the bound framebuffer, or a box of it: left, lower, width and height."""


class PartGl(Protocol):
    """The renderer's side of a part; it frees what it made when the part goes.

    Attributes:
        context: moderngl's context.
        ledger: counts what the frame did and skipped.
    """

    context: Any
    ledger: Ledger

    def screen(self, fragment_shader: Path) -> Screen:
        """A program of a module's own shader; `//!include FILE` brings the renderer's files."""

    def program(self, vertex_shader: Path, fragment_shader: Path) -> Any:
        """moderngl's program of a module's own shaders."""


class FramePart:
    """A module's part of the frame; override the hooks it uses. All calls come on the GL thread.

    A part that raises is left out of all further pictures, and a warning says so.
    """

    # Messages whose latest ones `show` gets. Those of a slot go when nobody holds it.
    hears: ClassVar[tuple[type[Derived], ...]] = ()

    def __init__(self, gl: PartGl):
        self.gl = gl

    def show(self, heard: Heard) -> None:
        """Draw these from the next picture on; called when one of them changes."""

    @property
    def is_seen(self) -> bool:
        """Whether there is anything to draw."""
        return True

    def draw_over_sky(self, size_px: tuple[int, int], view: PartView) -> None:
        """Add radiance (linear sRGB, W m^-2 sr^-1) to the sky where no surface covers it.

        Blending adds what fragments return, whose alpha must be 0; clouds come after.
        """

    def release(self) -> None:
        """Free the GL objects that the part made by itself."""


@cache
def frame_parts() -> dict[str, type[FramePart]]:
    """Parts by the names of their entry points; a part that fails to load is left out, warned."""
    found = {}
    for point in sorted(entry_points(group=GROUP), key=lambda point: point.name):
        try:
            part = point.load()
            if not (isinstance(part, type) and issubclass(part, FramePart)):
                raise UserError("it names no subclass of FramePart")
            found[point.name] = part
        except BaseException as error:
            pass_interrupt(error)
            _log.warning("the frame part %s failed to load: %s", point.name, sentence_of(error))
    return found


def heard_by_parts() -> tuple[type[Derived], ...]:
    """Types of all messages that parts hear."""
    return tuple(dict.fromkeys(kind for part in frame_parts().values() for kind in part.hears))
