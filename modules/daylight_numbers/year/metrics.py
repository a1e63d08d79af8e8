"""Numbers of a year: IES LM-83, useful daylight illuminance, EN 17037, doses."""

import itertools
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from daylight_numbers.matrix.sensors import Sensors
from daylight_numbers.year.year import Year
from daylight_numbers.year.year_light import DAYS, HOURS, YearLight
from vrut_lite.numeric_types import BoolArray, Float32Array, FloatArray

# From 8:00 to 18:00, all days (IES LM-83-12).
_FROM_H, _TO_H = 8, 18
OCCUPIED_H = DAYS * (_TO_H - _FROM_H)
_DA_LX, _DA_SHARE = 300.0, 0.5
_ASE_LX, _ASE_H = 1000.0, 250
UDI_LX = (100.0, 300.0, 3000.0)
# EN 17037:2018, tables A.1, for openings in walls, and A.2, for those in roofs.
EN_LEVELS = ("minimum", "medium", "high")
EN_TARGET_LX, EN_LEAST_LX = (300.0, 500.0, 750.0), (100.0, 300.0, 500.0)
_EN_TARGET_PLANE, _EN_LEAST_PLANE = 0.5, 0.95
_DAYLIGHT_H = 4380


@dataclass(frozen=True, eq=False)
class PointYear:
    """Numbers of each sensor (P,): shares of 3,650 hours, hours, and lux hours.

    `en_lx`: the illuminance that is reached in half of the 4,380 daylight hours.
    """

    da_300: FloatArray
    ase_h: FloatArray
    udi: FloatArray
    en_lx: FloatArray
    dose_klxh: FloatArray


@dataclass(frozen=True, eq=False)
class RoomYear:
    """Numbers of a room: shares of its sensors; `udi` (4,) are shares of time below 100 lx, to 300,
    to 3000, and above, in the mean; `en_level` is of EN_LEVELS, or none."""

    da_300_50: float
    ase_1000_250: float
    udi: FloatArray
    en_level: str
    en_median_lx: float
    en_low_lx: float
    dose_klxh: float


def occupied(light: YearLight) -> BoolArray:
    """Which hours (H,) lie between 8:00 and 18:00."""
    clock = light.hour % HOURS
    return np.asarray((clock >= _FROM_H) & (clock < _TO_H))


def daylight_autonomy(
    total: Float32Array, light: YearLight, least_lx: float = _DA_LX
) -> FloatArray:
    """Share (P,) of the hours from 8:00 to 18:00 that have 300 lx, by illuminances (P, H)."""
    return np.asarray((total[:, occupied(light)] >= least_lx).sum(axis=1) / OCCUPIED_H)


def spatial_autonomy(autonomy: FloatArray, least_share: float = _DA_SHARE) -> float:
    """Share of sensors (P,) whose daylight autonomy is at least a half."""
    return float(np.mean(autonomy >= least_share))


def daylight_hours(light: YearLight) -> NDArray[np.int64]:
    """Numbers of the 4,380 hours with most diffuse light outdoors (EN 17037's daylight hours)."""
    return np.argsort(-light.diffuse_lux, kind="stable")[:_DAYLIGHT_H]


def median_diffuse_lx(light: YearLight) -> float:
    """Illuminance (lx) on open level ground without the sun's own, reached in half of the 4,380
    daylight hours: EN 17037:2018's Ev,d,med, clause A.2."""
    hours = daylight_hours(light)
    ordered = np.sort(light.diffuse_lux[hours])
    return float(ordered[max(len(hours) - _DAYLIGHT_H // 2, 0)])


def point_year(total: Float32Array, year: Year, light: YearLight) -> PointYear:
    """Numbers of sensors by illuminances (P, H): a year's, or those of one half of its rays."""
    used = occupied(light)
    lux = total[:, used]
    edges = (0.0, *UDI_LX, np.inf)
    within = [
        ((lux >= low) & (lux < high)).sum(axis=1) / OCCUPIED_H
        for low, high in itertools.pairwise(edges)
    ]
    # Hours without any light are not among those that were computed.
    within[0] = 1.0 - sum(within[1:])
    day = daylight_hours(light)
    ordered = np.sort(total[:, day], axis=1)
    return PointYear(
        da_300=daylight_autonomy(total, light),
        ase_h=(year.sun[:, used] > _ASE_LX).sum(axis=1).astype(float),
        udi=np.stack(within, axis=1),
        en_lx=ordered[:, max(len(day) - _DAYLIGHT_H // 2, 0)].astype(float),
        dose_klxh=total.sum(axis=1) / 1000.0,
    )


class EnPlane(NamedTuple):
    """EN 17037 on a work plane: level of EN_LEVELS or none, and the lux that 50 % and 95 % of its
    sensors reach, without those within half a metre of a wall."""

    level: str
    median_lx: float
    low_lx: float


def en_plane(lux: FloatArray, sensors: Sensors, plane: int, is_lit_by_roof: bool) -> EnPlane:
    """The level of one work plane by illuminances (P,) that sensors have in half of the daylight
    hours; with roof lights 95 % of it must reach the target."""
    here = sensors.plane == plane
    inner = here & sensors.inner
    ordered = np.sort(lux[inner if inner.any() else here])
    median, low = (
        float(ordered[int(len(ordered) * (1.0 - share) + 1e-9)])
        for share in (_EN_TARGET_PLANE, _EN_LEAST_PLANE)
    )
    reached = [
        name
        for name, target, least in zip(EN_LEVELS, EN_TARGET_LX, EN_LEAST_LX, strict=True)
        if (low >= target if is_lit_by_roof else median >= target and low >= least)
    ]
    return EnPlane(reached[-1] if reached else "none", median, low)


def room_year(
    points: PointYear, sensors: Sensors, plane: int, is_lit_by_roof: bool = False
) -> RoomYear:
    """Numbers of one work plane; with roof lights 95 % of it must reach the target."""
    here = sensors.plane == plane
    en = en_plane(points.en_lx, sensors, plane, is_lit_by_roof)
    return RoomYear(
        da_300_50=spatial_autonomy(points.da_300[here]),
        ase_1000_250=float(np.mean(points.ase_h[here] > _ASE_H)),
        udi=points.udi[here].mean(axis=0),
        en_level=en.level,
        en_median_lx=en.median_lx,
        en_low_lx=en.low_lx,
        dose_klxh=float(points.dose_klxh[here].mean()),
    )


def by_day_and_hour(values: FloatArray, hours: NDArray[np.int64]) -> FloatArray:
    """Values (H,) of hours of the year as (HOURS, DAYS), 0 in hours without light."""
    found = np.zeros((HOURS, DAYS))
    found[hours % HOURS, hours // HOURS] = values
    return found
