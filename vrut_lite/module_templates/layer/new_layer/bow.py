"""Radiance of a rainbow: the message, and the float64 twin of rainbow.frag.

Drops scatter sunlight once, by geometrical optics: rays of all impact parameters are refracted into
a sphere of water, reflected once (first bow) or twice (second bow) and refracted out again, with
Fresnel's losses. Diffraction, which pales the colours of drops below a millimetre, is left out.
"""

from functools import cache
from typing import ClassVar

import numpy as np
from vrut_lite import checks
from vrut_lite.geometry.colour import rgb_from_spectrum, solar_irradiance
from vrut_lite.kernel.messages import Derived
from vrut_lite.numeric_types import FloatArray, Vector

SLOT = "new_layer"
# The table's bins of the angle from the point opposite the sun: as many as the shader has.
BINS, STEP_DEG = 256, 0.25
# The faint rest of the second bow is faded out between these angles.
_FADE_DEG = 56.0, 64.0
_SUN_RADIUS_DEG = 0.267
_NM = np.linspace(400.0, 700.0, 61)
_RAYS = 50_000


class RainbowShown(Derived, frozen=True, kw_only=True):
    """A rainbow in the sky.

    Attributes:
        antisolar: unit vector away from the sun, world axes (east +X, up +Y, north -Z).
        light_rgb: irradiance of the sun on the drops, W m^-2, times their cross-section over a unit
            area across the line of sight; 0 without a rainbow.
    """

    slot: ClassVar[str | None] = SLOT

    antisolar: Vector
    light_rgb: Vector

    def check(self) -> None:
        """A direction, and light."""
        checks.direction(self, "antisolar")
        checks.light(self, "light_rgb", 1e6)


def radiance(shown: RainbowShown, direction: FloatArray) -> FloatArray:
    """Linear sRGB radiance (..., 3) along unit vectors (..., 3), W m^-2 sr^-1; none downwards."""
    cosine = np.clip(direction @ np.array(shown.antisolar), -1.0, 1.0)
    place = np.degrees(np.arccos(cosine)) / STEP_DEG - 0.5
    bins = np.arange(BINS)
    channels = [np.interp(place, bins, channel, right=0.0) for channel in phase_rgb().T]
    above = direction[..., 1:2] > 0.0
    return np.where(above, np.array(shown.light_rgb) * np.stack(channels, axis=-1), 0.0)


@cache
def phase_rgb() -> FloatArray:
    """Share (BINS, 3) of the light on a drop that it sends into a unit solid angle, sr^-1.

    By channel of linear sRGB, for sunlight, at the middles of the bins; colours outside sRGB are
    clipped.
    """
    spectra = np.stack([_scattered(nm) for nm in _NM], axis=-1) * solar_irradiance(_NM)
    rgb = rgb_from_spectrum(spectra, _NM) / rgb_from_spectrum(solar_irradiance(_NM), _NM)
    middle_deg = (np.arange(BINS) + 0.5) * STEP_DEG
    fade = np.interp(middle_deg, _FADE_DEG, (1.0, 0.0))
    return np.maximum(rgb, 0.0) * fade[:, None]


def refractive_index(nm: float) -> float:
    """Refractive index of water, 400 to 700 nm, within 5e-4 of Hale and Querry (1973)."""
    return 1.3252 + 2490.0 / nm**2


def _scattered(nm: float) -> FloatArray:
    """Share (BINS,) per sr of both bows at one wavelength, behind the sun's disc."""
    impact = (np.arange(_RAYS) + 0.5) / _RAYS
    inside, index = np.arcsin(impact), refractive_index(nm)
    water = np.arcsin(impact / index)
    edges_deg = np.arange(BINS + 1) * STEP_DEG
    power = np.zeros(BINS)
    for reflections in (1, 2):
        turned = 2.0 * (inside - water) + reflections * (np.pi - 2.0 * water)
        # The angle from the antisolar point, whichever way round.
        away_deg = np.degrees(np.arccos(np.clip(-np.cos(turned), -1.0, 1.0)))
        mean = np.zeros(_RAYS)
        for reflected in _fresnel(inside, water, index):
            mean += 0.5 * (1.0 - reflected) ** 2 * reflected**reflections
        weights = 2.0 * impact / _RAYS * mean
        power += np.histogram(away_deg, edges_deg, weights=weights)[0]
    cap = 2.0 * np.pi * -np.diff(np.cos(np.radians(edges_deg)))
    return _behind_disc(power / cap)


def _fresnel(
    outside: FloatArray, inside: FloatArray, index: float
) -> tuple[FloatArray, FloatArray]:
    """Reflectances across and along the plane of incidence."""
    a, b = np.cos(outside), index * np.cos(inside)
    c, d = index * np.cos(outside), np.cos(inside)
    return ((a - b) / (a + b)) ** 2, ((c - d) / (c + d)) ** 2


def _behind_disc(share: FloatArray) -> FloatArray:
    """The mean over the sun's disc, by its chords."""
    reach = int(np.ceil(_SUN_RADIUS_DEG / STEP_DEG))
    away = np.arange(-reach, reach + 1) * STEP_DEG / _SUN_RADIUS_DEG
    chord = np.sqrt(np.maximum(1.0 - away**2, 0.02))
    padded = np.pad(share, reach, mode="edge")
    return np.convolve(padded, chord / chord.sum(), mode="valid")
