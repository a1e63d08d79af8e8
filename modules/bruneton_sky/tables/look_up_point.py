"""The air in front of things: the light it adds between two points, and what it lets pass."""

from typing import TYPE_CHECKING

import numpy as np

from bruneton_sky.tables.look_up_sky import scattered, with_phases
from bruneton_sky.tables.look_up_transmittance import smooth_step, transmittance_between
from bruneton_sky.tables.observer import View
from bruneton_sky.tables.travel import moved, to_edge
from vrut_lite.numeric_types import FloatArray

if TYPE_CHECKING:
    from bruneton_sky.tables.tables import Tables


def radiance_to_point(
    tables: "Tables", view: View, distance_m: FloatArray, shadow_length_m: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Radiance (..., C) that the air adds on the way to points, and its transmittance.

    It is the difference of two whole rays, from the observer and from the point (Bruneton and
    Neyret 2008, equation 17); with a shadow length the last so many metres before the point
    give no light. A point outside the air, or hidden by the ground, counts as one at the
    edge; an observer outside it whose point comes before the air sees nothing of it.

    A difference of interpolated values is at its worst where rays graze the ground. In tables
    of the full sizes light scattered once errs by 1 to 4 % by day, by 15 % over a kilometre
    toward the horizon seen from 1 km up, and by 30 % to the horizon seen from 2 m; where the
    planet's shadow covers the whole segment, some light leaks into it. It is finer tables that
    help: 4 times as many altitudes, nu and mu_s and, for near things toward the horizon, as many
    nodes of the transmittance leave 0.1 to 1.3 % from 2 degrees up, 2 % at 1 degree.
    Bruneton's later remedy, to look up such rays 0.004 in mu above the horizon, is meant for
    textures of low precision, which these are not.
    """
    air, state = tables.atmosphere, view.state
    way = np.clip(distance_m - view.entry_m, 0.0, to_edge(air, state))
    lit = np.maximum(way - shadow_length_m, 0.0)
    ray = (air, tables.transmittance, state.altitude_m, state.mu)
    whole = transmittance_between(*ray, way, state.hits_ground)
    dimmed = transmittance_between(*ray, lit, state.hits_ground)
    near, beyond = scattered(tables, state), scattered(tables, moved(air, state, lit))
    rayleigh, mie = (here - dimmed * there for here, there in zip(near, beyond, strict=True))
    # Bruneton's: after sunset the difference of two aureoles is mostly their errors.
    mie = mie * smooth_step(0.0, 0.01, state.mu_s)[..., None]
    radiance = np.maximum(with_phases(tables, state.nu, rayleigh, mie), 0.0)
    misses = view.misses[..., None]
    return np.where(misses, 0.0, radiance), np.where(misses, 1.0, whole)
