"""The air between eye and things: the volume by its sizes, against its float64 twin."""

from collections.abc import Callable
from dataclasses import replace
from functools import lru_cache, partial

import numpy as np
from bruneton_sky.air_volume import AirSizes, air_volume
from bruneton_sky.air_volume.gpu import air_volume_job
from bruneton_sky.geometry import altitude_along
from bruneton_sky.settings import BrunetonSkySettings, atmosphere_of
from bruneton_sky.solver import SourceField
from bruneton_sky.solver_job import solve_air
from dynamic_skylight.air import air_volume as exponential_air_volume
from dynamic_skylight.daylight import Daylight
from numpy.typing import NDArray

from vrut_lite.geometry.colour import rgb_from_spectrum
from vrut_lite.messages.air import AirVolume
from vrut_lite.numeric_types import FloatArray
from vrut_lite.sky.air_volume import look_up_air
from vrut_lite_lab.air_exact import light_before
from vrut_lite_lab.bench.bench_path import BenchPath, Errors, Group, Work, relative_errors
from vrut_lite_lab.bench.gl import GlTexture, gl_clock, missing_gl
from vrut_lite_lab.bench.skies import Condition, air, sun_at

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
AIR = "default air"
CONDITIONS = tuple(
    Condition(height, sun) for height in (2.0, 3000.0) for sun in (60.0, 20.0, 5.0, -3.0)
)
QUICK_CONDITIONS = CONDITIONS[:2]
_REACH_M = 1.2e5
_LIT_DEG = 30.0
_WALLS_M = np.array([300.0, 1e3, 3e3, 1e4, 3e4, 1e5])
# Of a wall, matt and in the full sun of space.
_ALBEDO = 0.2
_HEIGHTS_DEG = (-4.0, -0.5, -0.01, 0.4, 2.0, 8.0, 30.0)
_AZIMUTHS_DEG = (0.0, 9.0, 35.0, 90.0, 140.0, 171.0)


def groups(quick: bool) -> list[Group]:
    """The volume by its sizes; in the full form also other airs and devices, without a twin."""
    by_sizes = [
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
    return by_sizes if quick else [*by_sizes, _others()]


def _others() -> Group:
    paths = [_other_path(name, partial(_work_of, name)) for name in _OTHERS]
    left_out = {}
    if missing_gl():
        left_out["volumes of air on the GPU"] = missing_gl()
    else:
        on_gpu = _other_path("Bruneton, GPU shader", _prepare_gpu)
        paths.append(replace(on_gpu, clock=gl_clock(), device="GPU", batch="GPU"))
    return Group(
        name="air-others",
        title="Air before things: other airs, observers and devices",
        unit="a volume",
        norm="none: times alone",
        truth="none",
        paths=tuple(paths),
        left_out=left_out,
    )


def _other_path(name: str, prepare: Callable[[], Work]) -> BenchPath:
    return BenchPath(name=name, family=name, prepare=prepare, error=None)


# Of fog: visibility in metres; and the observer's height.
_OTHERS: dict[str, tuple[float | None, float]] = {
    "Bruneton": (None, 2.0),
    "Bruneton, the CPU's part for the GPU": (None, 2.0),
    "Bruneton, fog": (1000.0, 2.0),
    "Bruneton, from 400 km": (None, 4e5),
    "Hosek-Wilkie": (None, 2.0),
}


def _work_of(name: str) -> Work:
    visibility_m, height_m = _OTHERS[name]
    where = (height_m, sun_at(_LIT_DEG), 5e6 if height_m > _REACH_M else _REACH_M)
    if name == "Hosek-Wilkie":
        hour = Daylight(
            turbidity=3.0,
            albedo=0.1,
            sun_colour="disc",
            apparent_elevation_rad=np.radians(_LIT_DEG),
            sun_azimuth_rad=0.0,
            visible_disc_fraction=1.0,
        )
        return partial(exponential_air_volume, hour, tuple(where[1].tolist()), where[0], where[2])
    field = solve_air(atmosphere_of(BrunetonSkySettings(fog_visibility_m=visibility_m)))
    if "GPU" in name:
        return partial(air_volume_job, field, *where, "bench", "air")
    return partial(air_volume, field, *where)


def _prepare_gpu() -> Work:
    job, _ = air_volume_job(_solved(), 2.0, sun_at(_LIT_DEG), _REACH_M, "bench", "air")
    return GlTexture(job)


def _conditions(quick: bool) -> tuple[Condition, ...]:
    return QUICK_CONDITIONS if quick else CONDITIONS


def _path(said: str, quick: bool) -> BenchPath:
    return BenchPath(
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
    total = light.once + light.more
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
