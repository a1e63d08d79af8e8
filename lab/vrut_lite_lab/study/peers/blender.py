"""Blender's four skies, by Cycles in a process of its own (the package bpy, of Python 3.11)."""

import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import OpenEXR

from vrut_lite.atmosphere.aerosol import turbidity_of_optical_depth
from vrut_lite.atmosphere.equal_haze import equal_sky
from vrut_lite_lab.study.peers.airs import DEPTH, GROUND_ALBEDO
from vrut_lite_lab.study.peers.peer import NotHere, PeerShot
from vrut_lite_lab.study.peers.views import ON_GROUND, SPACE_M, TIMED, SkyViewpoint, of_picture

VARIABLE = "BLENDER_PYTHON"
_LONGEST_S = 1800.0
# The top of its single scattering lies at 60 km, and it has nothing below the horizon.
_HIGHEST_M = {"MULTIPLE_SCATTERING": SPACE_M, "SINGLE_SCATTERING": 60_000.0}


def blender_python() -> str:
    """A Python that has bpy: the one of the environment, or this one.

    Raises:
        NotHere: there is none.
    """
    named = os.environ.get(VARIABLE)
    if named:
        return named
    if find_spec("bpy") is None:
        raise NotHere(f"Blender is not installed: set {VARIABLE} to a Python that has bpy")
    return sys.executable


@dataclass
class BlenderSky:
    """One of the kinds of Blender's sky texture."""

    kind: str
    name: str
    title: str
    air: str
    cannot: str
    grey: bool = False

    def shots(self, views: Sequence[SkyViewpoint]) -> dict[SkyViewpoint, PeerShot]:
        """From where it has a sky; analytic kinds from the ground, the sun up."""
        wanted = [view for view in views if self._can(view)]
        with tempfile.TemporaryDirectory() as name:
            jobs = [self._job(view, Path(name) / f"{n}.exr") for n, view in enumerate(wanted)]
            spent_s = _rendered(jobs, Path(name) / "jobs.json")
            return {
                view: PeerShot(of_picture(_pixels(job["file"]), view), seconds)
                for view, job, seconds in zip(wanted, jobs, spent_s, strict=True)
            }

    def prepared_s(self) -> float:
        """Nothing: all is part of the picture."""
        return 0.0

    def _can(self, view: SkyViewpoint) -> bool:
        if self.kind in _HIGHEST_M:
            return view.altitude_m <= _HIGHEST_M[self.kind]
        return view in ON_GROUND and view.sun_deg >= 0.0

    def _job(self, view: SkyViewpoint, file: Path) -> dict[str, object]:
        turbidity = turbidity_of_optical_depth(DEPTH)
        if self.kind == "HOSEK_WILKIE":
            turbidity = equal_sky(DEPTH, float(np.radians(view.sun_deg))).turbidity
        return {
            "file": str(file),
            "kind": self.kind,
            "sun_deg": view.sun_deg,
            "altitude_m": view.altitude_m,
            "turbidity": turbidity,
            "albedo": GROUND_ALBEDO,
            "rounds": 3 if view == TIMED else 1,
        }


BLENDER = (
    BlenderSky(
        "MULTIPLE_SCATTERING",
        "blender-multiple",
        "Blender 5, multiple scattering",
        "blender-multiple",
        "ground seen from aloft; other aerosols, fog",
    ),
    BlenderSky(
        "SINGLE_SCATTERING",
        "blender-single",
        "Blender 5, single scattering",
        "blender-single",
        "light scattered again, the ground; below the horizon; space",
    ),
    BlenderSky(
        "HOSEK_WILKIE",
        "blender-hosek",
        "Blender 5, Hosek-Wilkie",
        "continental",
        "a sun below 0°; observers aloft; ozone, aerosols, layers",
    ),
    BlenderSky(
        "PREETHAM",
        "blender-preetham",
        "Blender 5, Preetham",
        "continental",
        "a sun below 0°; observers aloft; ozone, aerosols, layers, the ground",
    ),
)


def _rendered(jobs: Sequence[dict[str, object]], list_file: Path) -> list[float]:
    """CPU seconds of each job, whose pictures then lie in their files."""
    list_file.write_text(json.dumps(jobs), encoding="utf-8")
    script = Path(__file__).with_name("in_blender.py")
    try:
        done = subprocess.run(
            [blender_python(), str(script), str(list_file)],
            capture_output=True,
            text=True,
            timeout=_LONGEST_S,
            check=False,
        )
    except OSError as error:
        raise NotHere(f"{VARIABLE} cannot be run: {error.strerror or error}") from None
    except subprocess.TimeoutExpired:
        raise NotHere(f"Blender did not end within {_LONGEST_S:g} s") from None
    told = [line for line in done.stdout.splitlines() if line.startswith('{"version"')]
    if done.returncode or not told:
        last = (done.stderr.strip().splitlines() or ["no message"])[-1]
        raise NotHere(f"Blender did not run: {last}")
    return list(json.loads(told[-1])["cpu_s"])


def _pixels(path: object) -> np.ndarray:
    with OpenEXR.File(str(path)) as file:
        (channel,) = (c for name, c in file.channels().items() if name.startswith("RGB"))
        return np.asarray(channel.pixels[..., :3], np.float64)
