"""The atmospheres of the programs, as ours has them.

Constants are those of the programs' sources (Blender 5.0, intern/sky; Radiance 6, gen/atmos.c and
lib/mie_ca.dat). Where a profile is none of ours, columns are equal, so that optical depths are.
"""

from collections.abc import Callable
from dataclasses import replace
from functools import cache
from importlib.resources import files
from math import gamma
from typing import Any

import numpy as np
from bruneton_sky import Atmosphere, earth_spectral
from bruneton_sky.atmosphere_numbers import LAYERS, SPECTRAL_FIELDS
from bruneton_sky.presets import earth_standard
from scipy.interpolate import CubicSpline

from vrut_lite.atmosphere.aerosols import type_optics
from vrut_lite.geometry.colour import SRGB_FROM_XYZ, integration_matrix
from vrut_lite.numeric_types import FloatArray
from vrut_lite_lab.study.peers.peer import PeerAir
from vrut_lite_lab.study.peers.radiance_home import radiance_home

# Of the air in which models are compared that know only a haze.
DEPTH, GROUND_ALBEDO = 0.2, 0.2
_WHOLE_NM = tuple(np.arange(390.0, 721.0, 10.0).tolist())
# At every fourth, 40 nm apart, ozone in dusk's green is missed by 4 %; so by 0.8 %.
_EVERY = 2
_BLENDER_SINGLE_COUNT = 21
_MU_S_MIN = float(np.cos(np.radians(102.0)))


def continental(wavelength_nm: tuple[float, ...] = _WHOLE_NM) -> Atmosphere:
    """OPAC's continental average at depth 0.20: what the product shows unless told otherwise."""
    air = earth_standard(wavelength_nm).with_optics(type_optics("continental-average", 80.0), DEPTH)
    return _on(air, GROUND_ALBEDO)


def _on(air: Atmosphere, albedo: float) -> Atmosphere:
    return replace(air, ground_albedo=(albedo,) * len(air.wavelength_nm))


def _colours_of_few(air: Atmosphere, every: int) -> tuple[Atmosphere, FloatArray]:
    """The air at every so many of its wavelengths, and their matrix to linear sRGB.

    Light over sunlight is smooth in wavelength: a cubic spline of it times the sun's own spectrum
    gives the colours of all wavelengths.
    """
    kept = sorted({*range(0, len(air.wavelength_nm), every), len(air.wavelength_nm) - 1})

    def some(values: tuple[float, ...]) -> tuple[float, ...]:
        return tuple(values[n] for n in kept)

    names = "wavelength_nm", *SPECTRAL_FIELDS, *LAYERS
    changed: dict[str, Any] = {name: some(getattr(air, name)) for name in names}
    for name in ("mie_table", "aloft_table"):
        table = getattr(air, name)
        changed[name] = table and table.at_rows(np.eye(len(air.wavelength_nm))[kept])
    few = replace(air, **changed)
    between = CubicSpline(few.wavelength_nm, np.eye(len(kept)))(air.wavelength_nm)
    through_sun = np.array(air.solar_irradiance)[:, None] * between / few.solar_irradiance
    return few, through_sun.T @ integration_matrix(air.wavelength_nm)


def _continental() -> PeerAir:
    few, to_rgb = _colours_of_few(continental(), _EVERY)
    return PeerAir(
        name="continental",
        title="OPAC's continental average, depth 0.20",
        atmosphere=few,
        to_rgb=to_rgb,
        note="18 wavelengths; models of a turbidity at the turbidity of this optical depth",
    )


def _clear() -> PeerAir:
    few, to_rgb = _colours_of_few(earth_spectral(_WHOLE_NM), _EVERY)
    return PeerAir(
        name="clear",
        title="Bruneton's demonstration of 2017",
        atmosphere=few,
        to_rgb=to_rgb,
        note="18 wavelengths",
    )


def _blender_multiple() -> PeerAir:
    """Four wavelengths; molecules thin as exp(-0.0777 h^1.1636), which is 8.5 km in the mean."""
    per_km, power = 0.07771971, 1.16364243
    column_km = per_km ** (-1.0 / power) * gamma(1.0 + 1.0 / power)
    haze_per_km = 1.3681e20
    scattering = np.array([1.5908e-22, 1.7711e-22, 2.0942e-22, 2.4033e-22]) * haze_per_km
    absorption = np.array([2.8722e-24, 4.6168e-24, 7.9706e-24, 1.3578e-23]) * haze_per_km
    height_km = np.concatenate([np.arange(4.0, 60.0, 2.0), np.arange(60.0, 100.0, 10.0)])
    logarithm = np.log(height_km)
    ozone = 3.78547397e20 * np.exp(-((logarithm - 3.22261) ** 2) * 5.5555555 - logarithm)
    cross = np.array([3.472e-25, 3.914e-25, 1.349e-25, 11.03e-27]) * 334.5
    xyz = np.array(
        [
            [53.38692, 22.98134, 0.0],
            [43.90484, 71.34780, 0.1025069],
            [1.613728, 18.42296, 31.74292],
            [20.76267, 2.361421, 110.4801],
        ]
    )
    air = Atmosphere(
        wavelength_nm=(630.0, 560.0, 490.0, 430.0),
        solar_irradiance=(1.679, 1.828, 1.986, 1.307),
        ground_radius_m=6_371_000.0,
        top_altitude_m=100_000.0,
        rayleigh_scattering=(6.605e-6, 1.067e-5, 1.842e-5, 3.156e-5),
        rayleigh_scale_height_m=1000.0 * column_km,
        mie_scattering=tuple(scattering / 1000.0),
        mie_extinction=tuple((scattering + absorption) / 1000.0),
        mie_scale_height_m=730.0,
        mie_g=0.8,
        mie_phase="henyey-greenstein",
        absorption_extinction=tuple(cross * ozone.max() / 1000.0),
        absorber_altitude_m=tuple(1000.0 * height_km),
        absorber_density=tuple(ozone / ozone.max()),
        ground_albedo=(0.3,) * 4,
        sun_angular_radius_rad=0.004675,
        mu_s_min=_MU_S_MIN,
    )
    return PeerAir(
        name="blender-multiple",
        title="Blender 5's, of multiple scattering",
        atmosphere=air,
        to_rgb=xyz @ SRGB_FROM_XYZ.T,
        note="its four wavelengths and its colours; molecules as one exponential of equal column",
    )


