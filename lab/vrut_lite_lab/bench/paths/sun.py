"""The sun's position: by ephemeris, by the short series and as the thesis prints it.

The formulas as the daylight thesis prints them (Hvezda 2020, equations 3.1 to 3.3) are here for
comparison alone. The truth is NREL's SPA (pvlib, with computed delta T); it and our ephemeris are
compared with JPL's DE421 (skyfield with skyfield-data) besides.
"""

import importlib
import math
from collections.abc import Callable
from datetime import UTC, datetime
from functools import lru_cache, partial
from importlib.util import find_spec
from typing import Any

import numpy as np
from dynamic_skylight import sun_position

from vrut_lite.geometry.frames import direction_from_angles
from vrut_lite.numeric_types import FloatArray
from vrut_lite_lab.bench.bench_path import BenchPath, Errors, Group, Work, sizes_of

Angles = tuple[float, float]
Method = Callable[[datetime, float, float], Angles]
Truth = Callable[["Samples"], FloatArray]
_EPOCH = datetime(1970, 1, 1, tzinfo=UTC)
_FIRST, _LAST = datetime(1950, 1, 1, tzinfo=UTC), datetime(2080, 1, 1, tzinfo=UTC)
# The JPL ephemeris of skyfield-data, DE421, ends here.
_DE421_ENDS = datetime(2050, 1, 1, tzinfo=UTC)
_NORM = "angle between the directions, in radians, over instants and places"


def groups(quick: bool) -> list[Group]:
    """Against SPA; in the full form also against DE421."""
    methods: dict[str, Method] = {
        "ephemeris": _ours("ephemeris"),
        "preetham": _ours("preetham"),
        "thesis as printed, azimuth only": _azimuth_as_printed,
        "thesis as printed": _as_printed,
    }
    count = 300 if quick else 3000
    spa = partial(_path, samples=Samples(count), truth=_spa_directions, when="1950 to 2080")
    against_spa = Group(
        name="sun",
        title="Sun's position",
        unit="a position",
        norm=_NORM,
        truth="NREL's SPA (pvlib), geometric, 1950 to 2080, places even over the Earth",
        paths=_unless_missing("pvlib", [spa(name, method) for name, method in methods.items()]),
        left_out=_left_out("sun position", "pvlib"),
    )
    if quick:
        return [against_spa]
    jpl = partial(_path, samples=Samples(1000, _DE421_ENDS), truth=_jpl_directions, when="to 2050")
    return [
        against_spa,
        Group(
            name="sun-jpl",
            title="Sun's position against JPL's ephemeris",
            unit="a position",
            norm=_NORM,
            truth="JPL's DE421 (skyfield), geometric, UTC taken for UT1, 1950 to 2050",
            paths=_unless_missing("skyfield_data", [jpl("ephemeris", methods["ephemeris"])]),
            left_out=_left_out("sun against JPL's ephemeris", "skyfield_data"),
        ),
    ]


def _unless_missing(package: str, paths: list[BenchPath]) -> tuple[BenchPath, ...]:
    return tuple(paths) if find_spec(package) else ()


def _left_out(what: str, package: str) -> dict[str, str]:
    return {} if find_spec(package) else {what: f"{package}, the truth, is not installed"}


def _path(name: str, method: Method, samples: "Samples", truth: Truth, when: str) -> BenchPath:
    return BenchPath(
        name=name,
        family=name,
        prepare=partial(_prepare, method, samples),
        error=partial(_error, samples, truth, when),
        units=len(samples.instants),
    )


def _prepare(method: Method, samples: "Samples") -> Work:
    moments = list(zip(samples.instants, samples.latitude_deg, samples.longitude_deg, strict=True))
    return lambda: [method(*moment) for moment in moments]


def _error(samples: "Samples", truth: Truth, when: str, found: list[Any]) -> dict[str, Errors]:
    azimuth, elevation = np.array(found).T
    chord = np.linalg.norm(direction_from_angles(azimuth, elevation) - truth(samples), axis=-1)
    return {when: sizes_of(2 * np.arcsin(np.minimum(chord / 2, 1.0)))}


