"""What the tests of the study share: the published framework's numbers, and the measurements."""

from pathlib import Path

import numpy as np
import pytest

from vrut_lite_lab.study.framework.measurements import read_measurements

ROOT = Path(__file__).parents[3]
SHARED = ROOT.parent / "shared" / "data"


@pytest.fixture(scope="session")
def reference():
    """Computed with the program of Bruneton 2016; its entry `notes` says how."""
    with np.load(ROOT / "tests" / "data" / "clear_sky_framework_reference.npz") as arrays:
        return {name: arrays[name] for name in arrays.files}


def shared_file(name):
    """A file of measurements, which the project does not carry."""
    path = SHARED / name
    if not path.exists():
        pytest.skip(f"the measurements of Kider et al. 2014 are not here: no {name}")
    return path


@pytest.fixture(scope="session")
def measured_skies():
    """Fifteen skies measured on 27 May 2013."""
    return read_measurements(shared_file("kider_2013-05-27.npz"))


@pytest.fixture(scope="session")
def one_scan():
    """The archive of the scan of 11:45, as published."""
    return shared_file("2013-05-27___11.45.00.7z")
