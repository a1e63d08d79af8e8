"""The recorded session: `python tests/session.py` records it again after a change of its script."""

from collections.abc import Iterable
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import NamedTuple

import numpy as np
from vrut_lite.geometry.spherical_harmonics import irradiance_coefficients
from vrut_lite.kernel.bus import Kernel
from vrut_lite.kernel.messages import ChooseSlot, Input, SetClock
from vrut_lite.kernel.module import Manifest
from vrut_lite.messages.place import SetPlace
from vrut_lite.recording.recorder import Recorder
from vrut_lite.recording.replay_runner import ReplayRunner
from vrut_lite.sky.sky_module import SkyModule
from vrut_lite.sky.sky_of_hour import Background, Sky, SunDisc
from vrut_lite.sky.sky_sum import SkySum
from vrut_lite.testing.sky_on_bus import SunAndEye

from new_tool.module import NewTool

JOURNAL = Path(__file__).parent / "session.mcap"


class EvenSize(NamedTuple):
    """A sky of one colour needs few texels."""

    cube_size: int = 16


class EvenSky(SkyModule):
    """A sky that is as bright everywhere as its sun is high: numbers that a test can foretell."""

    manifest = Manifest(
        name="even_sky", title="Even sky", version="1", provides=("sky",), requires=("sun",)
    )

    def quality(self, tolerance):
        return EvenSize()

    def light(self, hour, quality, prepared):
        return EvenLight(max(hour.sun.direction[1], 0.0))


@dataclass(frozen=True)
class EvenLight(Sky):
    """Radiance of sky and ground, W m^-2 sr^-1, is the sine of the sun's elevation."""

    level: float

    def background(self, size):
        return Background(np.full((6, size, size, 3), self.level, np.float32), np.zeros(3))

    def sun(self):
        return SunDisc(np.full(3, 10.0 * self.level))

    def ambient(self):
        return irradiance_coefficients(self.background(16).cube)


# The tool, and a sky and a sun that are placed by hand: updates of other modules leave the journal
# alone.
MODULES = (SunAndEye, EvenSky, SkySum, NewTool)


def open_kernel() -> Kernel:
    """A kernel with these modules."""
    kernel = Kernel(runner=ReplayRunner())
    for module in MODULES:
        kernel.add_module(module)
    play(kernel, [ChooseSlot(slot="sky", module="even_sky")])
    return kernel


def play(kernel: Kernel, script: Iterable[Input]) -> None:
    """One input after another."""
    for message in script:
        kernel.inject(message)
        kernel.pump_until_idle()


def at(hour: int, minute: int, elevation_deg: float) -> list[Input]:
    """An hour, and the sun then. SunAndEye: the latitude is the elevation."""
    clock = SetClock(instant=datetime(2026, 6, 21, hour, minute, tzinfo=UTC))
    return [clock, SetPlace(latitude_deg=elevation_deg, longitude_deg=90.0)]


def record(path: Path = JOURNAL) -> None:
    """Three hours of a morning."""
    kernel = Kernel(runner=ReplayRunner())
    for module in MODULES:
        kernel.add_module(module)
    chosen = ChooseSlot(slot="sky", module="even_sky")
    script = [chosen, *at(6, 0, 20.0), *at(6, 5, 21.0), *at(7, 0, 30.0), *at(8, 0, 40.0)]
    with path.open("wb") as stream:
        recorder = Recorder(kernel, stream)
        play(kernel, script)
        recorder.close()
    kernel.close()


if __name__ == "__main__":
    record()
