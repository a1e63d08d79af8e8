"""Light while time plays: a strip of two hours, and how much light maps swim and are mottled.

    python -m vrut_lite_lab.pictures.light_strip STRIP.jpg [SCENE ...]

The strip has a picture every half hour. For the figures the light map of each scene is made by the
kernel, as the window has it. **Swimming:** light every two minutes for a quarter of an hour, twice
a day. It changes smoothly while the sun moves: what is left of a texel's light after a straight
line and a bow have been taken off is what a viewer sees swim. **Noise:** each round of rays against
the last, whose rays are among its own: over the root of 1 - n / N for n of N rays. All are shares
of the texel's light plus a tenth of the map's mean: rms and most over texels without the worst
twentieth, which lies within bodies, where things stand, or where walls meet.
"""

import sys
from datetime import UTC, datetime, timedelta
from pathlib import Path

import numpy as np
from light_transport.messages import NAME
from light_transport.module import LightTransport

from vrut_lite.daylight_kernel import daylight_kernel
from vrut_lite.geometry.colour import luminance
from vrut_lite.kernel.bus import Kernel
from vrut_lite.kernel.messages import Demand, Message, SetClock
from vrut_lite.messages.light_map import SurfaceLightChanged
from vrut_lite.messages.place import SetPlace
from vrut_lite.messages.scene import LoadScene
from vrut_lite.numeric_types import FloatArray
from vrut_lite.scene.manager import SceneManager
from vrut_lite_lab.pictures.drawing import SCENES, Captioned, scene_project, sheet, shots

_DAY, _DRAWN, _SIZE = "2026-06-21", ("street.toml", "work/indoor.glb"), (320, 200)
_STRIP = ("15:00", "15:30", "16:00", "16:30", "17:00")
_STARTS = (datetime(2026, 6, 21, 7, 0, tzinfo=UTC), datetime(2026, 6, 21, 13, 0, tzinfo=UTC))
_STEPS, _STEP, _CALM = 8, timedelta(minutes=2), 0.95


class Map:
    """A scene's light map in a kernel with a sky, and all light that was told of it."""

    def __init__(self, scene: str):
        self.lights: list[SurfaceLightChanged] = []
        self._kernel: Kernel = daylight_kernel()[0]
        if NAME not in self._kernel.seats:
            self._kernel.add_module(LightTransport)
        self._kernel.add_module(SceneManager)
        self._kernel.tap(self._note)
        self._kernel.inject(SetPlace(latitude_deg=50.0, longitude_deg=14.0))
        self._kernel.inject(Demand(consumer="strip", message=SurfaceLightChanged.__name__))
        self._kernel.inject(SetClock(instant=_STARTS[0]))
        self._kernel.inject(LoadScene(path=scene))
        self._kernel.pump_until_idle()

    def at(self, instant: datetime) -> FloatArray:
        """The light (texels,) of an hour."""
        self._kernel.inject(SetClock(instant=instant))
        self._kernel.pump_until_idle()
        return light_of(self.lights[-1])

    def close(self) -> None:
        """End its jobs."""
        self._kernel.close()

    def _note(self, message: Message, _sender: str) -> None:
        if isinstance(message, SurfaceLightChanged):
            self.lights.append(message)


def light_of(message: SurfaceLightChanged) -> FloatArray:
    """Luminance of the irradiance at all texels."""
    return np.asarray(luminance(message.texels.values[..., :3].astype(float)).ravel()) * (
        message.radiance_scale
    )


def sizes(off: FloatArray) -> str:
    """Rms and most of 95 %, as cells of a table."""
    calm = np.sort(np.abs(off))[: int(_CALM * len(off))]
    return f"{np.sqrt(np.mean(calm**2)):.2%} | {calm[-1]:.2%}"


def floored(light: FloatArray) -> FloatArray:
    """The divisor of an error."""
    return light + 0.1 * float(light[light > 0.0].mean())


def noise_lines(name: str, rounds: list[SurfaceLightChanged]) -> list[str]:
    """Each round against the last."""
    last, all_rays = light_of(rounds[-1]), rounds[-1].rays
    used = last > 0.0
    lines = []
    for one in rounds[:-1]:
        off = (light_of(one) - last) / floored(last) / np.sqrt(1.0 - one.rays / all_rays)
        lines.append(f"| {name} | noise of {one.rays} rays | {sizes(off[used])} |")
    return lines


def swimming_line(name: str, start: datetime, lights: FloatArray) -> str:
    """What is not smooth in light (steps, texels), and how much a step changes it."""
    mean = lights.mean(axis=0)
    relative = lights[:, mean > 0.0] / floored(mean)[mean > 0.0]
    times = np.linspace(-1.0, 1.0, len(relative))
    powers = np.stack([times**n for n in range(3)], axis=1)
    left = relative - powers @ np.linalg.lstsq(powers, relative, rcond=None)[0]
    # The fit has taken as many degrees of freedom as there are powers.
    off = np.sqrt((left**2).sum(axis=0) / (len(relative) - powers.shape[1]))
    step = np.sqrt(np.mean(np.diff(relative, axis=0) ** 2))
    return f"| {name} | swims from {start:%H:%M} UTC, {step:.2%} a step | {sizes(off)} |"


def strip(scene: str) -> list[Captioned]:
    """A picture each half hour."""
    taken = shots(scene_project(scene, size=_SIZE), [f"{_DAY}T{hour}" for hour in _STRIP])
    return [(shot.caption, shot.picture.display) for shot in taken]


def print_figures(scene: str) -> None:
    """Lines of a Markdown table."""
    file = scene_project(scene).scene
    shown = Map(str(SCENES / file if file else ""))
    for line in noise_lines(scene, shown.lights):
        print(line)
    for start in _STARTS:
        lights = np.array([shown.at(start + n * _STEP) for n in range(_STEPS)])
        print(swimming_line(scene, start, lights), flush=True)
    shown.close()


def main() -> None:
    """Print a Markdown table, and write the strip."""
    scenes = tuple(sys.argv[2:]) or _DRAWN
    print("| scene | what | rms | most |\n|---|---|---:|---:|")
    for scene in scenes:
        print_figures(scene)
    pictures = [picture for scene in scenes for picture in strip(scene)]
    sheet(pictures, len(_STRIP)).save(Path(sys.argv[1]), quality=88)


if __name__ == "__main__":
    main()
