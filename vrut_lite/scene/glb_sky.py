"""A sky in a glTF document: OMI_environment_sky with a panorama, and the sun as a lamp.

OMI_environment_sky (omigroup/gltf-extensions) puts +Z in the middle of an equirectangular texture,
+X in the middle of its left half and +Y at the top. It names no unit: the sky's `extras` state the
luminance of the texel value 1. The sun is not in the panorama; it is a directional light of
KHR_lights_punctual in lux.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vrut_lite.geometry.colour import LUMENS_PER_WATT, luminance, srgb_encode
from vrut_lite.geometry.panorama import lat_long_directions, sample_sky
from vrut_lite.messages.sun import KeyLightChanged
from vrut_lite.numeric_types import FloatArray
from vrut_lite.pictures.write_png import png16
from vrut_lite.scene.glb_document import GlbDocument

_NAME = "OMI_environment_sky"
_CLAMP, _REPEAT, _LINEAR = 33071, 10497, 9729
_MOST = 65535.0


@dataclass(frozen=True, eq=False)
class GlbSky:
    """The light of a sky in world axes.

    Attributes:
        cube: (6, n, n, 3), linear sRGB radiance, W m^-2 sr^-1, without the sun.
        height_px: rows of the panorama that is made of it.
        key_light: the sun or the moon.
        facts: what else is said in the sky's extras, by name.
    """

    cube: NDArray[np.floating]
    height_px: int
    key_light: KeyLightChanged
    facts: dict[str, str | float]


def add_sky(document: GlbDocument, sky: GlbSky) -> None:
    """Add the panorama, and the light if it shines."""
    pixels, cd_m2_per_unit = _panorama(sky)
    sampler = {
        "wrapS": _REPEAT, "wrapT": _CLAMP, "magFilter": _LINEAR, "minFilter": _LINEAR,
    }  # fmt: skip
    texture = {
        "name": "sky",
        "source": document.png(png16(pixels)),
        "sampler": document.add("samplers", sampler),
    }
    document.extend(
        _NAME,
        {
            "skies": [
                {
                    "type": "panorama",
                    "panorama": {"equirectangular": document.add("textures", texture)},
                    # Its schema and its page disagree on the default.
                    "ambientSkyContribution": 1.0,
                    "extras": {"cd_m2_per_unit": cd_m2_per_unit, **sky.facts},
                }
            ]
        },
    )
    document.extend_scene(_NAME, {"sky": 0})
    strongest = max(sky.key_light.irradiance_rgb)
    if strongest > 0.0:
        document.root(
            {
                "name": sky.key_light.body,
                "rotation": turned_towards(-np.array(sky.key_light.direction)),
                "extensions": document.light(_light_of(sky.key_light)),
            }
        )


def _light_of(key_light: KeyLightChanged) -> dict[str, Any]:
    """The directional light of KHR_lights_punctual: lux on a plane that faces it.

    Its colour is the share of each channel in the strongest, whose lux the intensity is; the
    illuminance stands in the extras.
    """
    irradiance = np.array(key_light.irradiance_rgb)
    strongest = float(irradiance.max())
    return {
        "type": "directional",
        "name": key_light.body,
        "intensity": LUMENS_PER_WATT * strongest,
        "color": (irradiance / strongest).tolist(),
        "extras": {"illuminance_lx": LUMENS_PER_WATT * float(luminance(irradiance))},
    }


def turned_towards(direction: FloatArray) -> list[float]:
    """The quaternion (x, y, z, w) that turns -Z to a unit vector (3,) by the shortest way."""
    forward = np.array([0.0, 0.0, -1.0])
    axis, cosine = np.cross(forward, direction), float(forward @ direction)
    if cosine < -1.0 + 1e-12:
        return [0.0, 1.0, 0.0, 0.0]
    quaternion = np.array([*axis, 1.0 + cosine])
    return [float(part) for part in quaternion / np.linalg.norm(quaternion)]


def _panorama(sky: GlbSky) -> tuple[NDArray[np.uint16], float]:
    """Texels (h, 2 h, 3), sRGB-encoded in 16 bits, and the luminance of the value 1, cd/m^2.

    The brightest channel is 1, so that nothing is clipped.
    """
    # Azimuth 180 degrees, which is +Z, in the middle.
    directions = lat_long_directions(sky.height_px, np.pi)
    radiance = np.maximum(sample_sky(sky.cube, directions), 0.0)
    most = float(radiance.max()) or 1.0
    pixels = np.rint(srgb_encode(radiance / most) * _MOST).astype(np.uint16)
    return pixels, LUMENS_PER_WATT * most
