"""The numbers of an atmosphere: which there are, in what form, and within what ranges."""

from collections.abc import Mapping
from typing import Any, Literal, get_args

import numpy as np
from numpy.typing import ArrayLike

from vrut_lite.arguments import as_number, as_numbers, check_choice
from vrut_lite.atmosphere.aerosols import PhaseTable

# Fields of an atmosphere with a number for each wavelength; those of LAYERS may be left out.
SPECTRAL_FIELDS = (
    "solar_irradiance",
    "rayleigh_scattering",
    "mie_scattering",
    "mie_extinction",
    "absorption_extinction",
    "ground_albedo",
)
LAYERS = (
    "aloft_scattering",
    "aloft_extinction",
    "fog_scattering",
    "fog_extinction",
    "stratosphere_scattering",
    "stratosphere_extinction",
    "gas_absorption",
    "pair_absorption",
)
SPECTRAL = (*SPECTRAL_FIELDS, *LAYERS)
SERIES = (
    "wavelength_nm",
    "absorber_altitude_m",
    "absorber_density",
    "rayleigh_above_m",
    "rayleigh_above_scale_height_m",
)
_POSITIVE = (
    "ground_radius_m",
    "top_altitude_m",
    "rayleigh_scale_height_m",
    "mie_scale_height_m",
    "fog_scale_height_m",
    "aloft_scale_height_m",
    "stratosphere_half_width_m",
    "sun_angular_radius_rad",
)
# Accepted lengths: squares of shorter and longer ones lose digits or overflow.
_LENGTHS, LENGTHS_M = _POSITIVE[:7], (1e-3, 1e12)
_AMOUNTS = ("rayleigh_depolarisation", "water_vapour_cm", "refractivity")
_SCALAR = (*_POSITIVE, *_AMOUNTS, "mie_g", "mu_s_min", "stratosphere_peak_m")
_MOST_AMOUNTS = (1.0, 100.0, 0.1)
_TABLES = ("mie_table", "aloft_table", "fog_table", "stratosphere_table")
NO_NUMBERS = ("mie_phase", *_TABLES)
# Scale heights that a layer of molecules may lie over the ground: higher exponentials overflow.
_MOST_SCALE_HEIGHTS = 300.0
MiePhaseForm = Literal["cornette-shanks", "henyey-greenstein"]


def check_numbers(values: Mapping[str, Any]) -> None:
    """An atmosphere's `values` by field: lists that fit, and values in their physical ranges.

    Raises:
        ValueError: they are not; the sentence names the field.
    """
    check_choice("mie_phase of the atmosphere", values["mie_phase"], get_args(MiePhaseForm))
    for name in _TABLES:
        table, rows = values[name], len(values["wavelength_nm"])
        if table is not None:
            _require(isinstance(table, PhaseTable), name, "must be a PhaseTable")
            fits = len(table.values) == rows
            _require(fits, name, f"needs {rows} rows, one per wavelength")
    for name in _SCALAR:
        _require(isinstance(values[name], float), name, "must be a single number")
    for name in _POSITIVE:
        _require(values[name] > 0, name, f"must be positive, not {values[name]}")
    for name in _LENGTHS:
        as_number(f"{name} of the atmosphere", values[name], *LENGTHS_M, "m")
    for name in ("wavelength_nm", *SPECTRAL, "absorber_density"):
        least = min(values[name])
        _require(least >= 0, name, f"must not be negative, but holds {least}")
    steps = np.diff(values["wavelength_nm"])
    ordered = bool(np.all(steps > 0) or np.all(steps < 0))
    _require(ordered, "wavelength_nm", "must increase or decrease throughout")
    _require(min(values["wavelength_nm"]) > 0, "wavelength_nm", "must be positive")
    most = max(values["ground_albedo"])
    _require(most <= 1, "ground_albedo", f"must lie between 0 and 1, but holds {most}")
    above, heights = values["rayleigh_above_m"], values["rayleigh_above_scale_height_m"]
    _require(len(above) == len(heights), "rayleigh_above_m", "needs as many scale heights")
    rising = above == (0.0,) or (above[0] > 0 and bool(np.all(np.diff(above) > 0)))
    _require(rising, "rayleigh_above_m", "must hold rising altitudes above 0")
    for height in heights:
        as_number("rayleigh_above_scale_height_m of the atmosphere", height, *LENGTHS_M, "m")
    least = min(values["rayleigh_scale_height_m"], *heights)
    within = above[-1] < _MOST_SCALE_HEIGHTS * least
    _require(within, "rayleigh_above_m", f"must stay below {_MOST_SCALE_HEIGHTS:g} scale heights")
    _require(-1 < values["mie_g"] < 1, "mie_g", f"must lie between -1 and 1, not {values['mie_g']}")
    for name, most in zip(_AMOUNTS, _MOST_AMOUNTS, strict=True):
        as_number(f"{name} of the atmosphere", values[name], 0.0, most)
    within = -1 <= values["mu_s_min"] < 1
    _require(within, "mu_s_min", f"must be a cosine below 1, not {values['mu_s_min']}")
    for name in ("mie", "aloft", "fog", "stratosphere"):
        scattering = values[f"{name}_scattering"]
        pairs = zip(scattering, values[f"{name}_extinction"], strict=True)
        # Rounding of scattering = albedo * extinction may pass the extinction by one unit.
        bounded = all(s <= e * (1 + 1e-12) for s, e in pairs)
        _require(bounded, f"{name}_scattering", f"must not exceed {name}_extinction")
    heights = values["absorber_altitude_m"]
    rising = len(heights) >= 2 and all(np.diff(heights) > 0) and heights[0] >= 0
    _require(rising, "absorber_altitude_m", "must hold two or more rising altitudes")
    same = len(heights) == len(values["absorber_density"])
    _require(same, "absorber_density", "must have one value per absorber_altitude_m")


def as_tuple(value: float | tuple[float, ...]) -> tuple[float, ...]:
    """A series of one or many numbers."""
    return value if isinstance(value, tuple) else (value,)


def as_series(name: str, value: ArrayLike) -> float | tuple[float, ...]:
    """A float, or a tuple of floats: hashable, so that an atmosphere can key a cache."""
    array = as_numbers(f"{name} of the atmosphere", value)
    _require(array.size > 0, name, "must not be empty")
    return float(array) if array.ndim == 0 else tuple(float(v) for v in array.ravel())


def per_wavelength(name: str, value: float | tuple[float, ...], count: int) -> tuple[float, ...]:
    """So many numbers; a single one is repeated."""
    values = value if isinstance(value, tuple) else (value,) * count
    _require(len(values) == count, name, f"needs {count} values, one per wavelength")
    return values


def _require(holds: bool, name: str, demand: str) -> None:
    if not holds:
        raise ValueError(f"{name} of the atmosphere {demand}")
