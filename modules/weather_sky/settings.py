"""The settings of the sky of the weather."""

from typing import Annotated, ClassVar

import msgspec

from vrut_lite.kernel.settings import setting
from vrut_lite.sky.effective_defaults import Preset
from weather_sky.conditions import Kind

_OPEN = " None: the weather file's, or without one"


# The skies as people read them: "CIE 12" for cie-12.
_SKIES = {
    "perez": "Perez's all-weather sky",
    **{f"cie-{n}": f"CIE {n}" for n in range(1, 16)},
    "cie-overcast": "CIE overcast, traditional",
    "cie-1": "CIE 1, overcast",
    "cie-5": "CIE 5, uniform",
    "cie-12": "CIE 12, clear",
}


class WeatherSettings(msgspec.Struct, frozen=True):
    """How light is spread over the sky, and how much there is."""

    presets: ClassVar[dict[str, Preset]] = {
        "Weather file": Preset(
            "each hour as the weather file has it",
            {
                "distribution": "perez",
                "direct_normal_w_m2": None,
                "diffuse_horizontal_w_m2": None,
                "dew_point_deg_c": None,
            },
        ),
        "Overcast": Preset(
            "CIE's overcast sky: three times as bright above as low down", {"distribution": "cie-1"}
        ),
        "Partly cloudy": Preset(
            "a hazy sun between clouds, by Perez",
            {
                "distribution": "perez",
                "direct_normal_w_m2": 350.0,
                "diffuse_horizontal_w_m2": 280.0,
            },
        ),
        "Clear": Preset("CIE's standard clear sky", {"distribution": "cie-12"}),
    }
    distribution: Annotated[
        Kind,
        setting(
            "How light is spread: by Perez's all-weather sky, one of the fifteen general skies of "
            "CIE (1 overcast, 5 uniform, 12 clear), or CIE's traditional overcast sky.",
            source="Perez 1993; CIE S 011",
            choice_labels=_SKIES,
        ),
    ] = "perez"
    direct_normal_w_m2: Annotated[
        float | None,
        setting("Direct sun on a plane that faces it." + _OPEN + " a clear sky's.", 0, 1400,
                unit="W/m²", label="Sun, facing it"),
    ] = None  # fmt: skip
    diffuse_horizontal_w_m2: Annotated[
        float | None,
        setting("Light of the sky on level ground." + _OPEN + " a clear sky's.", 0, 1000,
                unit="W/m²", label="Sky, level ground"),
    ] = None  # fmt: skip
    dew_point_deg_c: Annotated[
        float | None,
        setting("Of the air at the ground: water vapour changes how many lumens a watt is."
                + _OPEN + " 11.", -70, 40, unit="°C", source="Perez 1990"),
    ] = None  # fmt: skip
    albedo: Annotated[
        float | None,
        setting("Share of light that a grey ground of this sky alone reflects. None: the place's "
                "ground.", 0, 1),
    ] = None  # fmt: skip