def _by_table(name: str, **others: Any) -> Atmosphere:
    """Air of a bundled table by wavelength: sun, molecules and ozone, which lies in a tent."""
    text = files("vrut_lite_lab.study.peers").joinpath("data", name).read_text(encoding="utf-8")
    rows = np.loadtxt(text.splitlines(), delimiter=",", skiprows=1)
    wavelength, sun, molecules, ozone = (tuple(column) for column in rows.T)
    return Atmosphere(
        wavelength_nm=wavelength,
        solar_irradiance=sun,
        ground_radius_m=6_360_000.0,
        top_altitude_m=60_000.0,
        rayleigh_scattering=molecules,
        absorption_extinction=ozone,
        absorber_altitude_m=(10_000.0, 25_000.0, 40_000.0),
        absorber_density=(0.0, 1.0, 0.0),
        sun_angular_radius_rad=0.004675,
        mu_s_min=_MU_S_MIN,
        **others,
    )


def _blender_single() -> PeerAir:
    air = _by_table(
        "blender_single_scattering.csv",
        rayleigh_scale_height_m=8000.0,
        mie_scattering=(2e-5,) * _BLENDER_SINGLE_COUNT,
        mie_extinction=(2.22e-5,) * _BLENDER_SINGLE_COUNT,
        mie_scale_height_m=1200.0,
        mie_g=0.76,
        ground_albedo=(0.0,) * _BLENDER_SINGLE_COUNT,
    )
    return PeerAir(
        name="blender-single",
        title="Blender 5's, of single scattering",
        atmosphere=air,
        to_rgb=integration_matrix(air.wavelength_nm),
        note="exact, black ground, its 21 wavelengths; the truth has all orders",
    )


def _genssky() -> PeerAir:
    """genssky's mid-latitude summer; its haze is a table over altitude, white, of one lobe.

    Two exponential layers stand for the table: the lower 2 km, of which nearly all is, and what is
    above, of equal columns at every wavelength's mean.
    """
    home = radiance_home()
    lines = (home / "lib" / "mie_ca.dat").read_text().splitlines()
    values = [float(word) for line in lines if not line.startswith("#") for word in line.split()]
    count = int(values[3])
    height_m = np.array(values[4 : 4 + count])
    table = np.array(values[7 + count :]).reshape(count, -1)
    at_550 = table[:, 8]
    low, aloft = height_m <= 2000.0, height_m >= 2000.0
    columns = [np.trapezoid(at_550[part], height_m[part]) for part in (low, aloft)]
    # The upper layer begins at the ground: what of it lies lower is taken from the lower layer.
    aloft_m = columns[1] / at_550[aloft][0]
    at_ground = at_550[aloft][0] * np.exp(2000.0 / aloft_m)
    share = at_ground / at_550[0]
    lower_m = (sum(columns) - at_ground * aloft_m) / (at_550[0] - at_ground)
    air = _by_table(
        "genssky.csv",
        rayleigh_scale_height_m=8820.0,
        mie_scattering=tuple((1.0 - share) * table[0]),
        mie_extinction=tuple((1.0 - share) * table[0]),
        mie_scale_height_m=float(lower_m),
        aloft_scattering=tuple(share * table[0]),
        aloft_extinction=tuple(share * table[0]),
        aloft_scale_height_m=float(aloft_m),
        mie_g=0.7,
        ground_albedo=(0.2,) * table.shape[1],
    )
    return PeerAir(
        name="genssky",
        title="genssky's, mid-latitude summer",
        atmosphere=air,
        to_rgb=integration_matrix(air.wavelength_nm),
        note="its 20 wavelengths; its table of haze as two exponentials of equal column",
    )


_MAKERS: dict[str, Callable[[], PeerAir]] = {
    "continental": _continental,
    "clear": _clear,
    "blender-multiple": _blender_multiple,
    "blender-single": _blender_single,
    "genssky": _genssky,
}
AIRS = tuple(_MAKERS)


@cache
def air(name: str) -> PeerAir:
    """The atmosphere of a name of `AIRS`.

    Raises:
        NotHere: its constants come with a program that is not installed.
    """
    return _MAKERS[name]()
