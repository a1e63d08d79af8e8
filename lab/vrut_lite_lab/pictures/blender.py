"""The pavilion in Cycles under the add-on's light, above our path tracer's picture of it.

    BLENDER_PYTHON=PYTHON python -m vrut_lite_lab.pictures.blender SHEET.jpg

PYTHON has the package bpy, whose numpy is older than ours. Takes ten minutes of CPU.
"""

import argparse
import os
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
import OpenEXR
from numpy.typing import NDArray

from vrut_lite.messages.picture import SetExposure
from vrut_lite.pictures.display import developed
from vrut_lite.pictures.exposure import automatic_ev100
from vrut_lite_lab.checkout import ROOT
from vrut_lite_lab.pictures.drawing import SCENES, Captioned, sheet

HOURS = {"7": "07:00", "12.5": "12:30", "20": "20:00"}
_ADDON = ROOT / "integrations" / "blender" / "package.py"
_PROGRAM = str(Path(sys.executable).with_name("vrut-lite"))
_SCENE, _QUALITY = SCENES / "pavilion.gltf", 85


def trace(folder: Path) -> None:
    """Both engines' pictures of all hours, as EXR."""
    archive = folder / "addon.zip"
    subprocess.run([sys.executable, _ADDON, archive], check=True)
    script = Path(__file__).with_name("in_blender.py")
    blender: list[str | Path] = [os.environ["BLENDER_PYTHON"], script, archive]
    blender += [_PROGRAM, _SCENE, folder, *HOURS]
    subprocess.run(blender, check=True)
    for hour, time in HOURS.items():
        light = ["--at", f"2026-06-21T{time}", "--place", "50.0755,14.4378", "--haze", "0.2"]
        subprocess.run(
            [_PROGRAM, "render", _SCENE, "-o", folder / f"ours_{hour}.exr", *light, "--albedo",
             "0.2", "--engine", "path-tracer", "--spp", "64", "--size", "480x300"],
            check=True,
        )  # fmt: skip


def compared(folder: Path) -> list[Captioned]:
    """Cycles above, ours below, with the exposure of ours."""
    above: list[Captioned] = []
    below: list[Captioned] = []
    for hour, time in HOURS.items():
        theirs, ours = (_radiance(folder / f"{who}_{hour}.exr") for who in ("cycles", "ours"))
        ev100 = automatic_ev100(ours)
        exposure = SetExposure(mode="manual", ev100=ev100)
        above.append((f"Cycles, {time}, EV {ev100:.1f}", developed(theirs, exposure).display))
        below.append(("vrut_lite's path tracer", developed(ours, exposure).display))
    return above + below


def _radiance(path: Path) -> NDArray[np.float32]:
    """Pixels (h, w, 3) of a file with the channels RGB or RGBA."""
    with OpenEXR.File(str(path)) as file:
        (channel,) = (c for name, c in file.channels().items() if name.startswith("RGB"))
        return np.ascontiguousarray(channel.pixels[..., :3], np.float32)


def main() -> None:
    """Draw the sheet."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("sheet", type=Path)
    wanted = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        trace(Path(folder))
        sheet(compared(Path(folder)), len(HOURS)).save(wanted.sheet, quality=_QUALITY)


if __name__ == "__main__":
    main()
