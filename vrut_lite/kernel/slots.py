"""Slots: roles that exactly one module holds, such as the sun's or the sky's."""

from collections.abc import Mapping

from vrut_lite.kernel.messages import SlotChanged
from vrut_lite.kernel.seat import Seat


class Slots:
    """Who holds which slot; a holder that stops is replaced by another that can."""

    def __init__(self, seats: Mapping[str, Seat]):
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

    def fill(self, slot: str) -> SlotChanged | None:
        """Give the slot to the first running provider that stands in, unless its holder runs."""
        running = [name for name in self.providers(slot) if self._seats[name].running]
        if self.holder(slot) in running:
            return None
        able = [name for name in running if self._seats[name].manifest.stand_in]
        return self._hand_to(slot, able[0] if able else "")

    def choose(self, slot: str, module: str) -> SlotChanged | None:
        """Give the slot to a module if it runs; None if nothing changed."""
        return self._hand_to(slot, module) if self._seats[module].running else None

    def _hand_to(self, slot: str, module: str) -> SlotChanged | None:
        if self.holder(slot) == module:
            return None
        self._holders[slot] = module
        return SlotChanged(name=slot, holder=module)
