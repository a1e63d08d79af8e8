"""Metadata of picture files: place, time, model, sun, units."""

import math
from collections.abc import Iterable

from vrut_lite import __version__
from vrut_lite.kernel.bus import Kernel
from vrut_lite.messages.haze import haze_of
from vrut_lite.messages.sun import KeyLightChanged, SunMoved
from vrut_lite.messages.tolerance import tolerance_of
from vrut_lite.pictures.image_files import Metadata
from vrut_lite.place_time import local_text
from vrut_lite.project import Project
from vrut_lite.quantities import degrees_text

# Lists of numbers; headers hold them as one text.
_VECTORS = {
    *("sunDirection", "sunIrradianceRgb", "sunDirectionInMap", "sunPixel"),
    "skyHorizontalIrradianceRgb",
}


def picture_metadata(project: Project, kernel: Kernel) -> dict[str, str | float]:
    """Texts and numbers for the header; the kernel must have settled."""
    place, instant = project.where(), project.instant()
    sun, light = kernel.last(SunMoved), kernel.last(KeyLightChanged)
    metadata: dict[str, str | float] = {
        "Software": f"vrut_lite {__version__}",
        "latitudeDeg": place.latitude_deg,
        "longitudeDeg": place.longitude_deg,
        "altitudeM": place.altitude_m,
        "time": local_text(instant, place),
        "utc": instant.isoformat(),
        "tolerance": tolerance_of(kernel),
        "hazeOpticalDepth550": haze_of(kernel).optical_depth_550,
        "aerosol": haze_of(kernel).aerosol,
        "unit": "linear sRGB radiance, W m^-2 sr^-1 (times 683 lm/W: cd m^-2)",
        "northOffsetDeg": project.north_offset_deg,
        "axes": "metres; +Y up, -Z lies northOffsetDeg clockwise of true north",
        "panorama": "latitude-longitude and fisheye are in true north, a cube in these axes",
    }
    if sun is not None:
        metadata["sunElevationDeg"] = math.degrees(sun.elevation_rad)
        metadata["sunAzimuthDeg"] = math.degrees(sun.azimuth_rad)
    if light is not None:
        metadata["skyModel"] = light.source
        metadata["keyLight"] = light.body
        metadata["sunDirection"] = vector_text(light.direction)
        metadata["sunIrradianceRgb"] = vector_text(light.irradiance_rgb)
        settings = kernel.check_module(light.source).settings
        for name in settings.__struct_fields__:
            metadata[f"setting_{name}"] = str(getattr(settings, name))
    return metadata


def hour_text(metadata: Metadata) -> str:
    """The local hour and the sun's height, for captions."""
    height = degrees_text(float(metadata["sunElevationDeg"]))
    return f"{metadata['time']}, sun {height} high"


def vector_text(values: Iterable[float]) -> str:
    """Several numbers as one text."""
    return " ".join(f"{value:.9g}" for value in values)


def json_values(metadata: Metadata) -> dict[str, object]:
    """Metadata for JSON, with lists of numbers."""
    return {
        key: [float(part) for part in str(value).split()] if key in _VECTORS else value
        for key, value in metadata.items()
    }
