"""Which atmosphere is solved, and which is being solved: a background job of the module's."""

from bruneton_sky.recipe import AirKey
from bruneton_sky.settings import atmosphere_of
from bruneton_sky.solver import SourceField
from bruneton_sky.solver_job import solve_air
from vrut_lite.errors import UserError
from vrut_lite.kernel.ledger import Ledger
from vrut_lite.kernel.messages import JobResult
from vrut_lite.kernel.module import Link

SOLVE = "solve"


class Solving:
    """The latest wish replaces an older one; after an error the solved atmosphere stays."""

    def __init__(self, link: Link, ledger: Ledger):
        self._link, self._ledger = link, ledger
        self.solved: tuple[AirKey, SourceField] | None = None
        self._asked: AirKey | None = None
        self._refused: AirKey | None = None

    def ask(self, air: AirKey) -> None:
        """Have an atmosphere solved, unless it is, is being so, or was refused last.

        Raises:
            UserError: there is no such atmosphere.
        """
        if air == self._asked:
            return
        if self._asked is not None:
            self._ledger.skip("atmosphere overtaken by a newer one")
            self._asked = None
            self._link.cancel_job(SOLVE)
        if air == self._refused:
            return
        # Who comes back to it later is to be told again.
        self._refused = None
        if self.solved is not None and air == self.solved[0]:
            return
        try:
            atmosphere = atmosphere_of(air.settings, air.ground_altitude_m)
        except ValueError as error:
            self._refused = air
            raise UserError(f"bruneton_sky has no such atmosphere: {error}") from error
        self._asked = air
        self._link.start_job(SOLVE, solve_air, atmosphere, air.settings.orders, air.rung)

    def take(self, result: JobResult) -> bool:
        """Swap the new atmosphere in whole; whether there is one."""
        asked, self._asked = self._asked, None
        assert asked is not None
        if result.error:
            self._refused = asked
            return False
        field: SourceField = result.value
        self.solved = (asked, field)
        self._ledger.did("atmosphere solved")
        for what, count in field.skipped.items():
            if count:
                self._ledger.skip(f"{what} of the atmosphere: zero or too small")
        return True
