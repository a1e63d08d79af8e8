"""By how much polarisation changes reflections of the sky, in scenes of the house.

    python -m vrut_lite_lab.polarised_reflections

draws each scene with the sky's polarisation and without it, and prints how much the luminance of
pixels differs, by material: percent of the pixel's luminance, mean, mean of the size and largest,
and the same through polarisers upright and level.
"""

from collections.abc import Iterator
from dataclasses import replace
from math import degrees

import msgspec
import numpy as np

from vrut_lite.geometry.colour import luminance
from vrut_lite.host import Host
from vrut_lite.kernel.messages import SetClock
from vrut_lite.messages.sun import SunMoved
from vrut_lite.numeric_types import FloatArray
from vrut_lite.project import daylight_inputs, setting_inputs, view_inputs
from vrut_lite.scene.scene_state import SceneState
from vrut_lite_lab.pictures.drawing import scene_project

SCENES = ("large/terrain.toml", "street.toml", "pavilion.gltf", "spheres.glb", "sundial.toml")
HOURS = ("T12:30", "T18:00", "T20:30")
_DAY, _SIZE = "2026-06-21", (384, 240)
# Every third pixel in each direction is looked at.
_STEP, _FEWEST = 3, 20
_FILTERS_DEG = (None, 0.0, 90.0)


def changes(host: Host, state: SceneState) -> list[FloatArray]:
    """Relative change of luminance (h, w) by polarisation, without and through the filters."""

    def drawn(state: SceneState) -> FloatArray:
        return np.asarray(luminance(host.draw_state(state, still=True).radiance.astype(float)))

    plain = drawn(replace(state, polarisation=None))
    return [
        drawn(replace(state, polariser_deg=angle)) / np.maximum(plain, 1e-9) - 1.0
        for angle in _FILTERS_DEG
    ]


def rows(scene: str) -> Iterator[str]:
    """A line for each hour and material of which enough pixels change."""
    project = scene_project(scene, at=_DAY + HOURS[0], slots={"sky": "bruneton_sky"}, size=_SIZE)
    with Host() as host:
        host.inject(*setting_inputs(project, host.kernel), *daylight_inputs(project))
        host.inject(*view_inputs(project))
        host.settle()
        places = [(y, x) for y in range(1, _SIZE[1], _STEP) for x in range(1, _SIZE[0], _STEP)]
        hits = [host.surface_at_pixel(x, y) for y, x in places]
        names = np.array(["" if hit is None else hit.material for hit in hits])
        for hour in HOURS:
            moved = msgspec.structs.replace(project, at=_DAY + hour)
            host.inject(SetClock(instant=moved.instant()))
            host.settle()
            sun = host.kernel.last(SunMoved)
            assert sun is not None
            at = tuple(np.array(places).T)
            by_filter = [change[at] for change in changes(host, host.state)]
            for name in sorted(set(names) - {""}):
                seen = (names == name) & (by_filter[0] != 0.0)
                if seen.sum() >= _FEWEST:
                    figures = "  ".join(_figures(change[seen]) for change in by_filter)
                    sun_deg = degrees(sun.apparent_elevation_rad)
                    yield f"{scene:18} {name:22} sun {sun_deg:4.1f}  {seen.sum():5d}  {figures}"


def _figures(change: FloatArray) -> str:
    size = np.abs(change)
    return f"{100 * change.mean():+6.2f} {100 * size.mean():6.2f} {100 * size.max():6.1f}"


def main() -> None:
    """Print the table."""
    print("mean, mean size, largest (%): without a filter, at 0, at 90 degrees")
    for scene in SCENES:
        for row in rows(scene):
            print(row, flush=True)


if __name__ == "__main__":
    main()
