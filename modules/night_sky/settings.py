"""The settings of the night."""

from typing import Annotated, ClassVar

import msgspec

from vrut_lite.kernel.settings import setting
from vrut_lite.sky.effective_defaults import Preset


class NightSkySettings(msgspec.Struct, frozen=True):
    """Settings of the night sky's lights."""

    presets: ClassVar[dict[str, Preset]] = {
        "Natural": Preset("far from all towns, the Milky Way in full", {"zenith_magnitude": 22.0}),
        "Village": Preset("some lamps, the Milky Way still seen", {"zenith_magnitude": 21.0}),
        "Suburb": Preset("a grey sky with the brighter stars", {"zenith_magnitude": 19.5}),
        "Inner city": Preset("a glowing sky, few stars", {"zenith_magnitude": 17.5}),
    }
    night: Annotated[
        bool, setting("Moon, stars and the sky's own glow; without them the night is one grey")
    ] = True
    show_stars: Annotated[bool, setting("Draw stars and planets, as points of light")] = True
    zenith_magnitude: Annotated[
        float,
        setting(
            "Darkness of the zenith under the glow of lamps, in magnitudes per square second of "
            "arc: 22 natural, 19 to 20 suburb, 17 to 18 city",
            16.0,
            22.0,
            label="Darkness of the zenith",
        ),
    ] = 22.0
    solar_flux_sfu: Annotated[
        float,
        setting(
            "The sun's radio flux at 10.7 cm, by which the air glows: 70 in quiet years, 200 in "
            "active ones",
            60.0,
            300.0,
            unit="sfu",
            source="Noll et al. 2012",
            label="Radio flux of the sun",
        ),
    ] = 130.0
    danjon: Annotated[
        float,
        setting(
            "How bright the eclipsed moon is on Danjon's scale: 0 hardly visible, 2 deep red, 4 "
            "bright copper",
            0.0,
            4.0,
            source="Danjon 1920",
            label="Danjon number",
        ),
    ] = 2.0
