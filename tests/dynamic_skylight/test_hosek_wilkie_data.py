"""The committed tables are those of the wheel, and the package stays light."""

import subprocess
import sys
from pathlib import Path

import numpy as np
from dynamic_skylight.hosek_wilkie.coefficients import tables
from path_tracer_here import mitsuba_or_skip

from vrut_lite_lab import extract_hosek_wilkie as extract

ROOT = Path(__file__).parents[2]


def test_committed_tables_equal_the_wheels():
    """Extraction must not have touched a bit (sunsky_datasets.bin of the mitsuba wheel)."""
    mitsuba = mitsuba_or_skip()
    source = Path(mitsuba.__file__).parent / "data" / "sunsky" / "sunsky_datasets.bin"
    fields = extract.read_tensor_file(source.read_bytes())
    assert set(tables()) == set(extract.FIELDS)
    for name in extract.FIELDS:
        np.testing.assert_array_equal(tables()[name], fields[name])


def test_the_notice_of_the_authors_is_installed():
    """The 3-clause BSD notice must travel with the numbers."""
    notice = ROOT / "modules" / "dynamic_skylight" / "data" / "LICENSE.hosek_wilkie"
    text = notice.read_text()
    assert "Copyright (c) 2012 - 2013, Lukas Hosek and Alexander Wilkie" in text
    assert "Redistributions in binary form must reproduce the above copyright" in text


def test_importing_the_package_does_not_import_numba():
    """The compiler costs a third of a second that only the fast cube map has use for."""
    code = "import dynamic_skylight, sys; sys.exit('numba' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
