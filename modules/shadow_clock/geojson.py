"""Lines and places on Earth as GeoJSON (RFC 7946): longitude first, cut at the date line."""

from typing import Any

import numpy as np

from shadow_clock.places import EarthLine, ShadowPlace

# A hundred-thousandth of a degree is a metre.
_DECIMALS = 5


def line_feature(line: EarthLine, **properties: object) -> dict[str, Any]:
    """A line as a MultiLineString that nowhere crosses the date line."""
    geometry = {"type": "MultiLineString", "coordinates": _parts(line)}
    return {"type": "Feature", "geometry": geometry, "properties": properties}


def place_feature(place: ShadowPlace, **properties: object) -> dict[str, Any]:
    """A place as a Point with its error."""
    at = [round(place.longitude_deg, _DECIMALS), round(place.latitude_deg, _DECIMALS)]
    said = {
        "error_km": round(place.error_km, 1), "shadow_bearing_deg": round(place.bearing_deg, 3),
    }  # fmt: skip
    return {
        "type": "Feature",
        "geometry": {"type": "Point", "coordinates": at},
        "properties": {**properties, **said},
    }


def collection(features: list[dict[str, Any]]) -> dict[str, Any]:
    """The whole document."""
    return {"type": "FeatureCollection", "features": features}


def _parts(line: EarthLine) -> list[list[list[float]]]:
    latitude, longitude = line
    parts: list[list[list[float]]] = [[]]
    for number in range(len(latitude)):
        here = float(longitude[number]), float(latitude[number])
        if number:
            before = float(longitude[number - 1]), float(latitude[number - 1])
            step = here[0] - before[0]
            if abs(step) > 180.0:
                side = float(np.sign(before[0]))
                beyond = here[0] + 360.0 * side
                share = (180.0 * side - before[0]) / (beyond - before[0])
                at = before[1] + share * (here[1] - before[1])
                parts[-1].append(_rounded(180.0 * side, at))
                parts.append([_rounded(-180.0 * side, at)])
        parts[-1].append(_rounded(*here))
    return [part for part in parts if len(part) > 1]


def _rounded(longitude: float, latitude: float) -> list[float]:
    return [round(longitude, _DECIMALS), round(latitude, _DECIMALS)]
