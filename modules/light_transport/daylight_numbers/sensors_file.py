"""Sensors from a CSV file: x, y, z in metres, and a direction where it is not straight up."""

import csv
from pathlib import Path

import numpy as np

from light_transport.daylight_numbers.sensors import Sensors, free_sensors
from vrut_lite.errors import UserError

MOST_SENSORS = 100_000
_MOST_BYTES = 64 << 20
_UP = [0.0, 1.0, 0.0]


def read_sensors(path: str | Path) -> Sensors:
    """Points in the scene's axes (y up), a row each: x,y,z or x,y,z,dx,dy,dz.

    A heading may stand first.

    Raises:
        UserError: the file cannot be read, or a row is no point.
    """
    file = Path(path)
    try:
        if file.stat().st_size > _MOST_BYTES:
            raise UserError(f"the sensors {file} are more than {_MOST_BYTES >> 20} MB")
        text = file.read_text(encoding="utf-8")
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or error
        raise UserError(f"cannot read the sensors {file}: {reason}") from None
    rows = [row for row in csv.reader(text.splitlines()) if row and not row[0].startswith("#")]
    if rows and _is_heading(rows[0]):
        rows = rows[1:]
    if len(rows) > MOST_SENSORS:
        raise UserError(f"{file} has {len(rows):,} sensors: at most {MOST_SENSORS:,} are computed")
    numbers = np.empty((len(rows), 6))
    for line, row in enumerate(rows):
        if len(row) not in (3, 6):
            raise UserError(
                f"sensor {line + 1} of {file} has {len(row)} numbers: give x,y,z or x,y,z,dx,dy,dz"
            )
        try:
            values = [float(value) for value in row]
        except ValueError:
            raise UserError(
                f"sensor {line + 1} of {file} is no numbers: {','.join(row)[:80]}"
            ) from None
        numbers[line] = values if len(values) == 6 else values + _UP
    return free_sensors(numbers[:, :3], numbers[:, 3:], str(file))


def _is_heading(row: list[str]) -> bool:
    try:
        float(row[0])
    except ValueError:
        return True
    return False
