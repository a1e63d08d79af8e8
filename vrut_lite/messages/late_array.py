"""An array for messages whose numbers are computed when somebody reads them."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Self

from vrut_lite.array import Array
from vrut_lite.errors import UserError
from vrut_lite.numeric_types import Float32Array


@dataclass(frozen=True)
class LateArray:
    """Float32 numbers that a graphics card computes for pictures, the processor for readers.

    Two are equal if shape and inputs are equal, so that messages compare and journals digest alike
    on every machine, with a card or without.

    Attributes:
        shape: of the numbers.
        inputs: all that decides them besides the sender's own tables.
    """

    shape: tuple[int, ...]
    inputs: tuple[Array, ...]

    # Not fields, because they are neither compared nor recorded.
    _compute = None
    _recipe = None

    def by(self, compute: Callable[[], Float32Array], recipe: Any) -> Self:
        """This description, with what computes the numbers here and what the card needs."""
        object.__setattr__(self, "_compute", compute)
        object.__setattr__(self, "_recipe", recipe)
        return self

    @property
    def recipe(self) -> Any:
        """Input of the sender's frame part; None in an array of another process."""
        return self._recipe

    @cached_property
    def values(self) -> Float32Array:
        """The numbers, read-only, computed at the first use.

        Raises:
            UserError: the array is of another process or of a journal.
        """
        if self._compute is None:
            raise UserError("these numbers stay in the process that computes them")
        found = self._compute()
        found.flags.writeable = False
        return found
