"""Clouds of three coverages at noon and at dusk, on one sheet, and what their passes cost.

    python -m vrut_lite_bench.cloud_pictures SHEET.jpg

A valley of the Alps from the ground, bruneton_sky at turbidity 3, a west wind. Printed is a
Markdown table of process CPU time (all threads of it, as llvmpipe draws with several) for a frame
of 480 x 300 pixels: the least of a few, each with another sun.
"""

import sys
import time
from collections import defaultdict
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import msgspec
import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

from vrut_lite.host import Host
from vrut_lite.kernel.messages import SetSetting
from vrut_lite.project import (
    CameraView,
    Project,
    daylight_inputs,
    load_project,
    setting_inputs,
    view_inputs,
)
from vrut_lite.render.gl_environment import import_pyrender

import_pyrender()
from OpenGL import GL  # noqa: E402  (pyrender's repairs must come first)

SCENES = Path(__file__).resolve().parents[2] / "scenes"
COVERAGES = (0.25, 0.5, 0.8)
HOURS = {"noon": "2026-06-28T13:00", "dusk": "2026-06-28T20:40"}
PASSES = ("cloud shadows", "clouds", "mesh", "sky")
_SKY = "bruneton_sky"
_SIZE, _CAPTION_PX, _REPEATS = (480, 300), 18, 3


def project_of() -> Project:
    """The valley, or the sundial where it has not been made."""
    terrain = SCENES / "large" / "terrain.toml"
    project = load_project(terrain if terrain.exists() else SCENES / "sundial.toml")
    eye = project.camera.eye_m if project.camera else (0.0, 2.0, 8.0)
    target = (eye[0] - 1000.0, eye[1] + 130.0, eye[2] - 50.0)
    return msgspec.structs.replace(
        project,
        slots={"sky": _SKY},
        settings={_SKY: {"turbidity": 3.0}, "clouds": {"base_m": 2300.0}},
        camera=CameraView(eye_m=eye, target_m=target, vertical_field_of_view_deg=50.0),
        size=_SIZE,
    )


class Studio:
    """A host with the scene open, and a watch on its passes."""

    def __init__(self, host: Host):
        self._host, self._project = host, project_of()
        self._spent_s: dict[str, float] = {}
        host.measure_passes(self._measure)
        project = self._project
        host.inject(*setting_inputs(project, host.kernel), *view_inputs(project))

    def draw(self, at: str, coverage: float, still: bool = True) -> NDArray[np.uint8]:
        """The picture (h, w, 3) at an hour."""
        project = msgspec.structs.replace(self._project, at=at)
        clouds = SetSetting(module="clouds", name="coverage", value=coverage)
        self._host.inject(clouds, *daylight_inputs(project))
        return self._host.draw(still).display

    def cost_s(self, coverage: float, still: bool) -> dict[str, float]:
        """CPU time of each pass, the least of a few frames; each has another sun."""
        least: dict[str, float] = defaultdict(lambda: np.inf)
        for minute in range(0, 10 * _REPEATS, 10):
            self._spent_s.clear()
            self.draw(f"{HOURS['noon'][:-2]}{minute:02}", coverage, still)
            for name, spent in self._spent_s.items():
                least[name] = min(least[name], spent)
        return least

    @contextmanager
    def _measure(self, name: str) -> Iterator[None]:
        GL.glFinish()
        begun = time.process_time()
        yield
        GL.glFinish()
        self._spent_s[name] = time.process_time() - begun


def cost_table(studio: Studio) -> list[str]:
    """Lines of a Markdown table, ms of each pass."""
    lines = ["| coverage | still | " + " | ".join(PASSES) + " |", "|---" * (len(PASSES) + 2) + "|"]
    for coverage in (0.0, *COVERAGES):
        for still in (True, False):
            cost = studio.cost_s(coverage, still)
            cells = [f"{1e3 * cost.get(name, 0.0):.0f}" for name in PASSES]
            lines.append(f"| {coverage:g} | {'yes' if still else 'no'} | {' | '.join(cells)} |")
    return lines


def sheet(studio: Studio) -> Image.Image:
    """All pictures, captioned, an hour a row."""
    width, height = _SIZE
    pitch = height + _CAPTION_PX
    paper = Image.new("RGB", (width * len(COVERAGES), pitch * len(HOURS)), (24, 24, 24))
    pen, font = ImageDraw.Draw(paper), ImageFont.load_default(12)
    for i, (hour, at) in enumerate(HOURS.items()):
        for j, coverage in enumerate(COVERAGES):
            picture = Image.fromarray(studio.draw(at, coverage))
            paper.paste(picture, (j * width, i * pitch + _CAPTION_PX))
            text = f"{hour}, {at[11:]}, coverage {coverage:g}"
            pen.text((j * width + 4, i * pitch + 2), text, (230, 230, 230), font=font)
    return paper


def main(path: Path) -> None:
    """Draw all, write the sheet, print the costs."""
    with Host() as host:
        studio = Studio(host)
        sheet(studio).save(path, quality=85)
        print("\n".join(cost_table(studio)))


if __name__ == "__main__":
    main(Path(sys.argv[1]))
