"""The radiance of the sky, looked up for any observer from the ground to space."""

from typing import TYPE_CHECKING

import numpy as np

from bruneton_sky.phase import mie_phase, rayleigh_phase
from bruneton_sky.tables.coordinates import State, parametrisation_of
from bruneton_sky.tables.interpolate import interpolate
from bruneton_sky.tables.look_up_transmittance import (
    transmittance_between,
    transmittance_to_top,
)
from bruneton_sky.tables.observer import View
from bruneton_sky.tables.travel import moved
from vrut_lite.numeric_types import FloatArray

if TYPE_CHECKING:
    from bruneton_sky.tables.tables import Tables


def sky_radiance(
    tables: "Tables", view: View, shadow_length_m: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Radiance (..., C) of the air along whole rays, and transmittance (..., C) to space.

    The transmittance is 0 where the ground is in the way. With a shadow length, the first so
    many metres of the ray inside the air give no light (Bruneton and Neyret 2008, equation 17).
    """
    air, state = tables.atmosphere, view.state
    beyond = moved(air, state, shadow_length_m)
    dimmed = transmittance_between(
        air,
        tables.transmittance,
        state.altitude_m,
        state.mu,
        shadow_length_m,
        state.hits_ground,
    )
    dimmed = np.where(np.asarray(shadow_length_m)[..., None] > 0, dimmed, 1.0)
    radiance = with_phases(tables, state.nu, *(dimmed * part for part in scattered(tables, beyond)))
    clear = transmittance_to_top(air, tables.transmittance, state.altitude_m, state.mu)
    clear = np.where(state.hits_ground[..., None], 0.0, clear)
    misses = view.misses[..., None]
    return np.where(misses, 0.0, radiance), np.where(misses, 1.0, clear)


def scattered(tables: "Tables", state: State) -> tuple[FloatArray, FloatArray]:
    """What both scattering tables hold (..., C) for states, without phase functions."""
    parametrisation = parametrisation_of(tables.parametrisation)
    at = parametrisation.to_coordinates(tables.atmosphere, tables.sizes, state)
    return interpolate(tables.scattering, at), interpolate(tables.single_mie, at)


def with_phases(
    tables: "Tables", nu: FloatArray, scattering: FloatArray, single_mie: FloatArray
) -> FloatArray:
    """Radiance (..., C) of values from both scattering tables."""
    cosine = nu[..., None]
    return scattering * rayleigh_phase(cosine) + single_mie * mie_phase(tables.atmosphere, cosine)
