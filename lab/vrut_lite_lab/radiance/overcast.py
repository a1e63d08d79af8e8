"""Daylight factors at sensors against Radiance's, live: overcast skies, and a room behind glass.

    .venv/bin/python -m vrut_lite_lab.radiance.overcast [--rays N]

CIE's sky types 16 and 1 in three scenes and in a room whose window has one clear pane, one tinted,
two clear or two tinted ones; that room in the sun too. Between two panes Radiance mixes both
polarisations: these differ by some 4 %. It needs the extra `radiance`.
"""

import argparse
from collections.abc import Mapping
from pathlib import Path

import numpy as np
from daylight_numbers.matrix.sensors import free_sensors
from daylight_numbers.now import cie_hour, hour_at_sensors
from daylight_numbers.opened_scene import OpenedScene
from daylight_numbers.work import work_of
from light_transport.surfaces.surfaces import surfaces_of

from vrut_lite.geometry.colour import LUMENS_PER_WATT, luminance
from vrut_lite.messages.glazing import Glazing
from vrut_lite.numeric_types import FloatArray
from vrut_lite.project import project_of_path
from vrut_lite_lab.radiance.grids import GRIDS, MeasuredPoints
from vrut_lite_lab.radiance.irradiance import RadianceEffort, both_by_radiance

# Above what stands in the room.
GLAZED = MeasuredPoints("glazed_room", (-1.7, -1.7, 1.7, 1.7), 1.4)
PANES: dict[str, Mapping[str, Glazing]] = {
    "one clear pane": {"glass": Glazing(0.923, panes=1)},
    "one pane of 0.6": {"glass": Glazing(0.6, panes=1)},
    "two clear panes": {"glass": Glazing(0.857)},
    "two panes of 0.72": {"glass": Glazing(0.72)},
}
_TOLERANCE, _GROUND_ALBEDO = 0.1, 0.2


def compared(
    grid: MeasuredPoints, effort: RadianceEffort, glazing: Mapping[str, Glazing] | None = None
) -> dict[str, FloatArray]:
    """Differences (P,) at a grid's points, shares of their mean, by what lights the scene."""
    opened = OpenedScene(project_of_path(str(Path("scenes") / grid.file)))
    try:
        up = np.tile([0.0, 1.0, 0.0], (len(grid.places_m), 1))
        sensors = free_sensors(grid.places_m, up, grid.scene)
        work = work_of(opened.scene, sensors, _TOLERANCE, glazing=glazing)
        hours = {f"CIE {sky}": cie_hour(sky, _GROUND_ALBEDO) for sky in ("16", "1")}
        if glazing:
            hours["sun"] = opened.hour()
        surfaces = surfaces_of(opened.scene)
    finally:
        opened.close()
    found = {}
    for name, hour in hours.items():
        ours = hour_at_sensors(work.transport, work.glass, work.operator, sensors, hour).total
        whole, _ = both_by_radiance(surfaces, hour, grid.places_m, up, effort, work.glass)
        lux = luminance(whole) * LUMENS_PER_WATT
        found[name] = np.asarray((ours - lux) / lux.mean())
    return found


def main() -> None:
    """Print a line for each scene and light."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition(":")[0])
    parser.add_argument("--rays", type=int, default=8_192)
    effort = RadianceEffort(parser.parse_args().rays)
    cases: list[tuple[MeasuredPoints, str, Mapping[str, Glazing] | None]] = [
        *((GLAZED, name, glazing) for name, glazing in PANES.items()),
        *((grid, "open", None) for grid in GRIDS[:3]),
    ]
    for grid, panes, glazing in cases:
        for light, error in compared(grid, effort, glazing).items():
            rms = float(np.sqrt(np.mean(error**2)))
            print(
                f"{grid.scene}, {panes}, {light}: {error.mean():+.2%} mean, {rms:.2%} rms, "
                f"{np.abs(error).max():.2%} most",
                flush=True,
            )


if __name__ == "__main__":
    main()
