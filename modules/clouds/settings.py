"""The settings of the clouds."""

from typing import Annotated

import msgspec

SHAPE_SOURCE = "Schneider 2015"
Share = msgspec.Meta(
    ge=0,
    le=1,
    description="Share of the zenith that is cloud; 0 is none.",
    extra={"source": SHAPE_SOURCE},
)


class CloudSettings(msgspec.Struct, frozen=True):
    """One layer of cumulus, or of stratocumulus where it covers most of the sky."""

    coverage: Annotated[float, Share] = 0.0
    base_m: Annotated[
        float,
        msgspec.Meta(ge=50, le=12000, description="Altitude of the bases.", extra={"unit": "m"}),
    ] = 1300.0
    thickness_m: Annotated[
        float,
        msgspec.Meta(
            ge=50, le=6000, description="From the bases to the highest top.", extra={"unit": "m"}
        ),
    ] = 1500.0
    extinction_per_m: Annotated[
        float,
        msgspec.Meta(
            ge=0.001,
            le=0.2,
            description="Extinction where the cloud is dense: 0.02 in thin, 0.1 in thick cumulus.",
            extra={"unit": "1/m"},
        ),
    ] = 0.05
    wind_speed_m_s: Annotated[
        float,
        msgspec.Meta(ge=0, le=80, description="Speed of the wind up there.", extra={"unit": "m/s"}),
    ] = 8.0
    wind_azimuth_deg: Annotated[
        float,
        msgspec.Meta(
            ge=0,
            le=360,
            description="Where the wind comes from, from true north, clockwise.",
            extra={"unit": "deg"},
        ),
    ] = 250.0
    seed: Annotated[
        int,
        msgspec.Meta(
            ge=0,
            le=999_999,
            description="Another number, other clouds.",
            extra={"source": SHAPE_SOURCE},
        ),
    ] = 1
