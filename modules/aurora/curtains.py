"""Radiance of auroral curtains: the float64 twin of aurora.frag.

Curtains are sheets along magnetic parallels, folded by waves and striped by rays, that glow in
three lines with Chapman's profile over altitude. A ray through them is summed by the midpoint rule;
sheets thinner than a step are widened to it at equal light.
"""

from typing import ClassVar

import numpy as np

from vrut_lite import checks
from vrut_lite.atmosphere.planet import EARTH_RADIUS_M
from vrut_lite.geometry.colour import SRGB_FROM_XYZ, colour_table, luminance
from vrut_lite.kernel.messages import Derived
from vrut_lite.numeric_types import FloatArray, Vector

SLOT = "aurora"
RADIUS_KM, LOW_KM, HIGH_KM, STEPS = EARTH_RADIUS_M / 1000.0, 90.0, 400.0, 64
# Lines: wavelength (nm), altitude of the peak and scale height (km), brightness over the green's.
# O 557.7 and 630.0 nm and N2+ 427.8 nm (Chamberlain, Physics of the Aurora and Airglow, 1961).
LINES = ((557.7, 112.0, 16.0, 1.0), (630.0, 240.0, 50.0, 0.3), (427.8, 106.0, 12.0, 0.18))
# Waves of folds and rays: amplitude, wavelength (km), speed eastwards (km/s).
FOLDS = ((25.0, 420.0, 0.9), (9.0, 130.0, -0.6), (3.0, 41.0, 0.4))
RAYS = ((1.0, 67.0, 0.5), (1.0, 190.0, -0.3))
# Sheets: place across the oval as a share of its width, and brightness.
SHEETS = ((0.1, 1.0), (0.45, 0.6), (0.8, 0.35))
THICKNESS_KM, DIFFUSE = 4.0, 0.06
# Energy (J m) of a photon times its wavelength; photons per m^2 and s of 1 kR in all directions.
_PHOTON_J_M, _PHOTONS_PER_KR = 1.98644586e-25, 1e13
# Vertical optical depth of molecules for red, green and blue; the air's scale height.
MOLECULES, SCALE_KM = (0.06, 0.10, 0.20), 8.0


class AuroraShown(Derived, frozen=True, kw_only=True):
    """Curtains over a place.

    Attributes:
        poleward: horizontal unit vector towards the nearer magnetic pole, world axes.
        edge_km, width_km: poleward distance of the oval's equatorward edge; the oval's width.
        lean: horizontal way of a field line, towards the equator, per way up.
        kilorayleigh: zenith brightness of an arc's green line; 0 without an aurora.
        haze: vertical optical depth of the haze.
        phases: of FOLDS and RAYS, rad.
    """

    slot: ClassVar[str | None] = SLOT
    poleward: Vector
    edge_km: float
    width_km: float
    lean: float
    kilorayleigh: float
    haze: float
    phases: tuple[float, ...]
    source: str

    def check(self) -> None:
        """Finite numbers, and a phase for each wave."""
        checks.direction(self, "poleward")
        for name in ("edge_km", "width_km", "lean", "kilorayleigh", "haze"):
            checks.number(self, name, -1e5, 1e5)
        checks.numbers(self, "phases", len(FOLDS) + len(RAYS))
        checks.text(self, "source")


def phases_at(seconds: float) -> tuple[float, ...]:
    """Phases of the waves at a time, 0 to 2 pi."""
    turns = [v * seconds / length + 0.37 * k for k, (_, length, v) in enumerate(FOLDS + RAYS)]
    return tuple(float(2.0 * np.pi * (turn % 1.0)) for turn in turns)


def line_colours() -> FloatArray:
    """Linear sRGB radiance (3 lines, 3) of 1 kR, W m^-2 sr^-1, of the lines' luminance.

    Lines lie outside sRGB: components below 0 are set to 0.
    """
    table, rgb = colour_table(), []
    for nm, _, _, share in LINES:
        power = _PHOTONS_PER_KR / (4.0 * np.pi) * _PHOTON_J_M / (nm * 1e-9)
        xyz = np.array([np.interp(nm, table[:, 0], table[:, k]) for k in (1, 2, 3)])
        inside = np.maximum(SRGB_FROM_XYZ @ xyz, 0.0)
        rgb.append(share * power * inside * xyz[1] / luminance(inside))
    return np.array(rgb)


