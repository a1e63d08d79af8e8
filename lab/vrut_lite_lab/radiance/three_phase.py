"""Measured panes at sensors, beside Radiance's three-phase method and its BSDF material, live.

    .venv/bin/python -m vrut_lite_lab.radiance.three_phase [--rays N]

A room behind one pane, 25 sensors, with three glazings: a diffuser, a venetian blind, and clear
glass as a diagonal matrix. Skies without sun by `rfluxmtx` and `dctimestep` (McNeil 2010; view and
daylight matrices over Klems's patches, a sky of 2,305 patches), these and an hour with sun by
`rtrace` and the material `aBSDF` with the same file. Three phases blur what passes straight over
Klems's patches. Prints differences in percent of the mean, and CPU seconds
of all. It needs the extra `radiance`.
"""

import argparse
import resource
import tempfile
import time
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from daylight_numbers.glazing.angle_basis import KLEMS_FULL
from daylight_numbers.matrix.sensors import free_sensors
from daylight_numbers.now import cie_hour, hour_at_sensors
from daylight_numbers.opened_scene import OpenedScene
from daylight_numbers.sky_cells import cell_directions, cell_radiances, cell_solid_angles
from daylight_numbers.work import work_of
from light_transport.hour.illumination import Illumination
from light_transport.surfaces.surfaces import Surfaces, surfaces_of

from vrut_lite.geometry.colour import LUMENS_PER_WATT, luminance
from vrut_lite.messages.glazing import GlazingFile
from vrut_lite.messages.scene import SceneOpened
from vrut_lite.numeric_types import BoolArray, FloatArray
from vrut_lite.project import project_of_path
from vrut_lite_lab.radiance.irradiance import RadianceEffort, run_in, traced
from vrut_lite_lab.radiance.matrices import RECEIVERS, patch_of
from vrut_lite_lab.radiance.overcast import GLAZED
from vrut_lite_lab.radiance.scene_files import turned, write_scene, write_sky, write_sun
from vrut_lite_lab.radiance.venetian import VenetianBlind, transmission_of, window_xml_of
from vrut_lite_lab.radiance.year import rms

MATERIAL = "glass"
# Radiance's material of a file.
MEASURED = "void aBSDF measured\n5 glazing.xml 0 0 1 .\n0\n0\n"
_TOLERANCE, GROUND_ALBEDO = 0.1, 0.2
_BOUNCES, _RAYS = 12, 16_384
# Rays of each of Klems's patches of the pane.
_DAYLIGHT_RAYS = 1_000
_PATCHES = 2_305
# By default what scatters less than 15 % counts as Lambertian: lobes of a blind would.
_SAMPLED = ("-st", "0")


class PaneCase(NamedTuple):
    """Lux (P,) of one glazing and light by ours and by one of Radiance's methods."""

    glazing: str
    light: str
    method: str
    ours: FloatArray
    theirs: FloatArray

    @property
    def error(self) -> FloatArray:
        """Differences (P,), shares of the mean."""
        return np.asarray((self.ours - self.theirs) / self.theirs.mean())


class ComparedPanes(NamedTuple):
    """All cases, and CPU seconds of ours, of the three phases and of `rtrace`."""

    cases: list[PaneCase]
    ours_s: float
    phases_s: float
    material_s: float


def glazings() -> dict[str, FloatArray]:
    """Transmission (145, 145) by name."""
    return {
        "diffuser": np.full((145, 145), 0.5 / np.pi),
        "venetian blind": transmission_of(VenetianBlind()),
        "clear": np.diag(0.8 / KLEMS_FULL.projected_sr),
    }


