"""Genera give layers their numbers, and settings of one's own go before them."""

import pytest
from clouds.genera import GENERA
from clouds.settings import CloudSettings

from vrut_lite.kernel.settings import change
from vrut_lite.sky.effective_defaults import presets_of


def test_without_genus_or_coverage_there_are_no_clouds():
    """Nothing is drawn that nobody asked for; a coverage alone is cumulus."""
    assert CloudSettings().layers == ()
    assert [layer.genus for layer in CloudSettings(coverage=0.4).layers] == ["Cu"]
    assert CloudSettings(genus="Sc", coverage=0.0).layers == ()


def test_a_genus_gives_what_is_left_open():
    """Numbers of one's own stay; the panel shows the others."""
    settings = CloudSettings(genus="Sc", base_m=1700.0, high_genus="Ci")
    low, high = settings.layers
    assert (low.base_m, low.thickness_m) == (1700.0, GENERA["Sc"].thickness_m)
    assert (high.genus, high.coverage) == ("Ci", GENERA["Ci"].coverage)
    assert settings.left_open(None)["thickness_m"] == GENERA["Sc"].thickness_m


def test_layers_lie_above_each_other():
    """A cumulonimbus reaches into the high layer, which is lifted to its top."""
    low, high = CloudSettings(genus="Cb", high_genus="Ci").layers
    assert high.base_m == low.base_m + low.thickness_m > GENERA["Ci"].base_m


@pytest.mark.parametrize("name", presets_of(CloudSettings))
def test_presets_are_settings(name):
    """Every preset is accepted, names all that an earlier one may have set, and has clouds.

    The weather's has them when there is a weather.
    """
    values = presets_of(CloudSettings)[name].values
    made = CloudSettings()
    for setting, value in values.items():
        made = change(made, "clouds", setting, value)
    assert bool(made.layers) == (name not in ("Clear", "Weather file"))
    assert {"genus", "middle_coverage", "high_base_m"} <= set(values)
