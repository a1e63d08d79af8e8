"""The machine that a measurement was made on."""

import os
import platform
from datetime import UTC, datetime
from importlib.metadata import PackageNotFoundError, version

from vrut_lite_lab.bench.results import Machine

_PACKAGES = ("vrut-lite", "numpy", "numba", "scipy", "moderngl", "mitsuba", "pvlib")
Load = tuple[float, float, float]


def machine(load_before: Load, renderer: str, pace_s: float) -> Machine:
    """This machine, after the measurements."""
    return Machine(
        date=datetime.now(UTC).strftime("%Y-%m-%d %H:%M UTC"),
        processor=processor(),
        cores=os.cpu_count() or 1,
        system=f"{platform.system()} {platform.machine()}, Python {platform.python_version()}",
        renderer=renderer,
        versions={name: found for name in _PACKAGES if (found := _version(name))},
        load_before=load_before,
        load_after=load(),
        pace_s=pace_s,
    )


def load() -> Load:
    """Load average over 1, 5 and 15 minutes."""
    return os.getloadavg()


def processor() -> str:
    """The processor's name as the system gives it."""
    try:
        with open("/proc/cpuinfo", encoding="utf-8") as file:
            names = [line.partition(":")[2].strip() for line in file if "model name" in line]
    except OSError:
        names = []
    return names[0] if names else platform.processor() or platform.machine()


def _version(package: str) -> str:
    try:
        return version(package)
    except PackageNotFoundError:
        return ""
