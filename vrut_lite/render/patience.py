"""Whether somebody waits for a picture that takes long."""

from vrut_lite.kernel.ledger import Ledger
from vrut_lite.scene.backend import GivenUp, IsGivenUp


class Patience:
    """Whether somebody waits for the picture that is being drawn.

    `is_given_up` is None for a picture that is finished in any case. The ledger counts, as
    skipped, pictures that were given up.
    """

    def __init__(self, ledger: Ledger):
        self._ledger = ledger
        self.is_given_up: IsGivenUp | None = None

    def check(self) -> None:
        """Go on, or raise GivenUp."""
        if self.is_given_up is not None and self.is_given_up():
            self._ledger.skip("picture: given up")
            raise GivenUp
