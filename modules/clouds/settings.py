"""The settings of the clouds: three layers, each by its genus and by optional numbers."""

from typing import Annotated, ClassVar, NamedTuple, get_args

import msgspec

from clouds.genera import GENERA, Genus, HighGenus, LowGenus, MiddleGenus
from vrut_lite.kernel.settings import setting
from vrut_lite.messages.haze import SetHaze
from vrut_lite.sky.effective_defaults import Preset

SHAPE_SOURCE = "Schneider 2015"
GENUS_SOURCE = "WMO 2017, International Cloud Atlas"
_OPEN = "unless set, the genus's"
# The genera as people read them.
_NAMES: dict[str, str] = {
    "none": "None, or the weather's",
    **{genus: f"{typical.name.capitalize()} ({genus})" for genus, typical in GENERA.items()},
}
Coverage = setting(f"Share of the zenith that is cloud; {_OPEN}.", 0, 1, source=SHAPE_SOURCE)
Base = setting(f"Altitude of the bases; {_OPEN}.", 50, 16_000, unit="m")
Thickness = setting(f"From the bases to the highest top; {_OPEN}.", 50, 14_000, unit="m")
Extinction = setting(
    f"Extinction where the cloud is dense: 0.02 in thin, 0.1 in thick cumulus; {_OPEN}.",
    0.00001,
    0.2,
    unit="1/m",
)
Speed = setting("Speed of the wind up there.", 0, 120, unit="m/s")
Azimuth = setting("Where the wind comes from, from true north, clockwise.", 0, 360, unit="deg")
# Names of a layer's settings without its prefix.
_NUMBERS = ("coverage", "base_m", "thickness_m", "extinction_per_m")
_OWN = ("genus", *_NUMBERS, "wind_speed_m_s", "wind_azimuth_deg")


class Passes(NamedTuple):
    """Light that a layer is to let through: a share of that on level ground below a clear sky.

    `direct_share` of that is the sun's.
    """

    global_share: float
    direct_share: float
    sun_elevation_rad: float


class Layer(NamedTuple):
    """One layer as it is to be made; where it `passes` a known light, of another extinction."""

    genus: Genus
    coverage: float
    base_m: float
    thickness_m: float
    extinction_per_m: float
    wind_speed_m_s: float
    wind_azimuth_deg: float
    passes: Passes | None = None


