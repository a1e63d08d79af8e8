"""The settings of the clouds."""

from typing import Annotated, ClassVar

import msgspec

from vrut_lite.daylight.left_open import Preset
from vrut_lite.kernel.settings import setting

SHAPE_SOURCE = "Schneider 2015"
Share = setting("Share of the zenith that is cloud; 0 is none.", 0, 1, source=SHAPE_SOURCE)


class CloudSettings(msgspec.Struct, frozen=True):
    """One layer of cumulus, or of stratocumulus where it covers most of the sky."""

    presets: ClassVar[dict[str, Preset]] = {
        "Clear": Preset("no cloud", {"coverage": 0.0}),
        "Fair weather": Preset("cumulus of a fine day, its shadows apart", {"coverage": 0.3}),
        "Mostly cloudy": Preset("large clouds with gaps of sun", {"coverage": 0.7}),
        "Overcast": Preset(
            "a low closed layer: light without a sun",
            {"coverage": 1.0, "base_m": 900.0, "thickness_m": 700.0},
        ),
    }
    coverage: Annotated[float, Share] = 0.0
    base_m: Annotated[float, setting("Altitude of the bases.", 50, 12000, unit="m")] = 1300.0
    thickness_m: Annotated[
        float, setting("From the bases to the highest top.", 50, 6000, unit="m")
    ] = 1500.0
    extinction_per_m: Annotated[
        float,
        setting(
            "Extinction where the cloud is dense: 0.02 in thin, 0.1 in thick cumulus.",
            0.001,
            0.2,
            unit="1/m",
        ),
    ] = 0.05
    wind_speed_m_s: Annotated[float, setting("Speed of the wind up there.", 0, 80, unit="m/s")] = (
        8.0
    )
    wind_azimuth_deg: Annotated[
        float, setting("Where the wind comes from, from true north, clockwise.", 0, 360, unit="deg")
    ] = 250.0
    seed: Annotated[
        int, setting("Another number, other clouds.", 0, 999_999, source=SHAPE_SOURCE)
    ] = 1
