"""The committed tables of Hosek and Wilkie are those of mitsuba's wheel."""

from pathlib import Path

import numpy as np
from dynamic_skylight.hosek_wilkie.coefficients import tables
from path_tracer_here import mitsuba_or_skip

from vrut_lite_lab import extract_hosek_wilkie as extract


def test_committed_tables_equal_the_wheels():
    """Extraction must not have touched a bit (sunsky_datasets.bin of the mitsuba wheel)."""
    mitsuba = mitsuba_or_skip()
    source = Path(mitsuba.__file__).parent / "data" / "sunsky" / "sunsky_datasets.bin"
    fields = extract.read_tensor_file(source.read_bytes())
    assert set(tables()) == set(extract.FIELDS)
    for name in extract.FIELDS:
        np.testing.assert_array_equal(tables()[name], fields[name])
