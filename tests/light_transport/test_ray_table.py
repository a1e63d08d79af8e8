"""Entries of the table of rays: a column and a count in one number."""

import numpy as np
import pytest
from light_transport.rays.ray_table import (
    LARGE_BITS,
    columns_and_rays,
    empty_rows,
    with_columns,
)


@pytest.mark.parametrize("columns", [1_000, 100_000])
def test_no_ray_is_lost_when_columns_change(columns):
    """An entry of 32 bits says 128 rays, one of 16 bits four: then it becomes many."""
    rays = np.array([100, 27, 128, 1], np.int32)
    met = np.array([5, 900, 901, 7], np.int32)
    rows = empty_rows(0, 2)._replace(
        start=np.array([0, 3, 4]),
        entry=met | (rays - 1) << LARGE_BITS,
        valid=np.array([255, 1], np.int32),
    )
    new_column = np.arange(1_000, dtype=np.int32)
    new_column[901] = 900
    new_column[-1] = columns - 1
    made = with_columns(rows, new_column)
    assert made.entry.dtype == (np.uint16 if columns == 1_000 else np.int32)
    column, count = columns_and_rays(made.entry)
    row = np.repeat([0, 1], np.diff(made.start))
    totals = {
        (r, c): count[(row == r) & (column == c)].sum()
        for r, c in zip(row.tolist(), column.tolist(), strict=True)
    }
    assert totals == {(0, 5): 100, (0, 900): 155, (1, 7): 1}
    assert made.nodes.tolist() == [(column[row == 0] == 5).sum(), 1]
