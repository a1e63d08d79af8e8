"""Where the sun is: error against NREL's SPA over 130 years and the whole Earth, and its cost.

    python -m vrut_lite_bench.sun_position

The formulas as the daylight thesis prints them (Hvezda 2020, equations 3.1 to 3.3) live here
alone, for their row in the table. The oracle is pvlib's SPA with computed delta T; a
JPL ephemeris (skyfield with skyfield-data) is asked beside it.
"""

import importlib
import math
import time
from collections.abc import Callable, Iterator
from datetime import UTC, datetime
from typing import Any

import numpy as np
from dynamic_skylight import sun_position
from numpy.typing import NDArray

from vrut_lite.geometry.frames import direction_from_angles

COUNT = 100_000
SKYFIELD_COUNT = 1_000
_EPOCH = datetime(1970, 1, 1, tzinfo=UTC)
_FIRST, _LAST = datetime(1950, 1, 1, tzinfo=UTC), datetime(2080, 1, 1, tzinfo=UTC)
# The JPL ephemeris of skyfield-data, DE421, ends here.
_DE421_ENDS = datetime(2050, 1, 1, tzinfo=UTC)

Angles = tuple[float, float]


class Samples:
    """Random instants, and places even over the Earth."""

    def __init__(self, count: int, last: datetime = _LAST):
        rng = np.random.default_rng(20200601)
        self.instants = [_FIRST + share * (last - _FIRST) for share in rng.random(count)]
        self.latitude_deg = np.degrees(np.arcsin(rng.uniform(-1, 1, count)))
        self.longitude_deg = rng.uniform(-180, 180, count)
        self.unix_s = np.array([(when - _EPOCH).total_seconds() for when in self.instants])


def spa_directions(samples: Samples) -> NDArray[np.float64]:
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


def skyfield_directions(samples: Samples) -> NDArray[np.float64]:
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


def as_printed(when: datetime, latitude_deg: float, longitude_deg: float) -> Angles:
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


def azimuth_as_printed(when: datetime, latitude_deg: float, longitude_deg: float) -> Angles:
    """The printed azimuth alone: the longitude's sign is put right."""
    return as_printed(when, latitude_deg, -longitude_deg)


def _printed_angles(x: float, d: float, a: float) -> Angles:
    sine = math.sin(x) * math.sin(d) - math.cos(x) * math.cos(d) * math.cos(a)
    azimuth = math.atan2(
        -math.cos(d) * math.sin(a),
        math.cos(x) * math.sin(d) - math.sin(x) * math.cos(d) * math.cos(a),
    )
    # The thesis counts from south, towards west.
    return azimuth + math.pi, math.asin(max(-1.0, min(1.0, sine)))


def ours(method: Any) -> Callable[[datetime, float, float], Angles]:
    """`sun_position` by a method."""

    def angles(when: datetime, latitude_deg: float, longitude_deg: float) -> Angles:
        sun = sun_position(when, latitude_deg, longitude_deg, method)
        return sun.azimuth_rad, sun.elevation_rad

    return angles


def directions(
    angles: Callable[[datetime, float, float], Angles], samples: Samples
) -> tuple[NDArray[np.float64], float]:
    """Directions (n, 3), and the CPU seconds of a call."""
    start = time.process_time()
    found = [
        angles(when, latitude, longitude)
        for when, latitude, longitude in zip(
            samples.instants, samples.latitude_deg, samples.longitude_deg, strict=True
        )
    ]
    spent = time.process_time() - start
    return direction_from_angles(*np.array(found).T), spent / len(found)


def apart_deg(a: NDArray[np.float64], b: NDArray[np.float64]) -> NDArray[np.float64]:
    """Great-circle angles (n,) between unit directions (n, 3)."""
    return np.degrees(2 * np.arcsin(np.minimum(np.linalg.norm(a - b, axis=-1) / 2, 1.0)))


def report() -> Iterator[str]:
    """A Markdown table."""
    samples = Samples(COUNT)
    truth = spa_directions(samples)
    yield "| method | median, deg | largest, deg | microseconds a call |"
    yield "|---|---:|---:|---:|"
    rows = {
        "ephemeris": ours("ephemeris"),
        "preetham (corrected)": ours("preetham"),
        "as printed, azimuth only": azimuth_as_printed,
        "as printed": as_printed,
    }
    for name, angles in rows.items():
        found, spent = directions(angles, samples)
        error = apart_deg(found, truth)
        yield f"| {name} | {np.median(error):.2g} | {error.max():.3g} | {spent * 1e6:.0f} |"
    some = Samples(SKYFIELD_COUNT, _DE421_ENDS)
    jpl = skyfield_directions(some)
    for name, other in (
        ("ephemeris", directions(ours("ephemeris"), some)[0]),
        ("pvlib's SPA", spa_directions(some)),
    ):
        worst = apart_deg(other, jpl).max()
        yield f"{name} against DE421, {SKYFIELD_COUNT} times to 2050: {worst:.2g} deg at most"


if __name__ == "__main__":
    for line in report():
        print(line, flush=True)
