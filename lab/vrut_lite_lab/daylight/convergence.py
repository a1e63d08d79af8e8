"""Draws how daylight factors of a room converge: against rays of sensors, and against patches.

    .venv/bin/python -m vrut_lite_lab.daylight.convergence docs/pictures/daylight_convergence.webp

Errors are differences from the finest of each, rms, as shares of the mean.
"""

import sys
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from daylight_numbers.glazing.glass import no_glass
from daylight_numbers.matrix.operator import operator_of
from daylight_numbers.matrix.sensors import Sensors, free_sensors
from daylight_numbers.now import cie_hour, daylight_factor
from daylight_numbers.opened_scene import OpenedScene
from daylight_numbers.work import traced_transport
from light_transport.transport import SceneTransport
from matplotlib.ticker import FixedLocator, FuncFormatter, NullLocator

from vrut_lite.numeric_types import FloatArray
from vrut_lite.project import Project
from vrut_lite_lab.radiance.grids import GRIDS

_TOLERANCE = 0.1
_RAYS = (0.16, 0.08, 0.04, 0.02, 0.01, 0.0025)
# Of the texels of that tolerance.
_TEXELS = (1 / 64, 1 / 16, 1 / 4, 1.0)
_FINE_RAYS = 0.01


def main(picture: str) -> None:
    """Compute and draw."""
    opened = OpenedScene(Project(scene="scenes/work/indoor.glb"))
    places = GRIDS[0].places_m[::3]
    sensors = free_sensors(places, np.tile([0.0, 1.0, 0.0], (len(places), 1)), "desks")
    bakes = [traced_transport(opened.scene, _TOLERANCE, share) for share in _TEXELS]
    opened.close()

    by_rays = [_factors(bakes[-1], sensors, tolerance) for tolerance in _RAYS]
    by_patches = [
        (
            len(np.unique(transport.cache.patch_transfer.column)),
            _factors(transport, sensors, _FINE_RAYS)[1],
        )
        for transport in bakes
    ]
    figure, (left, right) = plt.subplots(1, 2, figsize=(8.0, 3.2), constrained_layout=True)
    for axes, found, name in (
        (left, by_rays, "rays of a sensor"),
        (right, by_patches, "patches of the scene"),
    ):
        finest = found[-1][1]
        x = [number for number, _ in found[:-1]]
        y = [
            100.0 * np.sqrt(np.mean((value - finest) ** 2)) / finest.mean()
            for _, value in found[:-1]
        ]
        print(name, [(f"{a:,.0f}", f"{b:.2f} %") for a, b in zip(x, y, strict=True)])
        axes.loglog(x, y, "o-", color="#2a6f97")
        axes.set_xlabel(f"{name} (against {found[-1][0]:,.0f})")
        axes.set_ylabel("rms error, % of the mean")
        for axis, values in ((axes.xaxis, x), (axes.yaxis, y)):
            axis.set_major_locator(FixedLocator(values[:: 2 if len(values) > 4 else 1]))
            axis.set_major_formatter(
                FuncFormatter(lambda value, _: f"{value:,.0f}" if value > 10.0 else f"{value:.2f}")
            )
            axis.set_minor_locator(NullLocator())
        axes.grid(True, which="both", alpha=0.25)
    figure.savefig(Path(picture), dpi=120)


def _plain(value: float, _: object) -> str:
    return f"{value:,.0f}" if value > 10.0 else f"{value:.2f}"


def _factors(
    transport: SceneTransport, sensors: Sensors, tolerance: float
) -> tuple[float, FloatArray]:
    """Rays of a sensor, and daylight factors (P,) under CIE's traditional overcast sky."""
    glass = no_glass(len(transport.tree.order))
    operator = operator_of(transport, glass, sensors, tolerance)
    return operator.rays, daylight_factor(transport, glass, operator, sensors, cie_hour("16", 0.2))[
        0
    ]


if __name__ == "__main__":
    main(sys.argv[1])
