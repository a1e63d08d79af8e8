"""The sky's polarisation as a fisheye: its degree in false colours, and bars along the vibration.
No Qt here."""

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray
from PIL import Image, ImageDraw, ImageFont

from vrut_lite.array import Array
from vrut_lite.geometry.colour import luminance
from vrut_lite.geometry.encoding import decode_float16
from vrut_lite.geometry.false_colours import UNUSED, colours_at
from vrut_lite.geometry.frames import direction_from_angles, world_from_enu
from vrut_lite.geometry.panorama import fisheye_directions, sample_sky
from vrut_lite.geometry.polarisation import (
    NeutralPoints,
    degree_and_angle,
    map_axis,
    neutral_points,
    turned,
    vertical_axis,
)
from vrut_lite.geometry.sky_map import FisheyeMap
from vrut_lite.messages.sky_light import SkyLightChanged
from vrut_lite.messages.sun import SunMoved
from vrut_lite.numeric_types import FloatArray, Vector

# Edge of the picture in pixels; bars are drawn larger by a factor and reduced, for smooth edges.
SIZE_PX, _FINER = 400, 3
_BARS_ACROSS = 21
# Length of the longest bar in their distance, their width and the marks' radius in pixels.
_LONGEST, _BAR_PX, _MARK_PX = 0.85, 1.5, 6.0
# Share of the radius at which the letters of the compass stand.
_LETTERS_AT, _LETTER_PX = 0.94, 15
_BAR, _MARK, _SUN = (255, 255, 255), (255, 120, 90), (255, 240, 170)
# Step along the vibration that turns it into a direction in the picture (rad).
_STEP_RAD = 1e-4
_ALONG_DEG = np.arange(1.0, 180.0)
# Elevation of the sun (degrees) below which a moon that is up lights the sky as much.
_MOON_FROM_DEG = -9.0


class PolarisationPicture(NamedTuple):
    """The picture (size, size, 3) in sRGB, north at the top and east on the left; the degree of its
    brightest colour, at the zenith, and the neutral points. The darkest colour is a degree of 0."""

    pixels: NDArray[np.uint8]
    largest: float
    zenith: float
    neutral: NeutralPoints


def polarisation_picture(
    light: SkyLightChanged, sun: SunMoved, north_offset_rad: float
) -> PolarisationPicture:
    """The degree is that of luminance; a ring marks each neutral point, a disc the sun or moon.

    Args:
        light: with polarisation, and a background whose cube is an `Array`.
        sun: of the same hour.
        north_offset_rad: as in `SetPlace`.
    """
    sky = FisheyeMap(SIZE_PX, north_offset_rad)
    directions, inside = fisheye_directions(SIZE_PX, north_offset_rad)
    degree = np.where(inside, degree_and_vibration(light, directions)[0], 0.0)
    largest = max(float(degree.max()), 1e-6)
    pixels = np.where(inside[..., None], colours_at(degree / largest), UNUSED).astype(np.uint8)
    edge = SIZE_PX * _FINER
    picture = Image.fromarray(pixels).resize((edge, edge), Image.Resampling.BICUBIC)
    draw = ImageDraw.Draw(picture)
    for start, end in _bars(light, sky, largest):
        draw.line([*start, *end], _BAR, round(_FINER * _BAR_PX))
    by_moon = light.key_light.body == "moon" and sun.elevation_rad < np.radians(_MOON_FROM_DEG)
    body = light.key_light.direction if by_moon else sun.direction
    sun_deg, points = _neutral_points(light, body)
    for place, colour, filled in (
        (sun_deg, _SUN, True),
        (sun_deg + points.babinet, _MARK, False),
        (sun_deg - points.brewster, _MARK, False),
        (180.0 + sun_deg - points.arago, _MARK, False),
    ):
        if 0.0 < place < 180.0:
            centre = _pixels(sky, _on_vertical(body, place))
            fill = colour if filled else None
            draw.circle(centre.tolist(), _FINER * _MARK_PX, fill, colour, 2 * _FINER)
    font = ImageFont.load_default(_LETTER_PX * _FINER)
    for letter, azimuth in zip("NESW", np.arange(4) * 0.5 * np.pi, strict=True):
        enu = direction_from_angles(azimuth, 0.5 * np.pi * (1.0 - _LETTERS_AT))
        at = _pixels(sky, world_from_enu(enu, north_offset_rad))
        draw.text(
            tuple(at.tolist()), letter, _BAR, font, "mm", stroke_width=_FINER, stroke_fill=(0, 0, 0)
        )
    small = np.asarray(picture.resize((SIZE_PX, SIZE_PX), Image.Resampling.BOX))
    zenith = float(degree_and_vibration(light, [0.0, 1.0, 0.0])[0])
    return PolarisationPicture(small, largest, zenith, points)


