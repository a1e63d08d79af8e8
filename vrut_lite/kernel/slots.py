"""Slots: roles that exactly one module holds."""

from collections.abc import Mapping

from vrut_lite.errors import UserError
from vrut_lite.kernel.loaded_module import LoadedModule
from vrut_lite.kernel.messages import SlotChanged


class Slots:
    """The holders of slots; another provider replaces a holder that stops."""

    def __init__(self, seats: Mapping[str, LoadedModule]):
        self._seats = seats
        self._holders: dict[str, str] = {}

    def holder(self, slot: str) -> str:
        """Name of the module that holds the slot, or an empty text."""
        return self._holders.get(slot, "")

    def held_by(self, module: str) -> list[str]:
        """The slots that a module holds."""
        return [slot for slot, holder in self._holders.items() if holder == module]

    def spoken_for(self, slot: str, sender: str) -> bool:
        """Whether another than the sender holds the slot."""
        return self._holders.get(slot, "") not in ("", sender)

    def providers(self, slot: str) -> list[str]:
        """Names of all modules that could hold the slot, in load order."""
        return [name for name, seat in self._seats.items() if slot in seat.manifest.provides]

    def lacking(self, module: str) -> str:
        """A required slot that has had no holder yet, or an empty text.

        Of a holder that stopped, the last messages stay and serve.
        """
        requires = self._seats[module].manifest.requires
        return next((slot for slot in requires if slot not in self._holders), "")

    def fill(self) -> list[SlotChanged]:
        """Hand each slot that lacks a holder to the first provider that can hold it and stands in.

        A slot that is filled may enable the provider of another that requires it.
        """
        provided = [slot for seat in self._seats.values() for slot in seat.manifest.provides]
        slots = dict.fromkeys([*provided, *self._holders])
        changes = [change for slot in slots if (change := self._filled(slot))]
        return changes + self.fill() if changes else []

    def choose(self, slot: str, module: str) -> SlotChanged | None:
        """Give the slot to a module; None if it held it already.

        Raises:
            UserError: the module does not run, or a slot that it requires has had no holder.
        """
        seat = self._seats[module]
        if not seat.running:
            raise UserError(f"module {module} is {seat.state}: restart it, then choose it")
        if lacking := self.lacking(module):
            raise UserError(
                f"module {module} needs the slot '{lacking}', which no running module can fill"
            )
        return self._hand_to(slot, module)

    def _filled(self, slot: str) -> SlotChanged | None:
        providers = [(name, self._seats[name]) for name in self.providers(slot)]
        able = {name: seat for name, seat in providers if seat.running and not self.lacking(name)}
        if self.holder(slot) in able:
            return None
        standing_in = (name for name, seat in able.items() if seat.manifest.stand_in)
        return self._hand_to(slot, next(standing_in, ""))

    def _hand_to(self, slot: str, module: str) -> SlotChanged | None:
        if self.holder(slot) == module:
            return None
        self._holders[slot] = module
        return SlotChanged(name=slot, holder=module)
