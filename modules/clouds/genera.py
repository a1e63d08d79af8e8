"""The genera of clouds: where each usually lies, how dense it is, and the form of its clouds.

Heights, thicknesses and extinctions are typical of middle latitudes (WMO 2017, "International Cloud
Atlas"; Hess, Koepke and Schult 1998, table 1b, for extinctions); forms are ours, by eye. Ice's
extinction counts what turns light by more than the sun's disc, 36 % of all
(vrut_lite_lab.ice_phase).
"""

from typing import Literal, NamedTuple

from vrut_lite.messages.clouds import CloudForm, Particles

LowGenus = Literal["Cu", "Sc", "St", "Ns", "Cb"]
MiddleGenus = Literal["Ac", "As"]
HighGenus = Literal["Ci", "Cs"]
Genus = Literal["Cu", "Sc", "St", "Ns", "Cb", "Ac", "As", "Ci", "Cs"]
# Pattern of a genus in the weather map: convection, a closed sheet with thin places, or fibres.
Pattern = Literal["cells", "sheet", "fibres"]


class Typical(NamedTuple):
    """A genus as it usually is."""

    name: str
    coverage: float
    base_m: float
    thickness_m: float
    extinction_per_m: float
    pattern: Pattern
    form: CloudForm
    particles: Particles = "droplets"


_HEAPS = CloudForm(least_height=0.1, growth=0.55, side_fade=0.3, top_fade=0.8, fraying=0.36)
_SHEET = CloudForm(
    weather_periods_m=(61_000.0, 38_700.0), shape_period_m=9_100.0, detail_period_m=1_900.0,
    least_height=0.5, growth=0.7, side_fade=0.3, base_fade=0.3, top_fade=0.6, fraying=0.2,
    sharpness=4.0,
)  # fmt: skip
GENERA: dict[Genus, Typical] = {
    "Cu": Typical("cumulus", 0.35, 1300.0, 1500.0, 0.05, "cells", _HEAPS),
    "Sc": Typical(
        "stratocumulus", 0.8, 900.0, 700.0, 0.08, "cells",
        CloudForm(
            weather_periods_m=(23_000.0, 14_700.0), shape_period_m=3_700.0, detail_period_m=610.0,
            least_height=0.2, growth=0.8, side_fade=0.3, base_fade=0.12, top_fade=0.8,
            fraying=0.3, sharpness=3.5,
        ),
    ),
    "St": Typical("stratus", 1.0, 250.0, 600.0, 0.1, "sheet", _SHEET),
    "Ns": Typical("nimbostratus", 1.0, 600.0, 4000.0, 0.04, "sheet", _SHEET),
    "Cb": Typical(
        "cumulonimbus", 0.2, 900.0, 9500.0, 0.04, "cells",
        CloudForm(
            weather_periods_m=(211_000.0, 131_000.0), shape_period_m=14_300.0,
            detail_period_m=1_900.0, least_height=0.12, growth=0.4, side_fade=0.3, anvil=0.2,
            base_fade=0.02, top_fade=0.7, fraying=0.34, sharpness=5.0,
        ),
    ),
    "Ac": Typical(
        "altocumulus", 0.6, 3600.0, 450.0, 0.06, "cells",
        CloudForm(
            weather_periods_m=(13_700.0, 9_100.0), shape_period_m=2_300.0, detail_period_m=410.0,
            least_height=0.3, growth=0.5, side_fade=0.3, base_fade=0.2, top_fade=0.8,
            fraying=0.34, sharpness=3.0,
        ),
    ),
    "As": Typical("altostratus", 1.0, 3400.0, 1800.0, 0.025, "sheet", _SHEET),
    "Ci": Typical(
        "cirrus", 0.45, 8500.0, 1200.0, 0.0015, "fibres",
        CloudForm(
            weather_periods_m=(83_000.0, 51_700.0), second_share=0.2, shape_period_m=4_300.0,
            detail_period_m=700.0, stretch=9.0, lean=4.0, least_height=0.6, growth=0.6,
            side_fade=0.7, base_fade=0.4, top_fade=0.5, fraying=0.45, sharpness=1.2,
        ),
        "ice",
    ),
    "Cs": Typical(
        "cirrostratus", 1.0, 8500.0, 1500.0, 0.0006, "sheet",
        CloudForm(
            weather_periods_m=(97_000.0, 61_300.0), shape_period_m=13_700.0,
            detail_period_m=2_900.0, stretch=3.0, lean=2.0, least_height=0.8, growth=0.8,
            side_fade=0.3, base_fade=0.3, top_fade=0.4, fraying=0.1, sharpness=1.6,
        ),
        "ice",
    ),
}  # fmt: skip
