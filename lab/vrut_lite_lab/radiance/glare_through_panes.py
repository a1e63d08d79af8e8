"""Glare through measured panes, beside evalglare of Radiance's pictures, live.

    .venv/bin/python -m vrut_lite_lab.radiance.glare_through_panes [--pixels N]

An eye in the glazed room of `overcast` looks at its window, which has the glazings of
`three_phase`: under CIE's overcast sky and in an hour with sun, which does not shine into the eye.
Radiance draws what the eye sees by `rpict` and the material `aBSDF` with the same file. It needs
the extra `radiance`.
"""

import argparse
import tempfile
from pathlib import Path
from typing import NamedTuple

import numpy as np
from daylight_numbers.glare.eyes import eyes_of, glare_now
from daylight_numbers.matrix.sensors import free_sensors
from daylight_numbers.now import cie_hour
from daylight_numbers.opened_scene import OpenedScene
from daylight_numbers.work import work_of
from light_transport.hour.illumination import Illumination
from light_transport.surfaces.surfaces import Surfaces, surfaces_of

from vrut_lite.geometry.colour import LUMENS_PER_WATT
from vrut_lite.messages.glazing import GlazingFile
from vrut_lite.numeric_types import BoolArray, FloatArray
from vrut_lite.project import project_of_path
from vrut_lite_lab.radiance.irradiance import run_in
from vrut_lite_lab.radiance.overcast import GLAZED
from vrut_lite_lab.radiance.scene_files import turned, write_scene, write_sky, write_sun
from vrut_lite_lab.radiance.three_phase import (
    GROUND_ALBEDO,
    MATERIAL,
    MEASURED,
    glazings,
    pane_triangles,
    window_of,
    without,
)
from vrut_lite_lab.radiance.venetian import window_xml_of

_TOLERANCE, _PIXELS = 0.1, 160
_FISHEYE = ("-vta", "-vh", "180", "-vv", "180")
# Effort of a picture: bounces and rays, no interpolation between far places, sharp lobes.
_EFFORT = ("-ab", "6", "-ad", "1024", "-lw", "1e-4", "-aa", "0.1", "-ar", "256", "-as", "256",
           "-st", "0", "-ps", "1", "-dj", "0", "-ds", "0")  # fmt: skip
# Lumens in a watt of Radiance's, by which evalglare reads a picture.
_RADIANCE_LUMENS = 179.0


class GlareCase(NamedTuple):
    """DGP of one glazing and light by ours and by evalglare."""

    glazing: str
    light: str
    ours: float
    theirs: float


def compared_glare(names: tuple[str, ...], pixels: int = _PIXELS) -> list[GlareCase]:
    """Compare some glazings under both lights, and print a line for each."""
    opened = OpenedScene(project_of_path(GLAZED.file))
    try:
        scene, sunny = opened.scene, opened.hour()
    finally:
        opened.close()
    surfaces, is_pane = surfaces_of(scene), pane_triangles(scene)
    window_m = surfaces.corners_m[is_pane].mean(axis=(0, 1)) + surfaces.centre_m
    eye_m = np.array([-0.2 * window_m[0], 1.2, 0.0])
    towards = (window_m - eye_m) / np.linalg.norm(window_m - eye_m)
    sensors = free_sensors(eye_m[None], towards[None], "eye")
    lights = {"overcast": cie_hour("16", GROUND_ALBEDO), "sun": sunny}
    found = []
    for name in names:
        xml = window_xml_of(name, glazings()[name])
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "glazing.xml"
            path.write_text(xml)
            work = work_of(scene, sensors, _TOLERANCE, bsdf={MATERIAL: GlazingFile(str(path))})
            eyes = eyes_of(scene, work, sensors, _TOLERANCE)
        for light, hour in lights.items():
            ((glare, _),) = glare_now(eyes, hour)
            theirs = by_picture(surfaces, is_pane, hour, xml, eye_m, towards, pixels)
            found.append(GlareCase(name, light, glare.dgp, theirs))
            print(f"{name}, {light}: DGP {glare.dgp:.3f}, evalglare {theirs:.3f}", flush=True)
    return found


def by_picture(
    surfaces: Surfaces,
    is_pane: BoolArray,
    hour: Illumination,
    xml: str,
    eye_m: FloatArray,
    towards: FloatArray,
    pixels: int,
) -> float:
    """DGP by evalglare of a fisheye by `rpict`."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "glazing.xml").write_text(xml)
        (folder / "window.rad").write_text(MEASURED + window_of(surfaces, is_pane, "measured"))
        files = [write_scene(without(surfaces, is_pane), hour, folder), "window.rad"]
        files.append(write_sky(hour, folder))
        if any(hour.key_irradiance_rgb):
            files.append(write_sun(hour.key_direction, hour.key_irradiance_rgb, folder))
        (folder / "scene.oct").write_bytes(run_in(folder, "oconv", *files))
        place, ahead = (map(str, turned(each[None])[0]) for each in (eye_m, towards))
        view = (*_FISHEYE, "-vu", "0", "0", "1", "-vp", *place, "-vd", *ahead)
        size = ("-x", str(pixels), "-y", str(pixels))
        picture = run_in(folder, "rpict", *view, *size, *_EFFORT, "scene.oct")
        (folder / "watts.hdr").write_bytes(picture)
        scale = str(LUMENS_PER_WATT / _RADIANCE_LUMENS)
        (folder / "eye.hdr").write_bytes(run_in(folder, "pcomb", "-s", scale, "watts.hdr"))
        said = run_in(folder, "evalglare", *_FISHEYE, "eye.hdr")
    return float(said.split(b":")[1].split()[0])


def main() -> None:
    """Print a line for each glazing and light."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition(":")[0])
    parser.add_argument("--pixels", type=int, default=_PIXELS)
    compared_glare(("diffuser", "venetian blind"), parser.parse_args().pixels)


if __name__ == "__main__":
    main()
