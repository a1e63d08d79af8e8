"""A map of the world with the line of a shadow, its band and its places."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw

from shadow_clock.places import EarthLine, ShadowCircle, ShadowPlace
from vrut_lite.geometry.world_outline import world_outline

_SIZE = (1440, 720)
# Drawn larger and averaged: smooth lines.
_FINER = 2
_SEA, _LAND, _COAST, _GRID = (23, 25, 29), (58, 61, 63), (80, 84, 86), (38, 41, 46)
_BAND, _FIT, _LINE, _PLACE = (116, 96, 44), (214, 150, 40), (255, 214, 120), (255, 80, 60)
_GRID_DEG, _SPOT_PX = 30, 5


def map_picture(
    circle: ShadowCircle, line: EarthLine, places: list[ShadowPlace]
) -> NDArray[np.uint8]:
    """An equirectangular map (720, 1440, 3), north up: band and line of the ratio, a dot a place.

    The band is brighter where the bearing fits too.
    """
    width, height = (_FINER * side for side in _SIZE)
    picture = Image.new("RGB", (width, height), _SEA)
    draw = ImageDraw.Draw(picture)
    for degrees in range(_GRID_DEG, 360, _GRID_DEG):
        x, y = width * degrees // 360, height * degrees // 180
        draw.line([(x, 0), (x, height)], _GRID, _FINER)
        draw.line([(0, y), (width, y)], _GRID, _FINER)
    for ring in world_outline():
        draw.polygon([_pixel(*at) for at in ring.tolist()], _LAND, _COAST)
    tinted = _with_band(np.asarray(picture), circle)
    picture = Image.fromarray(tinted)
    draw = ImageDraw.Draw(picture)
    points = [_pixel(lon, lat) for lat, lon in zip(*line, strict=True)]
    for start, end in pairwise(points):
        if abs(start[0] - end[0]) < 0.5 * width:
            draw.line([start, end], _LINE, _FINER)
    for place in places:
        draw.circle(
            _pixel(place.longitude_deg, place.latitude_deg), _SPOT_PX * _FINER, _PLACE, _SEA
        )
    return np.asarray(picture.resize(_SIZE, Image.Resampling.BOX))


def _with_band(picture: NDArray[np.uint8], circle: ShadowCircle) -> NDArray[np.uint8]:
    """The picture, half of it the band's colour where places fit."""
    width, height = _SIZE
    longitude = (np.arange(width) + 0.5) / width * 360.0 - 180.0
    latitude = 90.0 - (np.arange(height) + 0.5) / height * 180.0
    grid = np.meshgrid(latitude, longitude, indexing="ij")
    shadow = circle.shadow
    tinted = picture.astype(float)
    by_ratio = circle.with_shadow(replace(shadow, bearing_deg=None))
    bands = [(by_ratio, _BAND)]
    if shadow.bearing_deg is not None:
        bands.append((circle, _FIT))
    for one, colour in bands:
        fits = (one.misfit(*grid) <= 1.0).repeat(_FINER, 0).repeat(_FINER, 1)
        tinted[fits] = 0.5 * tinted[fits] + 0.5 * np.array(colour)
    return tinted.astype(np.uint8)


def _pixel(longitude: float, latitude: float) -> tuple[float, float]:
    width, height = (_FINER * side for side in _SIZE)
    return (longitude + 180.0) / 360.0 * width, (90.0 - latitude) / 180.0 * height
