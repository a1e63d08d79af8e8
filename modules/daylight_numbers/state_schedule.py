"""Schedules of states: a CSV file of 8,760 hours, or of 12 months by 24 hours.

Numbers are those of states, from 0; hours are in standard time, the first from midnight to one.
"""

import csv
from datetime import date, timedelta
from pathlib import Path

import numpy as np

from daylight_numbers.year.year_light import DAYS, HOURS, YEAR
from vrut_lite.errors import UserError
from vrut_lite.numeric_types import IntArray
from vrut_lite.text_files import read_text

_MONTHS = 12
_MOST_BYTES = 4 << 20


def read_schedule(path: str | Path, states: int) -> IntArray:
    """The state (8760,) of each hour of the year, of so many states.

    The file has 8,760 rows of one number, or 12 rows, months, of 24 numbers; remarks begin with #.

    Raises:
        UserError: it cannot be read, has another shape, or a cell is not the number of a state.
    """
    file = Path(path)
    text = read_text(file, "the schedule", _MOST_BYTES)
    reader = csv.reader(text.split("\n"))
    rows = [
        (reader.line_num, [cell.strip() for cell in row])
        for row in reader
        if any(cell.strip() for cell in row) and not row[0].lstrip().startswith("#")
    ]
    by_month = len(rows) == _MONTHS
    if len(rows) not in (_MONTHS, DAYS * HOURS):
        raise UserError(
            f"the schedule {file} has {len(rows):,} rows: give 12, months of 24 hours, or 8,760 "
            "hours"
        )
    width = HOURS if by_month else 1
    found = np.empty((len(rows), width), np.int64)
    for n, (line, row) in enumerate(rows):
        if len(row) != width:
            raise UserError(f"line {line} of {file} has {len(row)} numbers: give {width}")
        for column, cell in enumerate(row):
            if not (cell.isascii() and cell.isdigit() and int(cell) < states):
                raise UserError(
                    f"line {line} of {file} has {cell[:20]!r}: give a state from 0 to {states - 1}"
                )
            found[n, column] = int(cell)
    if not by_month:
        return found[:, 0]
    first = date(YEAR, 1, 1)
    month = [(first + timedelta(days=day)).month - 1 for day in range(DAYS)]
    return found[month].reshape(-1)
