"""Numbers of sensors as CSV and npz files: a row or an entry each."""

import csv
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from light_transport.daylight_numbers.sensors import Sensors
from vrut_lite.numeric_types import FloatArray
from vrut_lite.write_atomic import atomic_output


def write_tables(folder: Path, sensors: Sensors, numbers: Mapping[str, FloatArray]) -> None:
    """Write `sensors.csv` and `sensors.npz`; columns (P,) are named with their units.

    Raises:
        UserError: a file cannot be written.
    """
    names = ["plane", "x_m", "y_m", "z_m", "direction_x", "direction_y", "direction_z", *numbers]
    columns = [
        [sensors.names[plane] for plane in sensors.plane],
        *(sensors.places_m.T),
        *(sensors.normals.T),
        *numbers.values(),
    ]
    with atomic_output(folder / "sensors.csv") as beside, beside.open("w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(names)
        for row in zip(*columns, strict=True):
            writer.writerow([v if isinstance(v, str) else f"{float(v):.6g}" for v in row])
    with atomic_output(folder / "sensors.npz") as beside, beside.open("wb") as stream:
        arrays: dict[str, Any] = {
            "plane": sensors.plane,
            "plane_names": np.array(sensors.names),
            "places_m": sensors.places_m,
            "directions": sensors.normals,
            **numbers,
        }
        np.savez_compressed(stream, **arrays)
