"""Number types of options: finite, within bounds, in plain digits."""

import math
from typing import Any

import click

from vrut_lite.plain_numbers import plain_float, plain_int


class FiniteRange(click.FloatRange):
    """A number within bounds: click's own range accepts a NaN."""

    def _describe_range(self) -> str:
        """The bounds in `--help`, to four digits."""
        low, high = (f"{bound:.4g}" for bound in (self.min, self.max))
        return f"{low}<=x<={high}"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """The number.

        Raises:
            click.BadParameter: it is no number, or outside the bounds.
        """
        try:
            number = plain_float(str(value))
        except ValueError:
            number = math.nan
        if math.isnan(number):
            self.fail(f"{value} is not a number from {self.min:g} to {self.max:g}", param, ctx)
        return super().convert(number, param, ctx)


class WholeRange(click.IntRange):
    """A whole number within bounds."""

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """The number.

        Raises:
            click.BadParameter: it is no whole number, or outside the bounds.
        """
        try:
            number = plain_int(str(value))
        except ValueError:
            self.fail(f"{value} is not a whole number from {self.min} to {self.max}", param, ctx)
        return super().convert(number, param, ctx)
