"""Journals of earlier versions mean today what they meant then."""

import pytest

from vrut_lite.recording.earlier_names import in_todays_words, settings_in_todays_words


@pytest.mark.parametrize(
    ("message", "size", "today"),
    [("BackgroundChanged", 1, None), ("BackgroundChanged", 8, 8), ("Told", 1, 1)],
)
def test_a_sky_of_one_texel_was_one_of_any_size(message, size, today):
    """A Demand of size 1 left the size of a sky to its module; None does today."""
    plain = {"consumer": "view", "message": message, "size": size, "encoding": ""}
    assert in_todays_words("Demand", plain) == ("Demand", {**plain, "size": today})


def test_a_skys_own_haze_may_be_none():
    """A refused turbidity was told without it; other faults read as they were."""
    for error, today in (
        ("turbidity of sky must be between 1 and 10, not 99", "between 1 and 10, or none, not 99"),
        ("albedo of sky must be between 0 and 1, not 99", "between 0 and 1, not 99"),
    ):
        said = in_todays_words("Fault", {"where": "", "error": error})[1]["error"]
        assert said.endswith(f"must be {today}")


def test_settings_that_were_not_recorded_are_what_they_were():
    """A sky of before had one lobe and the published level; what was recorded stays."""
    assert settings_in_todays_words({"mie_g": None})["aerosol"] == "one-lobe"
    assert settings_in_todays_words({"sun_colour": "disc"})["sky_level"] == "published"
    both = {"sun_colour": "air", "sky_level": "equal-haze"}
    assert settings_in_todays_words(both) == both


def test_one_layer_of_clouds_is_a_list_of_one():
    """Clouds had one layer of droplets, or none, and two lobes that scattered."""
    one, none = (
        in_todays_words("CloudsChanged", {"layer": layer, "source": "clouds"})[1]
        for layer in ({"base_m": 900.0, "phase": [0.8, -0.2, 0.7]}, None)
    )
    assert (one["layers"][0]["base_m"], one["layers"][0]["particles"]) == (900.0, "droplets")
    assert "phase" not in one["layers"][0]
    assert none == {"layers": [], "source": "clouds"}