class ThreePhases:
    """View and daylight matrices of the room over one ground; glazing and sky are free."""

    def __init__(self, surfaces: Surfaces, is_pane: BoolArray, hour: Illumination, rays: int):
        """Trace both in a folder for temporary files; `hour` gives the ground's albedo."""
        self._folder = tempfile.TemporaryDirectory()
        folder = Path(self._folder.name)
        scene = write_scene(without(surfaces, is_pane), hour, folder)
        (folder / "window.rad").write_text(window_of(surfaces, is_pane))
        (folder / "sky.rad").write_text(RECEIVERS)
        count = len(GLAZED.places_m)
        points = _rows(GLAZED.places_m, np.tile([0.0, 1.0, 0.0], (count, 1)))
        effort = ("-ab", f"{_BOUNCES}", "-ad", f"{rays}", "-lr", "-12", "-lw", f"{0.5 / rays:.3g}")
        view = run_in(
            folder, "rfluxmtx", "-I+", "-y", f"{count}", *effort, "-", "window.rad", scene,
            told=points.encode(),
        )  # fmt: skip
        (folder / "view.vmx").write_bytes(view)
        outdoors = ("-ab", "3", "-ad", "32", "-lw", "1e-3", "-c", f"{_DAYLIGHT_RAYS}")
        daylight = run_in(folder, "rfluxmtx", *outdoors, "window.rad", "sky.rad", scene)
        (folder / "daylight.dmx").write_bytes(daylight)

    def irradiance(self, hour: Illumination, xml: str) -> FloatArray:
        """Irradiance (P, 3) at GLAZED's sensors under a sky without sun, by `dctimestep`."""
        folder = Path(self._folder.name)
        (folder / "glazing.xml").write_text(xml)
        (folder / "sky.smx").write_text(_sky_vector(hour))
        matrices = "view.vmx", "glazing.xml", "daylight.dmx", "sky.smx"
        return np.array(run_in(folder, "dctimestep", "-h", *matrices).split(), float).reshape(-1, 3)

    def close(self) -> None:
        """Remove the matrices."""
        self._folder.cleanup()


def by_material(
    surfaces: Surfaces, is_pane: BoolArray, hour: Illumination, xml: str, rays: int
) -> FloatArray:
    """Irradiance (P, 3) at GLAZED's sensors in an hour, by `rtrace` and the material aBSDF."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "glazing.xml").write_text(xml)
        scene = write_scene(without(surfaces, is_pane), hour, folder)
        (folder / "window.rad").write_text(MEASURED + window_of(surfaces, is_pane, "measured"))
        sky = write_sky(hour, folder)
        sun = write_sun(hour.key_direction, hour.key_irradiance_rgb, folder)
        up = np.tile([0.0, 1.0, 0.0], (len(GLAZED.places_m), 1))
        rows = np.concatenate([turned(GLAZED.places_m), turned(up)], axis=1)
        files = scene, "window.rad", sky, sun
        return traced(folder, files, rows, RadianceEffort(rays, _BOUNCES), "-I+", *_SAMPLED)


def _rows(places_m: FloatArray, normals: FloatArray) -> str:
    rows = np.concatenate([turned(places_m), turned(normals)], axis=1)
    return "".join(" ".join(f"{value:.9g}" for value in row) + "\n" for row in rows)


def without(surfaces: Surfaces, is_pane: BoolArray) -> Surfaces:
    """The surfaces without panes."""
    kept = ~is_pane
    arrays: dict[str, Any] = {
        name: value[kept]
        for name, value in vars(surfaces).items()
        if isinstance(value, np.ndarray) and len(value) == len(kept)
    }
    return replace(surfaces, **arrays)


def window_of(surfaces: Surfaces, is_pane: BoolArray, modifier: str = "window") -> str:
    """Polygons whose normals point indoors, to +x, where the room is."""
    lines = ["#@rfluxmtx h=kf u=+Z\nvoid glow window\n0\n0\n4 1 1 1 0\n"] * (modifier == "window")
    corners = turned(surfaces.corners_m[is_pane] + surfaces.centre_m)
    for number, triangle in enumerate(corners):
        normal = np.cross(triangle[1] - triangle[0], triangle[2] - triangle[0])
        ordered = triangle if normal[0] > 0.0 else triangle[::-1]
        numbers = " ".join(f"{value:.9g}" for value in ordered.ravel())
        lines.append(f"{modifier} polygon pane{number}\n0\n0\n9 {numbers}\n")
    return "".join(lines)


def _sky_vector(hour: Illumination) -> str:
    """Radiances of open ground and of Reinhart's patches."""
    patch = patch_of(cell_directions()).ravel()
    radiance = np.repeat(cell_radiances(hour.sky), cell_directions().shape[1], axis=0)
    solid = np.repeat(cell_solid_angles(), cell_directions().shape[1])
    total = np.bincount(patch, solid, _PATCHES)
    means = [np.bincount(patch, solid * channel, _PATCHES) / total for channel in radiance.T]
    rows = np.vstack([np.asarray(hour.ground_radiance_rgb), np.stack(means, axis=1)])
    head = f"#?RADIANCE\nNROWS={len(rows)}\nNCOLS=1\nNCOMP=3\nFORMAT=ascii\n\n"
    return head + "".join(" ".join(f"{value:.7g}" for value in row) + "\n" for row in rows)


