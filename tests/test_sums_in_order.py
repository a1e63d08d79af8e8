"""Kernels make the same digits in every process, so that journals compare them by digest."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
# Digests of what the solver leaves and of what is made from it, in this process.
MAKE = """
import hashlib
import numpy as np
from bruneton_sky.air_volume import air_volume
from bruneton_sky.background import background_cube, surroundings
from bruneton_sky.presets import earth_hazy
from bruneton_sky.solver import solve
from vrut_lite.geometry.colour import SKYLIGHT_NM
field, sun = solve(earth_hazy(SKYLIGHT_NM), orders=4), np.array([0.6, 0.8, 0.0])
cube = background_cube(surroundings(field, 3000.0, sun), 16)
air = air_volume(field, 2.0, sun, 1e4).light.values
for made in (field.mie, field.rayleigh, cube, air):
    print(hashlib.sha256(np.ascontiguousarray(made).tobytes()).hexdigest())
"""


def test_no_kernel_lets_sums_be_reordered() -> None:
    """`fastmath` is `vrut_lite.njit.SUMS_IN_ORDER` wherever a module uses it."""
    texts = [path.read_text("utf-8") for path in (ROOT / "modules").rglob("*.py")]
    chosen = [value for text in texts for value in re.findall(r'fastmath"?[=:]\s*([^,)}]+)', text)]
    assert len(chosen) > 3
    assert set(chosen) == {"SUMS_IN_ORDER"}


@pytest.mark.long
def test_kernels_compiled_here_and_loaded_elsewhere_make_the_same_digits(tmp_path: Path) -> None:
    """One process compiles all kernels, the next finds them compiled; every digest is equal."""
    compiling, loading = (_digests(tmp_path) for _ in range(2))
    assert list(tmp_path.rglob("*.nbc"))
    assert compiling == loading


def _digests(cache: Path) -> str:
    done = subprocess.run(
        [sys.executable, "-c", MAKE],
        env=os.environ | {"NUMBA_CACHE_DIR": str(cache)},
        capture_output=True,
        text=True,
        check=True,
    )
    return done.stdout
