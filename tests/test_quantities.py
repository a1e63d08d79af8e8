"""Numbers and units as people read them: one form each, from starlight to noon."""

import math

import pytest

from vrut_lite.quantities import (
    degrees_text,
    figure,
    luminance_text,
    lux_text,
    percent_text,
    suffix_of,
    with_unit,
)


@pytest.mark.parametrize(
    ("value", "said"),
    [
        (0.0, "0"), (0.0123, "0.0123"), (0.999, "0.999"), (12.34, "12.3"), (99.96, "100"),
        (100.4, "100"), (1090.0, "1,090"), (123456.7, "123,457"), (-1090.0, "-1,090"),
        (0.00032, "0.00032"), (0.000032, "3.2 × 10⁻⁵"), (1e-12, "1 × 10⁻¹²"),
    ],
)  # fmt: skip
def test_a_number_has_three_figures_and_groups_of_thousands(value, said):
    """Never 1.09e+03, which few read at a glance."""
    assert figure(value) == said


def test_a_number_that_is_none_is_still_a_text():
    """A reading must not raise while it is drawn."""
    assert figure(math.nan) == "nan"
    assert figure(math.inf) == "inf"


def test_units_follow_after_a_space_and_degrees_do_not():
    """As in print; settings may call degrees deg."""
    assert lux_text(1090.0) == "1,090 lx"
    assert luminance_text(12.5) == "12.5 cd/m²"
    assert degrees_text(12.345) == "12.3°"
    assert percent_text(0.35) == "35 %"
    assert percent_text(0.35, 1) == "35.0 %"
    assert with_unit(250.0, "deg") == "250°"
    assert suffix_of("deg") == suffix_of("°") == "°"
    assert suffix_of("") == ""
