"""The air between eye and things: the volume by its sizes, against its float64 twin."""

from functools import lru_cache, partial

import numpy as np
from bruneton_sky.air_volume import AirSizes, air_volume
from bruneton_sky.geometry import altitude_along
from bruneton_sky.phase import mie_phase, rayleigh_phase
from bruneton_sky.reference.air_exact import light_before
from bruneton_sky.solver import SourceField
from bruneton_sky.solver_job import solve_air
from numpy.typing import NDArray

from vrut_lite.daylight.air import AirVolume
from vrut_lite.daylight.air_volume import look_up_air
from vrut_lite.geometry.colour import rgb_from_spectrum
from vrut_lite.numeric_types import FloatArray
from vrut_lite_bench.errors import relative_errors
from vrut_lite_bench.path import Errors, Group, Path, Work
from vrut_lite_bench.skies import Condition, air

SIZES = {
    "least": AirSizes(slices=8, rows_above=10, rows_below=8, columns=10, steps=2),
    "small": AirSizes(slices=16, rows_above=20, rows_below=14, columns=20, steps=2),
    "one step a slice": AirSizes(steps=1),
    "the product's": AirSizes(),
    "four steps a slice": AirSizes(steps=4),
    "large": AirSizes(slices=48, rows_above=48, rows_below=36, columns=48, steps=2),
    "largest": AirSizes(slices=64, rows_above=64, rows_below=48, columns=64, steps=3),
}
QUICK_SIZES = ("small", "the product's")
AIR = "turbidity 3"
CONDITIONS = tuple(
    Condition(height, sun) for height in (2.0, 3000.0) for sun in (60.0, 20.0, 5.0, -3.0)
)
QUICK_CONDITIONS = CONDITIONS[:2]
_REACH_M = 1.2e5
_WALLS_M = np.array([300.0, 1e3, 3e3, 1e4, 3e4, 1e5])
# Of a wall, matt and in the full sun of space.
_ALBEDO = 0.2
_HEIGHTS_DEG = (-4.0, -0.5, -0.01, 0.4, 2.0, 8.0, 30.0)
_AZIMUTHS_DEG = (0.0, 9.0, 35.0, 90.0, 140.0, 171.0)


def groups(quick: bool) -> list[Group]:
    """The one group."""
    return [
        Group(
            name="air",
            title=f"Air before things, {AIR}",
            unit="a volume",
            norm="difference over the larger of the value and a thousandth of the largest: "
            "radiance of a grey wall (albedo 0.2) and of the air before it; 99th percentile over "
            "walls in all directions from 300 m to 100 km",
            truth="the float64 twin along each ray, of the same solution",
            paths=tuple(_path(said, quick) for said in (QUICK_SIZES if quick else SIZES)),
        )
    ]


def _conditions(quick: bool) -> tuple[Condition, ...]:
    return QUICK_CONDITIONS if quick else CONDITIONS


def _path(said: str, quick: bool) -> Path:
    return Path(
        name=said,
        family="steps" if "step" in said else "nodes",
        parameters=dict(SIZES[said]._asdict()),
        prepare=partial(_prepare, said, quick),
        error=_error,
        units=len(_conditions(quick)),
    )


@lru_cache(maxsize=1)
def _solved() -> SourceField:
    return solve_air(air(AIR))


def _prepare(said: str, quick: bool) -> Work:
    field, asked = _solved(), _conditions(quick)
    return lambda: {
        each: air_volume(field, each.height_m, each.sun, _REACH_M, SIZES[said]) for each in asked
    }


def _error(volumes: dict[Condition, AirVolume]) -> dict[str, Errors]:
    return {
        condition.name: relative_errors(_seen(volume, condition), _truth(condition))
        for condition, volume in volumes.items()
    }


def _seen(volume: AirVolume, condition: Condition) -> FloatArray:
    """Radiance (n, 3) of the walls and the air before them."""
    views = np.repeat(_views(), len(_WALLS_M), axis=0)
    light = look_up_air(volume, views, np.tile(_WALLS_M, len(_views())))
    seen = light.shaded + light.sunlit + _wall(condition) * light.transmittance
    return seen[_stands(condition)]


@lru_cache
def _truth(condition: Condition) -> FloatArray:
    return np.concatenate([_along(condition, view) for view in _views()])[_stands(condition)]


def _stands(condition: Condition) -> NDArray[np.bool_]:
    """Which walls (n,) do not lie under the ground."""
    radius = _solved().atmosphere.ground_radius_m
    mu, metres = np.repeat(_views()[:, 1], len(_WALLS_M)), np.tile(_WALLS_M, len(_views()))
    return altitude_along(radius, condition.height_m, mu, metres) > -1.0


def _along(condition: Condition, view: FloatArray) -> FloatArray:
    """The same of one ray's walls, by the twin."""
    atmosphere, sun = _solved().atmosphere, condition.sun
    nu = float(np.clip(view @ sun, -1.0, 1.0))
    light = light_before(_solved(), condition.height_m, float(view[1]), float(sun[1]), nu, _WALLS_M)
    total = light.molecules * rayleigh_phase(nu) + light.more
    total = total + light.aerosol * mie_phase(atmosphere, nu)
    white = np.asarray(atmosphere.solar_irradiance)
    through = rgb_from_spectrum(white * light.transmittance, atmosphere.wavelength_nm)
    share = through / rgb_from_spectrum(white, atmosphere.wavelength_nm)
    return rgb_from_spectrum(total, atmosphere.wavelength_nm) + _wall(condition) * share


def _wall(condition: Condition) -> FloatArray:
    """Radiance (3,) of a wall without air before it."""
    atmosphere = _solved().atmosphere
    sunlight = rgb_from_spectrum(atmosphere.solar_irradiance, atmosphere.wavelength_nm)
    return _ALBEDO / np.pi * max(float(condition.sun[1]), 0.0) * sunlight


@lru_cache
def _views() -> FloatArray:
    """Unit directions (n, 3) around the sun's azimuth."""
    height, turn = np.meshgrid(np.radians(_HEIGHTS_DEG), np.radians(_AZIMUTHS_DEG), indexing="ij")
    azimuth = np.arctan2(0.6, 0.8) + turn.ravel()
    level, up = np.cos(height.ravel()), np.sin(height.ravel())
    return np.stack([level * np.sin(azimuth), up, -level * np.cos(azimuth)], axis=-1)
