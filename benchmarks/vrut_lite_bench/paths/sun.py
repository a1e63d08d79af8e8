"""The sun's position: by ephemeris and by the short series, against NREL's SPA."""

from collections.abc import Callable
from functools import partial
from importlib.util import find_spec
from typing import Any

import numpy as np

from vrut_lite.geometry.frames import direction_from_angles
from vrut_lite_bench.errors import sizes_of
from vrut_lite_bench.path import Errors, Group, Path, Work
from vrut_lite_bench.sun_position import (
    Angles,
    Samples,
    apart_deg,
    as_printed,
    azimuth_as_printed,
    ours,
    spa_directions,
)

Method = Callable[..., Angles]
_METHODS: dict[str, Method] = {
    "ephemeris": ours("ephemeris"),
    "preetham": ours("preetham"),
    "thesis as printed, azimuth only": azimuth_as_printed,
    "thesis as printed": as_printed,
}


def groups(quick: bool) -> list[Group]:
    """The one group."""
    count = 300 if quick else 3000
    left_out = {}
    if find_spec("pvlib") is None:
        left_out["sun position"] = "pvlib, whose SPA is the truth, is not installed"
    methods = {} if left_out else _METHODS
    return [
        Group(
            name="sun",
            title="Sun's position",
            unit="a position",
            norm="angle between the directions, in radians, over instants and places",
            truth="NREL's SPA (pvlib), geometric, 1950 to 2080, places even over the Earth",
            paths=tuple(_path(name, method, count) for name, method in methods.items()),
            left_out=left_out,
        )
    ]


def _path(name: str, method: Method, count: int) -> Path:
    return Path(
        name=name,
        family=name,
        prepare=partial(_prepare, method, count),
        error=partial(_error, count),
        units=count,
    )


def _prepare(method: Method, count: int) -> Work:
    samples = Samples(count)
    moments = list(zip(samples.instants, samples.latitude_deg, samples.longitude_deg, strict=True))
    return lambda: [method(*moment) for moment in moments]


def _error(count: int, found: list[Any]) -> dict[str, Errors]:
    azimuth, elevation = np.array(found).T
    apart = apart_deg(direction_from_angles(azimuth, elevation), spa_directions(Samples(count)))
    return {"1950 to 2080": sizes_of(np.radians(apart))}
