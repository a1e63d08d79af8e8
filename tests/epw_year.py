"""A year of weather as an EPW file: pvlib's clear sky under a random but repeatable cloud series.

    .venv/bin/python tests/epw_year.py prague.epw

For tests and trials; a building wants a file of measurements.
"""

import sys
from pathlib import Path

import numpy as np
import pandas as pd
import pvlib

_HEADER = """LOCATION,{name},-,-,pvlib clear sky,0,{latitude},{longitude},{zone},{altitude}
DESIGN CONDITIONS,0
TYPICAL/EXTREME PERIODS,0
GROUND TEMPERATURES,0
HOLIDAYS/DAYLIGHT SAVINGS,No,0,0,0
COMMENTS 1,made by tests/epw_year.py
COMMENTS 2,
DATA PERIODS,1,1,Data,Sunday, 1/ 1,12/31
"""


def epw_text(
    name: str = "Prague",
    latitude: float = 50.1,
    longitude: float = 14.4,
    altitude: float = 200.0,
    zone: float = 1.0,
    year: int = 2023,
    seed: int = 1,
) -> str:
    """The file's text; irradiances are those of the middle of each hour."""
    start = pd.Timestamp(year, 1, 1, 0, 30, tz="UTC") - pd.Timedelta(hours=zone)
    hours = (pd.Timestamp(year + 1, 1, 1) - pd.Timestamp(year, 1, 1)).days * 24
    times = pd.date_range(start, periods=hours, freq="h")
    place = pvlib.location.Location(latitude, longitude, altitude=altitude)
    sun = place.get_solarposition(times, method="ephemeris")
    clear = place.get_clearsky(times, solar_position=sun, linke_turbidity=3.0)
    cover = _cloud_cover(hours, seed)
    level = np.maximum(np.sin(np.radians(sun["elevation"].to_numpy())), 0.0)
    # Kasten and Czeplak 1980; the sun shines through the gaps.
    total = clear["ghi"].to_numpy() * (1.0 - 0.75 * cover**3.4)
    direct = clear["dni"].to_numpy() * (1.0 - cover) ** 1.2
    diffuse = np.maximum(total - direct * level, 0.0)
    dew_point = 6.0 - 8.0 * np.cos(2.0 * np.pi * (np.arange(hours) / hours - 0.05))
    days = pd.date_range(pd.Timestamp(year, 1, 1), periods=hours, freq="h")
    lines = [
        f"{at.year},{at.month},{at.day},{at.hour + 1},60,?,"
        f"{dew + 4:.1f},{dew:.1f},70,99000,0,0,9999,{g:.0f},{b:.0f},{d:.0f},"
        f"999999,999999,999999,9999,180,2.0,{c:.0f},{c:.0f},9999,99999,9,999999999,999,"
        "0.1,0,88,0.2,0,0"
        for at, dew, g, b, d, c in zip(
            days, dew_point, total, direct, diffuse, np.round(10.0 * cover), strict=True
        )
    ]
    header = _HEADER.format(
        name=name, latitude=latitude, longitude=longitude, zone=zone, altitude=altitude
    )
    return header + "\n".join(lines) + "\n"


def _cloud_cover(hours: int, seed: int) -> np.ndarray:
    """Shares (hours,) that last some hours: noise that forgets over ten of them."""
    steps = np.random.default_rng(seed).standard_normal(hours)
    kept = np.exp(-0.1)
    state, series = 0.0, np.empty(hours)
    for hour, step in enumerate(steps):
        state = kept * state + np.sqrt(1.0 - kept * kept) * step
        series[hour] = state
    return np.clip(0.55 + 0.5 * series, 0.0, 1.0)


if __name__ == "__main__":
    Path(sys.argv[1]).write_text(epw_text(), encoding="ascii")
