"""Order and file names of the samples in a scan by the instrument of Kider et al. 2014.

Its azimuths count counter-clockwise from north: the usual one is their negative.
"""

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from vrut_lite_lab.study.framework.directions import COUNT, ring_order

# The rings in the order of scanning, and whether the file azimuth rose or fell meanwhile.
_SWEEPS = ((4, 1), (3, -1), (2, 1), (1, -1))
# As the file names have them, with up to six digits.
_ELEVATIONS = {4: "12.1151", 3: "33.749", 2: "53.3665", 1: "71.9187"}


@lru_cache(maxsize=1)
def scan_directions() -> tuple[tuple[str, str], ...]:
    """File azimuth and elevation in deg, as written in the names, of the samples 0 to 80."""
    names = []
    for ring, sense in _SWEEPS:
        count = 8 * ring
        steps = range(count) if sense > 0 else range(count - 1, -1, -1)
        names += [(str(360.0 / count * step), _ELEVATIONS[ring]) for step in steps]
    return (*names, ("0.0", "90.0"))


@lru_cache(maxsize=1)
def sample_of_direction() -> NDArray[np.int64]:
    """The sample (81,) that was taken in each of the `directions`."""
    samples = np.zeros(COUNT, dtype=np.int64)
    rings, first = ring_order(), 0
    for ring, sense in _SWEEPS:
        count = 8 * ring
        # Of the usual azimuth 0, 1, 2 ... steps: the file's azimuth has the opposite sense.
        file_step = -np.arange(count) % count
        samples[rings[ring]] = first + (file_step if sense > 0 else count - 1 - file_step)
        first += count
    samples[rings[0]] = first
    return samples