def radiance(shown: AuroraShown, direction: FloatArray, eye_km: float) -> FloatArray:
    """Linear sRGB radiance (..., 3) along unit vectors (..., 3), world axes, W m^-2 sr^-1."""
    d = np.asarray(direction, dtype=float)
    mu, r = d[..., 1], RADIUS_KM + eye_km
    north, east = d @ np.asarray(shown.poleward), d @ np.cross(shown.poleward, [0.0, 1.0, 0.0])
    start, end = _through_shell(mu, r)
    step = np.maximum(end - start, 0.0) / STEPS
    lines, colours, total = np.array(LINES), line_colours(), np.zeros((*mu.shape, 3))
    for k in range(STEPS):
        t = start + (k + 0.5) * step
        away = np.sqrt(r * r + 2.0 * r * mu * t + t * t)
        # The difference of squares keeps its digits near the ground.
        square = eye_km * (2.0 * RADIUS_KM + eye_km) + 2.0 * r * mu * t + t * t
        altitude = square / (away + RADIUS_KM)
        y = RADIUS_KM * np.arctan2(t * north, r + t * mu) + shown.lean * (altitude - LINES[0][1])
        x = RADIUS_KM * np.arctan2(t * east, r + t * mu)
        u = (altitude[..., None] - lines[:, 1]) / lines[:, 2]
        glow = np.exp(-u - np.exp(-u)) / lines[:, 2]
        bright = _density(shown, x, y, step * east, step * (north + shown.lean * mu)) * step
        total += bright[..., None] * (glow @ colours)
    sine = np.clip(mu, 0.0, 1.0)
    # Kasten and Young 1989.
    mass = 1.0 / (sine + 0.50572 * (np.degrees(np.arcsin(sine)) + 6.07995) ** -1.6364)
    depth = (np.array(MOLECULES) + shown.haze) * np.exp(-eye_km / SCALE_KM)
    return np.asarray(shown.kilorayleigh * total * np.exp(-mass[..., None] * depth))


def _through_shell(mu: FloatArray, r: float) -> tuple[FloatArray, FloatArray]:
    """Distances (km) where a ray enters and leaves the shell; none where the ground hides it."""
    high, low = (np.square(mu * r) + (RADIUS_KM + h) ** 2 - r * r for h in (HIGH_KM, LOW_KM))
    far, below = -r * mu + np.sqrt(np.maximum(high, 0.0)), np.sqrt(np.maximum(low, 0.0))
    if r < RADIUS_KM + LOW_KM:
        return -r * mu + below, np.where(mu > 0.0, far, 0.0)
    near = np.maximum(-r * mu - np.sqrt(np.maximum(high, 0.0)), 0.0)
    end = np.where((low > 0.0) & (mu < 0.0), -r * mu - below, far)
    return near, np.where(high > 0.0, end, near)


def _density(
    shown: AuroraShown, x: FloatArray, y: FloatArray, dx: FloatArray, dy: FloatArray
) -> FloatArray:
    """Brightness over an arc's at places and for steps east and poleward (km)."""
    p, turn = shown.phases, 2.0 * np.pi
    inside = (y - shown.edge_km) / shown.width_km - 0.5
    whole = DIFFUSE * np.exp(-np.square(inside / 0.45))
    for number, (place, bright) in enumerate(SHEETS):
        fold, across = np.zeros_like(x), dy
        for k, (amplitude, length, _) in enumerate(FOLDS):
            phase = turn * x / length + p[k] + 1.7 * number * (k + 1)
            fold += amplitude * np.sin(phase)
            across = across - amplitude * turn / length * np.cos(phase) * dx
        width = np.hypot(THICKNESS_KM, 0.8 * across)
        slow = np.sin(turn * x / RAYS[1][1] + p[4] + number)
        rays = 0.5 + 0.5 * np.sin(turn * x / RAYS[0][1] + p[3] + 2.2 * slow)
        away = (y - shown.edge_km - place * shown.width_km - fold) / width
        sheet = np.exp(-away * away) * THICKNESS_KM / width
        whole = whole + bright * sheet * (0.2 + 0.8 * rays * rays)
    return whole
