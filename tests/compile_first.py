"""Compiles the slowest kernels before the tests begin, side by side, and the tests themselves.

Workers that need a kernel at the same time would each compile it, and the first test to need one
would take half a minute. A second run finds them on disk.
"""

import os
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from vrut_lite import compiled_code

SOLVER = """
from vrut_lite.cli import main
import sys, tempfile
with tempfile.TemporaryDirectory() as folder:
    sys.argv = ["vrut-lite", "sky", "--sky", "bruneton_sky", "--size", "16", "-o",
                folder + "/sky.npz", "--at", "2026-06-21T12:00", "--place", "50,14"]
    main()
import numpy as np
from bruneton_sky.air_volume import air_volume
from bruneton_sky.presets import earth_spectral
from bruneton_sky.solver import solve
from vrut_lite.geometry.colour import SKYLIGHT_NM
air_volume(solve(earth_spectral(SKYLIGHT_NM), orders=3), 2.0, np.array([0.6, 0.8, 0.0]), 1e4)
"""
OTHERS = """
import numpy as np
from bruneton_sky import Atmosphere
from bruneton_sky.single_scattering_kernels import fast_scattered_without_phase
from clouds.module import make_layers
from clouds.settings import CloudSettings
from dynamic_skylight import HosekWilkieSky
from clouds.model.cloud_light import ClearLight
from clouds.model.cloud_view import clouds_seen, sun_share
half = np.array([0.5])
fast_scattered_without_phase(Atmosphere.earth(), 0.0, half, 0.5, half, 4)
layer = make_layers(CloudSettings(coverage=0.5))[1][0]
up, eye = (0.0, 1.0, 0.0), (0.0, 0.0, 0.0)
clouds_seen(layer, ClearLight(up, up, np.zeros((25, 3))), eye, np.array([up]), 0.01)
sun_share(layer, up, eye, 0.0)
HosekWilkieSky(turbidity=3.0, albedo=0.1, sun_elevation_rad=0.8).cube_map(size=16)
"""
# pytest rewrites each file of tests, which takes 10 s, and keeps it beside the file.
TESTS = """
import pytest
pytest.main(["--collect-only", "-q"])
"""

# Some 30 s of CPU.
LIGHT = """
import tempfile
from pathlib import Path
from light_stage import COARSE, WANT, LightStage, Shine, Show, box_file
stage = LightStage()
with tempfile.TemporaryDirectory() as folder:
    path = box_file(Path(folder))
    stage.tell(*COARSE, WANT, Show(path=str(path)), Shine(radiance=1.0, irradiance=1.0))
"""

AT_ONCE = 3
HERE = Path(__file__).parent


# numba makes many objects and few cycles: looking for these took a fifth of the time.
NO_COLLECTOR = "import gc; gc.disable()\n"


def run(code: str) -> None:
    """In a process of its own; a failure here is reported by a test, too."""
    # What an earlier run solved and kept would spare the kernels.
    with tempfile.TemporaryDirectory() as empty:
        # Folders of tests have the modules' names: the modules come first.
        path = os.pathsep.join([str(HERE.parent / "modules"), str(HERE)])
        environment = os.environ | {"XDG_CACHE_HOME": empty, "PYTHONPATH": path}
        command = [sys.executable, "-c", NO_COLLECTOR + code]
        subprocess.run(command, stdout=subprocess.DEVNULL, env=environment, check=False)


if __name__ == "__main__":
    compiled_code.share_kernels()
    # The longest first: whoever is done takes the next.
    with ThreadPoolExecutor(AT_ONCE) as pool:
        list(pool.map(run, (SOLVER, LIGHT, OTHERS, TESTS)))
