"""The names of the moon's phases."""

from vrut_lite.quantities import percent_text

# Lit shares that have a name.
_NEW, _FULL, _HALF = 0.02, 0.98, (0.47, 0.53)


def phase_text(lit_fraction: float, waxes: bool) -> str:
    """The phase's name and the lit share."""
    way = "waxing" if waxes else "waning"
    if lit_fraction < _NEW:
        name = "new moon"
    elif lit_fraction > _FULL:
        name = "full moon"
    elif _HALF[0] < lit_fraction < _HALF[1]:
        name = "first quarter" if waxes else "last quarter"
    else:
        name = f"{way} {'crescent' if lit_fraction < _HALF[0] else 'gibbous'}"
    return f"{name}, {percent_text(lit_fraction, 0)} lit"
