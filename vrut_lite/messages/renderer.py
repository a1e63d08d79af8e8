"""The renderer of this machine, as a fact that journals record."""

from typing import ClassVar

from vrut_lite import checks
from vrut_lite.errors import UserError
from vrut_lite.kernel.messages import Input


class RendererTried(Input, frozen=True, kw_only=True):
    """The host's OpenGL renderer and its trial's time, by which "auto" chooses card or processor.

    A host without OpenGL sends none. A journal records it, so that a session with a card replays
    without one.

    Attributes:
        renderer: name of the renderer.
        trial_ns: nanoseconds of a trial pixel (`vrut_lite.render.device`).
        is_software: whether a processor renders, however fast.
    """

    revises: ClassVar[bool] = False
    sets_up: ClassVar[bool] = True

    renderer: str
    trial_ns: float
    is_software: bool = False

    def check(self) -> None:
        """A name, and a time above 0."""
        checks.text(self, "renderer")
        checks.flag(self, "is_software")
        if not (checks.is_finite(self.trial_ns) and self.trial_ns > 0.0):
            raise UserError(
                f"the trial of a renderer takes more than 0 ns, not {checks.shown(self.trial_ns)}"
            )
