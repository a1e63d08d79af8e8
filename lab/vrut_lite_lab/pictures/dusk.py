"""Draw docs/pictures/bruneton_dusk.webp: the western sky under aerosol of the stratosphere.

python -m vrut_lite_lab.pictures.dusk [OUTPUT]
"""

import sys

import numpy as np
from bruneton_sky import solve
from bruneton_sky.settings import BrunetonSkySettings, atmosphere_of

from vrut_lite.messages.haze import SetHaze
from vrut_lite.pictures.display import display_picture
from vrut_lite.pictures.exposure import automatic_ev100
from vrut_lite_lab.checkout import ROOT
from vrut_lite_lab.pictures.drawing import Captioned, sheet

OUTPUT = ROOT / "docs" / "pictures" / "bruneton_dusk.webp"
# Suns below the horizon in degrees; depths of the stratosphere; of the troposphere.
_SUNS_DEG, _DEPTHS, _BELOW = (1, 2, 3, 4, 5, 6), (0.0, 0.005, 0.02), 0.095
_ELEVATIONS_DEG = np.linspace(45.0, 0.5, 90)
_AZIMUTHS_DEG = np.linspace(-60.0, 60.0, 120)


def pictures() -> list[Captioned]:
    """A row for each depth; the suns have the exposure of their sky without the layer."""
    drawn: list[Captioned] = []
    elevation, azimuth = np.radians(_ELEVATIONS_DEG)[:, None], np.radians(_AZIMUTHS_DEG)
    exposures: dict[int, float] = {}
    for depth in _DEPTHS:
        haze = SetHaze(optical_depth_550=_BELOW + depth, stratosphere_depth_550=depth)
        sky = solve(atmosphere_of(BrunetonSkySettings(), 0.0, haze))
        for sun_deg in _SUNS_DEG:
            sun = -np.radians(sun_deg)
            mu = np.broadcast_to(np.sin(elevation), (elevation.size, azimuth.size))
            nu = mu * np.sin(sun) + np.cos(elevation) * np.cos(sun) * np.cos(azimuth)
            light = np.maximum(sky.radiance_rgb(0.0, mu, np.sin(sun), nu), 0.0).astype(np.float32)
            ev100 = exposures.setdefault(sun_deg, automatic_ev100(light))
            caption = f"{depth:g}, sun {-sun_deg} deg"
            drawn.append((caption, display_picture(light, ev100)))
    return drawn


def main() -> None:
    """Draw the sheet."""
    output = sys.argv[1] if len(sys.argv) > 1 else OUTPUT
    sheet(pictures(), len(_SUNS_DEG), (240, 180)).save(output, quality=88)


if __name__ == "__main__":
    main()
