"""Journals of earlier versions mean today what they meant then."""

import pytest

from vrut_lite.recording.earlier_names import in_todays_words


@pytest.mark.parametrize(
    ("message", "size", "today"),
    [("BackgroundChanged", 1, None), ("BackgroundChanged", 8, 8), ("Told", 1, 1)],
)
def test_a_sky_of_one_texel_was_one_of_any_size(message, size, today):
    """A Demand of size 1 left the size of a sky to its module; None does today."""
    plain = {"consumer": "view", "message": message, "size": size, "encoding": ""}
    assert in_todays_words("Demand", plain) == ("Demand", {**plain, "size": today})
