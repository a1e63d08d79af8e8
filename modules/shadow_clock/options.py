"""Options of a measured shadow, which `when` and `where` share."""

from collections.abc import Callable
from typing import Any

import click

from shadow_clock.measured_shadow import (
    BEARING_ERROR_DEG,
    MOST_RATIO,
    RATIO_ERROR,
)
from vrut_lite.headless import FiniteRange


def shadow_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """Add --shadow-bearing, --length-ratio and their errors."""
    for option in (
        click.option("--ratio-error", type=FiniteRange(0.0, 0.9), default=RATIO_ERROR,
                     show_default=True, metavar="SHARE",
                     help="How far the ratio may be off, as a share of it."),
        click.option("--bearing-error-deg", type=FiniteRange(0.0, 90.0), default=BEARING_ERROR_DEG,
                     show_default=True, metavar="DEG", help="How far the bearing may be off."),
        click.option("--length-ratio", type=FiniteRange(1e-3, MOST_RATIO), metavar="R",
                     help="Length of the shadow over the height of the object."),
        click.option("--shadow-bearing", "bearing_deg", type=FiniteRange(-360.0, 360.0),
                     metavar="DEG", help="Where the shadow points, from the object's foot: degrees "
                     "clockwise from true north."),
    ):  # fmt: skip
        command = option(command)
    return command
