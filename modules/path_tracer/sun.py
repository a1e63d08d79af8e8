"""The sun as an emitter: its disc, darkened to the limb, or a mere direction.

The disc is a far square that lets all light through and shines where the disc is: the sky
behind it is seen as in the GL frame, and its light counts once.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from vrut_lite.messages.sun import KeyLightChanged

_TEXELS = 128
# The disc and a margin of two texels around it, so that its edge is not cut.
_HALF_SIDE = 1.0 + 4.0 / _TEXELS
# How many times farther than anything it lights: from anywhere it stands in the same direction.
_DISTANCES = 1000.0
_STEPS = 4


def disc_picture(sun: KeyLightChanged) -> NDArray[np.float64] | None:
    """Radiance (n, n, 3) of the square around the disc, row 0 the lowest, W m^-2 sr^-1.

    The part of the disc below the horizon is dark, and the rest has all of the irradiance of
    `KeyLightChanged`. None if nothing of it is above.
    """
    fine = ((np.arange(_TEXELS * _STEPS) + 0.5) / (_TEXELS * _STEPS) * 2.0 - 1.0) * _HALF_SIDE
    across, up = np.meshgrid(fine, fine)
    outside = across**2 + up**2
    cos_psi = np.sqrt(np.maximum(0.0, 1.0 - outside))
    elevation_rad = np.arcsin(np.clip(sun.direction[1], -1.0, 1.0)) + up * sun.angular_radius_rad
    seen = (outside <= 1.0) & (elevation_rad >= 0.0)
    if not seen.any():
        return None
    texel_sr = (2.0 * _HALF_SIDE * np.tan(sun.angular_radius_rad) / _TEXELS) ** 2
    picture = np.empty((_TEXELS, _TEXELS, 3))
    for channel, polynomial in enumerate(sun.limb_darkening_rgb):
        shape = np.polynomial.polynomial.polyval(cos_psi, polynomial)
        shape = np.where(seen, np.maximum(shape, 0.0), 0.0)
        means = shape.reshape(_TEXELS, _STEPS, _TEXELS, _STEPS).mean(axis=(1, 3))
        picture[..., channel] = means * sun.irradiance_rgb[channel] / (means.sum() * texel_sr)
    return picture


def sun_emitter(
    mitsuba: Any, sun: KeyLightChanged, as_disc: bool, reach_units: float
) -> tuple[dict[str, Any], float]:
    """The sun, which must shine, as a dictionary of mitsuba, and how far it is.

    A disc below the horizon is not seen, as in the GL frame; what light there is of it has a
    direction only.
    """
    picture = disc_picture(sun) if as_disc else None
    if picture is None:
        irradiance = {"type": "rgb", "value": list(sun.irradiance_rgb)}
        towards = [-float(value) for value in sun.direction]
        return {"type": "directional", "direction": towards, "irradiance": irradiance}, reach_units
    distance = _DISTANCES * reach_units
    place = distance * np.asarray(sun.direction, dtype=float)
    half_side = distance * float(np.tan(sun.angular_radius_rad)) * _HALF_SIDE
    upright = [0.0, 1.0, 0.0] if abs(sun.direction[1]) < 0.999 else [0.0, 0.0, -1.0]
    matrix = mitsuba.ScalarTransform4f
    pose = matrix().look_at(list(place), [0.0, 0.0, 0.0], upright) @ matrix().scale(
        [half_side, half_side, 1.0]
    )
    radiance = {
        "type": "bitmap",
        "bitmap": mitsuba.Bitmap(picture.astype(np.float32)),
        "raw": True,
        "wrap_mode": "clamp",
    }
    square = {
        "type": "rectangle",
        "to_world": pose,
        "bsdf": {"type": "null"},
        "emitter": {"type": "area", "radiance": radiance},
    }
    return square, distance
