"""An atmosphere as the bytes of the buffer in shaders/pipeline_air.glsl, four wavelengths each."""

from collections.abc import Iterator

import numpy as np
from numpy.typing import ArrayLike, NDArray

from bruneton_sky.atmosphere import Atmosphere
from bruneton_sky.atmosphere_numbers import SPECTRAL_FIELDS
from bruneton_sky.geometry import distance_to_top
from bruneton_sky.phase import mie_phase_parameters
from bruneton_sky.tables import ray_lengths

LANES = 4


def buffers_of_air(atmosphere: Atmosphere) -> Iterator[bytes]:
    """The contents of a buffer for each four wavelengths; those missing in the last are dark."""
    for first in range(0, len(atmosphere.wavelength_nm), LANES):
        lanes = (
            _lanes(getattr(atmosphere, name)[first : first + LANES]) for name in SPECTRAL_FIELDS
        )
        parts = *lanes, *_scalars(atmosphere), *_absorber(atmosphere)
        yield np.concatenate(parts).astype(np.float32).tobytes()


def _lanes(values: ArrayLike) -> NDArray[np.float64]:
    lanes = np.zeros(LANES)
    given = np.asarray(values, dtype=float)
    lanes[: given.size] = given
    return lanes


def _scalars(air: Atmosphere) -> Iterator[NDArray[np.float64]]:
    yield _lanes(mie_phase_parameters(air))
    top_m = air.top_altitude_m
    shortest, longest = ray_lengths.to_top(air, 0.0)
    lowest_sun = distance_to_top(air.ground_radius_m, top_m, 0.0, air.mu_s_min)
    yield np.array(
        [
            air.rayleigh_scale_height_m,
            air.mie_scale_height_m,
            air.ground_radius_m,
            top_m,
            float(longest),
            air.sun_angular_radius_rad,
            float((lowest_sun - shortest) / (longest - shortest)),
            0.0,  # the nodes after it are aligned to eight bytes
        ]
    )


def _absorber(air: Atmosphere) -> Iterator[NDArray[np.float64]]:
    yield np.column_stack([air.absorber_altitude_m, air.absorber_density]).ravel()