def degree_and_vibration(
    light: SkyLightChanged, directions: ArrayLike
) -> tuple[FloatArray, FloatArray]:
    """Degree (...,) of polarisation of the luminance, and unit vectors (..., 3) along the vibration
    in world axes, at unit directions (..., 3) above the horizon."""
    d = np.asarray(directions, dtype=float)
    radiance, q, u = _stokes(light, d)
    axis = map_axis(d)
    degree, angle = degree_and_angle(radiance, q, u)
    across = np.cross(axis, d)
    return degree, np.cos(angle)[..., None] * axis + np.sin(angle)[..., None] * across


def _stokes(light: SkyLightChanged, d: FloatArray) -> tuple[FloatArray, ...]:
    """Luminance (...,) of I, Q and U by the sky map's axes."""
    background, found = light.background, light.polarisation
    assert isinstance(background.cube, Array)
    assert found is not None
    assert found.cube is not None
    cube = decode_float16(background.cube.values, background.radiance_scale)
    cubes = (cube, *decode_float16(found.cube.values, found.radiance_scale))
    return tuple(luminance(sample_sky(cube, d)) for cube in cubes)


def _neutral_points(light: SkyLightChanged, body: Vector) -> tuple[float, NeutralPoints]:
    """Elevation of sun or moon in degrees, and the neutral points along its vertical."""
    sun_deg = float(np.degrees(np.arcsin(np.clip(body[1], -1.0, 1.0))))
    d = _on_vertical(body, _ALONG_DEG)
    _, q, u = _stokes(light, d)
    vertical, _ = turned(q[..., None], u[..., None], d, map_axis(d), vertical_axis(d))
    return sun_deg, neutral_points(_ALONG_DEG, vertical[..., 0], sun_deg)


def _on_vertical(body: Vector, angle_deg: ArrayLike) -> FloatArray:
    """Directions (..., 3) at angles (...,) from the horizon below a body, over the zenith."""
    heading = np.arctan2(body[2], body[0])
    angle = np.radians(angle_deg)
    level = np.cos(angle)
    return np.stack([level * np.cos(heading), np.sin(angle), level * np.sin(heading)], axis=-1)


def _bars(light: SkyLightChanged, sky: FisheyeMap, largest: float) -> FloatArray:
    """Both ends (n, 2, 2) of the bars in pixels of the larger picture."""
    centres, inside = fisheye_directions(_BARS_ACROSS, sky.north_offset_rad)
    d = centres[inside]
    degree, vibration = degree_and_vibration(light, d)
    middle = _pixels(sky, d)
    ahead = _pixels(sky, np.cos(_STEP_RAD) * d + np.sin(_STEP_RAD) * vibration) - middle
    ahead /= np.maximum(np.hypot(*ahead.T), 1e-12)[:, None]
    reach = 0.5 * _LONGEST * SIZE_PX * _FINER / _BARS_ACROSS
    half = ahead * (reach * degree / largest)[:, None]
    return np.stack([middle - half, middle + half], axis=1)


def _pixels(sky: FisheyeMap, directions: FloatArray) -> FloatArray:
    """Column and row (..., 2) in the larger picture."""
    row, column = sky.position(directions)
    return (np.stack([column, row], axis=-1) + 0.5) * _FINER