class CloudSettings(msgspec.Struct, frozen=True):
    """A low, a middle and a high layer; None stands for the genus's value.

    A layer without genus is of the one in `_PLAIN`, and has no clouds unless it has a coverage.
    """

    presets: ClassVar[dict[str, Preset]]

    genus: Annotated[
        LowGenus | None,
        setting(
            "Genus of the low layer; none without low clouds",
            source=GENUS_SOURCE,
            label="Low clouds",
            choice_labels=_NAMES,
        ),
    ] = None
    coverage: Annotated[float | None, Coverage] = None
    base_m: Annotated[float | None, Base] = None
    thickness_m: Annotated[float | None, Thickness] = None
    extinction_per_m: Annotated[float | None, Extinction] = None
    wind_speed_m_s: Annotated[float, Speed] = 8.0
    wind_azimuth_deg: Annotated[float, Azimuth] = 250.0
    middle_genus: Annotated[
        MiddleGenus | None,
        setting(
            "Genus of the middle layer; none without middle clouds",
            source=GENUS_SOURCE,
            label="Middle clouds",
            choice_labels=_NAMES,
        ),
    ] = None
    middle_coverage: Annotated[float | None, Coverage] = None
    middle_base_m: Annotated[float | None, Base] = None
    middle_thickness_m: Annotated[float | None, Thickness] = None
    middle_extinction_per_m: Annotated[float | None, Extinction] = None
    middle_wind_speed_m_s: Annotated[float, Speed] = 14.0
    middle_wind_azimuth_deg: Annotated[float, Azimuth] = 260.0
    high_genus: Annotated[
        HighGenus | None,
        setting(
            "Genus of the high layer, of ice; none without high clouds",
            source=GENUS_SOURCE,
            label="High clouds",
            choice_labels=_NAMES,
        ),
    ] = None
    high_coverage: Annotated[float | None, Coverage] = None
    high_base_m: Annotated[float | None, Base] = None
    high_thickness_m: Annotated[float | None, Thickness] = None
    high_extinction_per_m: Annotated[float | None, Extinction] = None
    high_wind_speed_m_s: Annotated[float, Speed] = 30.0
    high_wind_azimuth_deg: Annotated[float, Azimuth] = 270.0
    follow_weather: Annotated[
        bool,
        setting("Genus, coverage and depth that are left open are those of the weather's hour."),
    ] = False
    seed: Annotated[
        int, setting("Another number, other clouds.", 0, 999_999, source=SHAPE_SOURCE)
    ] = 1

    def left_open(self, haze: SetHaze) -> dict[str, float]:
        """Values by genus of the numbers that are None."""
        return {
            prefix + name: float(getattr(layer, name))
            for prefix in _PLAIN
            for layer in [self._layer(prefix)]
            for name in _NUMBERS
        }

    @property
    def layers(self) -> tuple[Layer, ...]:
        """The layers that have clouds, from low to high.

        A layer that would begin below the top of the one under it is lifted to there.
        """
        there = [self._layer(prefix) for prefix in _PLAIN]
        lifted: list[Layer] = []
        for layer in sorted((la for la in there if la.coverage > 0.0), key=lambda la: la.base_m):
            top_m = lifted[-1].base_m + lifted[-1].thickness_m if lifted else layer.base_m
            lifted.append(layer._replace(base_m=max(layer.base_m, top_m)))
        return tuple(lifted)

    def _layer(self, prefix: str) -> Layer:
        own = {name: getattr(self, prefix + name) for name in _OWN}
        genus = own["genus"] or _PLAIN[prefix]
        typical = GENERA[genus]._asdict()
        if own["genus"] is None:
            typical["coverage"] = 0.0
        known = {name: typical[name] if own[name] is None else own[name] for name in _NUMBERS}
        return Layer(**{**own, **known, "genus": genus})


# The prefix of a genus's settings; low ones have none.
PREFIXES = {
    **dict.fromkeys(get_args(MiddleGenus), "middle_"),
    **dict.fromkeys(get_args(HighGenus), "high_"),
}
# The layers by the prefix of their settings, and the genus of a coverage without one.
_PLAIN: dict[str, Genus] = {"": "Cu", "middle_": "Ac", "high_": "Ci"}


def _sky_of(line: str, **genera: Genus) -> Preset:
    """A preset that names the genera of all layers, and leaves their numbers to them."""
    names = [prefix + name for prefix in _PLAIN for name in ("genus", *_NUMBERS)]
    return Preset(line, {**dict.fromkeys(names), **genera})


CloudSettings.presets = {
    "Clear": _sky_of("no cloud"),
    "Weather file": Preset(
        "the clouds of each hour, as a weather file has them",
        {**_sky_of("").values, "follow_weather": True},
    ),
    "Fair weather": _sky_of("cumulus of a fine day, its shadows apart", genus="Cu"),
    "Mostly cloudy": Preset(
        "large clouds with gaps of sun", {**_sky_of("", genus="Cu").values, "coverage": 0.7}
    ),
    "Stratocumulus": _sky_of("a low deck of rolls, bright gaps between them", genus="Sc"),
    "Overcast": _sky_of("a low closed layer: light without a sun", genus="St"),
    "Rain": _sky_of("nimbostratus, thick and dark", genus="Ns"),
    "Thunderstorm": _sky_of("towers with anvils", genus="Cb"),
    "Altocumulus": _sky_of("small heaps in the middle of the air", middle_genus="Ac"),
    "Altostratus": _sky_of("a grey veil that blurs the sun", middle_genus="As"),
    "Cirrus": _sky_of("fibres of ice, thin and white", high_genus="Ci"),
    "Cirrostratus": _sky_of("a white veil of ice over all the sky", high_genus="Cs"),
    "Before a front": _sky_of(
        "cumulus below altocumulus and cirrus", genus="Cu", middle_genus="Ac", high_genus="Ci"
    ),
}