class Samples:
    """Random instants, and places even over the Earth."""

    def __init__(self, count: int, last: datetime = _LAST):
        rng = np.random.default_rng(20200601)
        self.instants = [_FIRST + share * (last - _FIRST) for share in rng.random(count)]
        self.latitude_deg = np.degrees(np.arcsin(rng.uniform(-1, 1, count)))
        self.longitude_deg = rng.uniform(-180, 180, count)
        self.unix_s = np.array([(when - _EPOCH).total_seconds() for when in self.instants])


@lru_cache
def _spa_directions(samples: Samples) -> FloatArray:
    """Geometric directions (n, 3) by pvlib's SPA, east, north, up."""
    spa: Any = importlib.import_module("pvlib.spa")
    year = np.array([when.year for when in samples.instants])
    month = np.array([when.month for when in samples.instants])
    delta_t = spa.calculate_deltat(year, month)
    found = spa.solar_position_numpy(
        samples.unix_s, samples.latitude_deg, samples.longitude_deg, 0.0, 1013.25, 12.0,
        delta_t, 0.5667, 1,
    )  # fmt: skip
    return direction_from_angles(np.radians(found[4]), np.radians(found[3]))


@lru_cache
def _jpl_directions(samples: Samples) -> FloatArray:
    """Geometric directions (n, 3) from JPL's DE421; UTC is taken for UT1, as ours takes it."""
    api: Any = importlib.import_module("skyfield.api")
    data: Any = importlib.import_module("skyfield_data")
    load = api.Loader(data.get_skyfield_data_path(), verbose=False)
    planets, timescale = load("de421.bsp"), load.timescale(builtin=True)
    found = []
    for when, latitude, longitude in zip(
        samples.instants, samples.latitude_deg, samples.longitude_deg, strict=True
    ):
        julian = 2440587.5 + (when - _EPOCH).total_seconds() / 86_400
        place = planets["earth"] + api.wgs84.latlon(latitude, longitude)
        seen = place.at(timescale.ut1_jd(julian)).observe(planets["sun"]).apparent()
        altitude, azimuth, _ = seen.altaz()
        found.append((azimuth.radians, altitude.radians))
    return direction_from_angles(*np.array(found).T)


def _as_printed(when: datetime, latitude_deg: float, longitude_deg: float) -> Angles:
    """The thesis's equations letter by letter, its arctan read as atan2; local mean time, SM 0.

    The printed SM - X_lambda is taken for radians and the clock for UTC.
    """
    hours = when.hour + when.minute / 60 + when.second / 3600
    day = when.timetuple().tm_yday
    x, declination = math.radians(latitude_deg), 0.4093 * math.sin(2 * math.pi * (day - 81) / 368)
    solar = hours + 0.170 * math.sin(4 * math.pi * (day - 80) / 373)
    solar -= 0.129 * math.sin(2 * math.pi * (day - 8) / 355)
    solar += 12 * -math.radians(longitude_deg) / math.pi
    return _printed_angles(x, declination, math.pi * solar / 12)


def _azimuth_as_printed(when: datetime, latitude_deg: float, longitude_deg: float) -> Angles:
    """The printed azimuth alone: the longitude's sign is put right."""
    return _as_printed(when, latitude_deg, -longitude_deg)


def _printed_angles(x: float, d: float, a: float) -> Angles:
    sine = math.sin(x) * math.sin(d) - math.cos(x) * math.cos(d) * math.cos(a)
    azimuth = math.atan2(
        -math.cos(d) * math.sin(a),
        math.cos(x) * math.sin(d) - math.sin(x) * math.cos(d) * math.cos(a),
    )
    # The thesis counts from south, towards west.
    return azimuth + math.pi, math.asin(max(-1.0, min(1.0, sine)))


def _ours(method: Any) -> Method:
    """`sun_position` by a method."""

    def angles(when: datetime, latitude_deg: float, longitude_deg: float) -> Angles:
        sun = sun_position(when, latitude_deg, longitude_deg, method)
        return sun.azimuth_rad, sun.elevation_rad

    return angles
