"""Quantities as people read them, written alike in window, legends, plans and captions.

* A number has three figures, and all before its point, in groups of three: 0.123, 12.3, 1,090.
  Below 0.0001 it has a power of ten: 3.2 x 10^-5, with the signs of print.
* A unit follows after a space: 1,090 lx, 12.5 cd/m^2 with a raised 2, 35 %. Degrees of angle have
  no space, and one decimal where they are read: 12.3 with the sign of degrees.
* CSV, JSON and EXR are for machines: plain numbers, units in the names of columns and keys.
"""

import math

DEGREE = "\N{DEGREE SIGN}"
CD_M2 = "cd/m\N{SUPERSCRIPT TWO}"
W_M2 = "W/m\N{SUPERSCRIPT TWO}"
W_M2_SR = "W/(m\N{SUPERSCRIPT TWO} sr)"
# Stands where a quantity will.
COMPUTING = "computing\N{HORIZONTAL ELLIPSIS}"
# Units as settings and scripts name them, where people write a sign.
_SIGNS = {"deg": DEGREE}
# From here on a number has all its figures before the point.
_WHOLE = 100.0
_LEAST_PLAIN = 1e-4
_RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
# A tenth of the light of an overcast night without moon.
_DARK_LX = 1e-5
_DARK = "dark: light of stars and cities is left out"


def figure(value: float) -> str:
    """A number in three figures and more: 0.0123, 12.3, 1,090; 3.2 times a power of ten."""
    size = abs(value)
    if size >= _WHOLE:
        return f"{value:,.0f}"
    if size >= _LEAST_PLAIN or size == 0.0:
        return f"{value:.3g}"
    if not math.isfinite(value):
        return str(value)
    power = math.floor(math.log10(size))
    return f"{value / 10.0**power:.2g} \N{MULTIPLICATION SIGN} 10{str(power).translate(_RAISED)}"


def unit_sign(unit: str) -> str:
    """The unit of a setting as people write it."""
    return _SIGNS.get(unit, unit)


def suffix_of(unit: str) -> str:
    """Suffix of a number: its unit, after a space except for degrees."""
    unit = unit_sign(unit)
    return unit if unit == DEGREE else f" {unit}" if unit else ""


def with_unit(value: float, unit: str) -> str:
    """A number in three figures and more, with its unit."""
    return figure(value) + suffix_of(unit)


def lux_text(lux: float) -> str:
    """Illuminance, from starlight to noon; where none is left, why."""
    return _DARK if lux < _DARK_LX else with_unit(lux, "lx")


def luminance_text(cd_m2: float) -> str:
    """Luminance in cd/m2."""
    return with_unit(cd_m2, CD_M2)


def degrees_text(angle_deg: float, decimals: int = 1) -> str:
    """An angle in degrees."""
    return f"{angle_deg:.{decimals}f}{DEGREE}"


def percent_text(share: float, decimals: int | None = None) -> str:
    """A share in percent, in three figures and more or with so many decimals."""
    return with_unit(100.0 * share, "%") if decimals is None else f"{100.0 * share:.{decimals}f} %"
