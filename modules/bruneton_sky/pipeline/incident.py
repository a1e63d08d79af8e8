"""Light of one order of scattering, as tables and the phase functions they lack."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from bruneton_sky.atmosphere import Atmosphere
from bruneton_sky.phase import mie_phase, rayleigh_phase
from bruneton_sky.pipeline.setting import Setting
from bruneton_sky.tables.parametrisations import State
from vrut_lite.numeric_types import FloatArray

Phase = Callable[[ArrayLike], FloatArray]


class Part(NamedTuple):
    """A table (altitude, mu, nu, mu_s, C) of radiance over a phase function."""

    table: FloatArray
    phase: Phase


def light_scattered_once(
    air: Atmosphere, rayleigh: FloatArray, mie: FloatArray
) -> tuple[Part, ...]:
    """Its two tables lack different phase functions."""
    return Part(rayleigh, rayleigh_phase), Part(mie, lambda nu: mie_phase(air, nu))


def light_scattered_often(radiance: FloatArray) -> tuple[Part, ...]:
    """Its table lacks none."""
    return (Part(radiance, np.ones_like),)


def radiance(setting: Setting, light: tuple[Part, ...], state: State) -> FloatArray:
    """Radiance (..., C) of light at states."""
    parts = (setting.look_up(part.table, state) * part.phase(state.nu)[..., None] for part in light)
    return sum(parts, start=np.zeros(1))
