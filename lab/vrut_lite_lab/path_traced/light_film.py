"""A film of an hour while the clock plays: strips, and how unsteady the picture is.

    python -m vrut_lite_lab.path_traced.light_film STRIP.jpg [--step S] [--from HH:MM] [SCENE ...]

One host plays an hour in small steps, as the window does: an hour that looks like the one before
is not computed. Every picture has the first one's exposure. A second film leaves the sun's own
light out of the same frames: no shadow's edge moves over its pixels, and all that is left is the
light map's, the probes' and the mirrors'. Under each strip stands its unsteadiness, pixel by
pixel, 1 % of a pixel's light as white.

A pixel's light, over its mean plus a tenth of the picture's, changes smoothly while the sun moves.
**Step** is the rms of its change from frame to frame. **Second difference** is that of the change
of this change; **smooth** the same of the polynomial of degree five that fits the hour best, which
is what the sun alone brings; **left** is what the film has besides the polynomial. All are rms over
frames, at half of the pixels, at 95 % and at 99.9 % of them. Sky does not count.
"""

import argparse
from collections.abc import Iterator
from dataclasses import replace
from datetime import timedelta
from pathlib import Path

import msgspec
import numpy as np
from numpy.typing import NDArray

from vrut_lite.geometry.colour import luminance
from vrut_lite.host import Host
from vrut_lite.kernel.messages import SetClock
from vrut_lite.numeric_types import BoolArray, Float32Array, FloatArray
from vrut_lite.pictures.display import display_picture
from vrut_lite.project import Project, daylight_inputs, setting_inputs, view_inputs
from vrut_lite.render.pyrender_backend import PyrenderBackend
from vrut_lite.scene.scene_state import SceneState
from vrut_lite.studio.open_kernel import open_host
from vrut_lite_lab.path_traced.truths import lit_by
from vrut_lite_lab.pictures.darkness import no_background
from vrut_lite_lab.pictures.drawing import Captioned, scene_project, sheet

_DRAWN, _SIZE, _SHOWN = ("street.toml", "work/indoor.glb"), (360, 225), 7
_DEGREE, _WHITE = 5, 0.01
_QUANTILES = (0.5, 0.95, 0.999)
HEADER = [
    "| scene, light | step | second difference | smooth | left |",
    "|---|---:|---:|---:|---:|",
]


class HourFilm:
    """The frames of an hour: all light, and all but the sun's own."""

    def __init__(self, scene: str, start: str, step_s: float):
        self.project: Project = scene_project(
            scene, size=_SIZE, at=f"2026-06-21T{start}", place="50.0755,14.4378,200", air=False
        )
        host = open_host()
        host.inject(*setting_inputs(self.project, host.kernel))
        host.inject(*daylight_inputs(self.project), *view_inputs(self.project))
        first = host.draw()
        self.ev100 = first.ev100
        gl = PyrenderBackend(host.gl)
        self.seen: BoolArray = _surfaces(gl, host.state)
        count = int(3600.0 / step_s) + 1
        self.whole = np.empty((count, *first.radiance.shape), np.float16)
        self.sunless = np.empty_like(self.whole)
        for number, state in enumerate(_played(host, self.project, count, step_s)):
            self.whole[number] = gl.draw(state).radiance
            self.sunless[number] = gl.draw(lit_by(state, "sky")).radiance
        gl.close()
        host.close()


def _played(host: Host, project: Project, count: int, step_s: float) -> Iterator[SceneState]:
    start = project.instant()
    for number in range(count):
        host.inject(SetClock(instant=start + timedelta(seconds=number * step_s)))
        host.settle()
        yield host.state


def _surfaces(gl: PyrenderBackend, state: SceneState) -> BoolArray:
    """Which pixels (h, w) show a surface."""
    bare = msgspec.structs.replace(no_background())
    return np.asarray(luminance(gl.draw(replace(state, background=bare)).radiance) > 0.0)


class Unsteadiness:
    """Rms over frames (h, w) of a film (T, h, w, 3), as shares of a pixel's light."""

    def __init__(self, film: Float32Array, seen: BoolArray):
        light = luminance(film.astype(np.float32))
        mean = light.mean(axis=0)
        light = light / (mean + 0.1 * mean[seen].mean())
        times = np.linspace(-1.0, 1.0, len(light))
        powers = np.polynomial.legendre.legvander(times, _DEGREE)
        flat = light.reshape(len(light), -1)
        smooth = (powers @ np.linalg.lstsq(powers, flat, rcond=None)[0]).reshape(light.shape)
        self.step = _rms(np.diff(light, axis=0))
        self.second = _rms(np.diff(light, 2, axis=0))
        self.smooth = _rms(np.diff(smooth, 2, axis=0))
        self.left = _rms(light - smooth)

    def cells(self, seen: BoolArray) -> str:
        """Of a table, at some quantiles of the pixels that show surfaces."""
        cells = []
        for found in (self.step, self.second, self.smooth, self.left):
            at = np.quantile(found[seen], _QUANTILES)
            cells.append(" / ".join(f"{100.0 * value:.3f}" for value in at) + " %")
        return " | ".join(cells)


def _rms(off: FloatArray) -> FloatArray:
    return np.asarray(np.sqrt(np.mean(off * off, axis=0)))


def strips(name: str, film: HourFilm) -> Iterator[Captioned]:
    """Print a line of the table for each film, and show it."""
    for told, frames in (("all light", film.whole), ("without the sun's own", film.sunless)):
        unsteady = Unsteadiness(frames, film.seen)
        print(f"| {name}, {told} | {unsteady.cells(film.seen)} |", flush=True)
        chosen = np.linspace(0, len(frames) - 1, _SHOWN).round().astype(int)
        for number in chosen:
            picture = display_picture(frames[number].astype(np.float32), film.ev100)
            yield f"{name} {number + 1} of {len(frames)}, {told}", picture
        grey = np.clip(unsteady.second / _WHITE, 0.0, 1.0) * film.seen
        yield "second difference, 1 % is white", _grey(grey)


def _grey(share: FloatArray) -> NDArray[np.uint8]:
    return np.repeat((255.0 * share).astype(np.uint8)[..., None], 3, axis=-1)


def main() -> None:
    """Print the table, and write the strips."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("strip", type=Path)
    parser.add_argument("scenes", nargs="*", default=_DRAWN)
    parser.add_argument("--step", type=float, default=30.0, help="seconds of the day, 30")
    parser.add_argument("--from", dest="start", default="07:00", help="local time, 07:00")
    chosen = parser.parse_args()
    print("\n".join(HEADER), flush=True)
    pictures: list[Captioned] = []
    for scene in chosen.scenes:
        film = HourFilm(scene, chosen.start, chosen.step)
        pictures += strips(Path(scene).stem, film)
    sheet(pictures, _SHOWN + 1).save(chosen.strip, quality=85)


if __name__ == "__main__":
    main()
