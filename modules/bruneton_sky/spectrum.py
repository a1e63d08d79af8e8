"""The sky's spectrum in a direction.

Skies are solved at four wavelengths; a spectrum needs more, which takes about a second. The last
two atmospheres' solutions are cached: only the first direction waits for one.
"""

from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from bruneton_sky.atmosphere import Atmosphere
from bruneton_sky.ground_light import ground_radiance
from bruneton_sky.solved_sky import SolvedSky
from bruneton_sky.solver_job import solve_air
from bruneton_sky.sun_light import sun_irradiance
from vrut_lite.geometry.cube_map import texel_directions
from vrut_lite.kernel.job import JobControl
from vrut_lite.numeric_types import Vector
from vrut_lite.sky.sky_of_hour import SkySpectra

# From violet to red; three groups of four, as the solver takes them.
SPECTRUM_NM = tuple(np.linspace(390.0, 720.0, 12).tolist())


class SkySpectrum(NamedTuple):
    """Radiance (12,) at `SPECTRUM_NM` in a direction, W m^-2 sr^-1 nm^-1."""

    direction: Vector
    radiance: NDArray[np.float64]


def sky_spectrum(
    atmosphere: Atmosphere,
    orders: int,
    altitude_m: float,
    direction: Vector,
    sun_direction: Vector,
    control: JobControl | None = None,
) -> SkySpectrum:
    """The spectral radiance of the sky above the horizon, without the sun's disc.

    The atmosphere has the wavelengths `SPECTRUM_NM`. Directions are unit vectors in world axes.
    """
    cosines = direction[1], sun_direction[1], float(np.dot(direction, sun_direction))
    sky = _solved(atmosphere, orders)
    return SkySpectrum(direction, sky.radiance(max(altitude_m, 0.0), *np.clip(cosines, -1.0, 1.0)))


def sky_spectra(
    atmosphere: Atmosphere,
    orders: int,
    sun_direction: Vector,
    visible_disc_fraction: float,
    size: int,
) -> SkySpectra:
    """Spectra of sky, sun and ground for an observer on the ground, at the air's wavelengths.

    The sky is computed in each texel's middle, on one side of the sun, which the other mirrors.
    """
    sky = _solved(atmosphere, orders)
    directions = texel_directions(size)
    above = directions[..., 1] > 0.0
    mu, nu = directions[above][:, 1], directions[above] @ np.asarray(sun_direction)
    # Texels on either side of the sun have the same angles.
    angles, which = np.unique(np.round(np.stack([mu, nu]), 9), axis=1, return_inverse=True)
    mu_s = float(sun_direction[1])
    cube = np.zeros((*above.shape, len(atmosphere.wavelength_nm)), np.float32)
    cube[above] = sky.radiance(0.0, angles[0], mu_s, np.clip(angles[1], -1.0, 1.0))[which.ravel()]
    sun = sun_irradiance(atmosphere, 0.0, mu_s) * visible_disc_fraction
    ground = ground_radiance(sky.field, mu_s)
    albedo = np.asarray(atmosphere.ground_albedo)
    return SkySpectra(np.maximum(cube, 0.0), sun, ground.sun + ground.sky, albedo)


@lru_cache(maxsize=2)
def _solved(atmosphere: Atmosphere, orders: int) -> SolvedSky:
    return SolvedSky(field=solve_air(atmosphere, orders))
