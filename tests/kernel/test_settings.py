from typing import Annotated, Literal

import msgspec
import pytest

from vrut_lite.errors import UserError
from vrut_lite.kernel.settings import change, describe


class Layers(msgspec.Struct, frozen=True):
    """Settings that may be left open."""

    height_m: (
        Annotated[float, msgspec.Meta(ge=10, le=50, description="Height", extra={"unit": "m"})]
        | None
    ) = None
    form: Annotated[Literal["thin", "thick"], msgspec.Meta(description="Form")] | None = None


def test_a_setting_that_may_be_none_is_described_with_its_range():
    """A panel and a help text need bounds, unit and choices, open or not."""
    height, form = describe(Layers).values()
    assert (height.type, height.at_least, height.at_most) == (float, 10.0, 50.0)
    assert height.range_text() == "between 10 and 50 m, or none"
    assert form.choices == ("thin", "thick")
    assert form.range_text() == "one of thin, thick, or none"
    assert height.default_text() == "none"


@pytest.mark.parametrize("value", ["none", None])
def test_none_leaves_it_open_again(value):
    """A value that was set must be takeable back, from a command line too."""
    settings = change(Layers(), "air", "height_m", "20")
    assert settings == Layers(height_m=20.0)
    assert change(settings, "air", "height_m", value) == Layers()


def test_a_value_outside_is_refused_with_what_is_accepted():
    """None being allowed must not open the bounds."""
    with pytest.raises(UserError, match=r"height_m of air must be between 10 and 50 m, or none"):
        change(Layers(), "air", "height_m", "60")
    with pytest.raises(UserError, match="form of air must be one of thin, thick, or none"):
        change(Layers(), "air", "form", "wide")