def compared_panes(rays: int = _RAYS) -> ComparedPanes:
    """Compare all glazings under all lights, and print a line for each."""
    opened = OpenedScene(project_of_path(GLAZED.file))
    try:
        scene, sunny = opened.scene, opened.hour()
    finally:
        opened.close()
    surfaces, is_pane = surfaces_of(scene), pane_triangles(scene)
    up = np.tile([0.0, 1.0, 0.0], (len(GLAZED.places_m), 1))
    sensors = free_sensors(GLAZED.places_m, up, GLAZED.scene)
    skies = {f"CIE {sky}": cie_hour(sky, GROUND_ALBEDO) for sky in ("16", "1")}
    # The ground of matrices is that of all skies.
    albedo = skies["CIE 16"].ground_albedo_rgb
    skies["clear sky without sun"] = replace(
        sunny, ground_albedo_rgb=albedo, key_irradiance_rgb=(0.0, 0.0, 0.0)
    )
    before = _children_s()
    phases = ThreePhases(surfaces, is_pane, skies["CIE 16"], rays)
    phases_s, material_s, ours_s = _children_s() - before, 0.0, 0.0
    found = []
    for name, transmission in glazings().items():
        xml = window_xml_of(name, transmission)
        began = time.process_time()
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "glazing.xml"
            path.write_text(xml)
            files = {MATERIAL: GlazingFile(str(path))}
            work = work_of(scene, sensors, _TOLERANCE, bsdf=files)
        lights = {**skies, "sun and sky": sunny}
        of = work.transport, work.glass, work.operator, sensors
        ours = {light: hour_at_sensors(*of, hour).total for light, hour in lights.items()}
        ours_s += time.process_time() - began
        for light, hour in lights.items():
            theirs = {}
            before = _children_s()
            if light in skies:
                theirs["three phases"] = phases.irradiance(hour, xml)
            between = _children_s()
            theirs["rtrace"] = by_material(surfaces, is_pane, hour, xml, rays)
            phases_s, material_s = phases_s + between - before, material_s + _children_s() - between
            for method, irradiance in theirs.items():
                lux = luminance(irradiance) * LUMENS_PER_WATT
                found.append(PaneCase(name, light, method, ours[light], lux))
                error = found[-1].error
                print(
                    f"{name}, {light}, {method}: {lux.mean():,.0f} lx, {error.mean():+.2%} mean, "
                    f"{rms(error):.2%} rms, {np.abs(error).max():.2%} most",
                    flush=True,
                )
    phases.close()
    return ComparedPanes(found, ours_s, phases_s, material_s)


def pane_triangles(scene: SceneOpened) -> BoolArray:
    """Which triangles (F,) are of the pane."""
    materials, geometry = scene.materials.all(), scene.geometry
    meshes = geometry.part_mesh.values.tolist()
    names = [materials[geometry.mesh(mesh).material].name for mesh in meshes]
    parts = [part for part, name in enumerate(names) if name == MATERIAL]
    return np.isin(surfaces_of(scene).part, parts)


def _children_s() -> float:
    return resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime


def main() -> None:
    """Print a line for each glazing and light."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition(":")[0])
    parser.add_argument("--rays", type=int, default=_RAYS)
    found = compared_panes(parser.parse_args().rays)
    print(
        f"CPU seconds: ours {found.ours_s:.0f}, three phases {found.phases_s:.0f}, rtrace "
        f"{found.material_s:.0f}"
    )


if __name__ == "__main__":
    main()
