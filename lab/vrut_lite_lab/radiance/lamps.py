"""Lamps at sensors against Radiance's `ies2rad` and `rtrace`, live: direct, and with all bounces.

    .venv/bin/python -m vrut_lite_lab.radiance.lamps [--rays N]

The room of scenes/work with four Lambertian panels, four small ones and four spots that fall as the
eighth power of the cosine, 20 sensors. Radiance's lamps are bodies that stop light on its way up,
ours are not: with large panels, 7 % of the ceiling, it has less by bounces. Prints differences in
percent of the mean. It needs the extra `radiance`.
"""

import argparse
import tempfile
from pathlib import Path
from typing import NamedTuple

import numpy as np
from daylight_numbers.lamps.lamp_places import placed_luminaires
from daylight_numbers.lamps.lighting import Lighting, lighting_of
from daylight_numbers.matrix.sensors import free_sensors
from daylight_numbers.now import cie_hour
from daylight_numbers.opened_scene import OpenedScene
from daylight_numbers.work import work_of
from light_transport.surfaces.surfaces import Surfaces, surfaces_of

from vrut_lite.geometry.colour import luminance
from vrut_lite.messages.lighting import LampPlacement
from vrut_lite.numeric_types import FloatArray
from vrut_lite.project import project_of_path
from vrut_lite_lab.radiance.irradiance import RadianceEffort, run_in, traced
from vrut_lite_lab.radiance.scene_files import turned, write_scene

# Radiance's own efficacy: of its white, ies2rad divides candela by it.
_LUMENS_PER_WATT = 179.0
_SCENE = "scenes/work/indoor.glb"
_TOLERANCE, _GROUND_ALBEDO = 0.1, 0.2
_GAMMA_DEG = np.arange(0.0, 90.5, 1.0)
# Heights of lamps, below the ceiling, and of sensors, above the furniture.
_LAMPS_M, _SENSORS_M = 2.3, 1.2
_PLACES = [(x, _LAMPS_M, z) for x in (-1.0, 1.0) for z in (-1.2, 1.2)]


class ComparedLamps(NamedTuple):
    """Lux (P,) of one kind of lamps by ours and by Radiance, straight and in all."""

    name: str
    direct: FloatArray
    direct_by_radiance: FloatArray
    total: FloatArray
    total_by_radiance: FloatArray

    @property
    def errors(self) -> tuple[FloatArray, FloatArray]:
        """Differences (P,) of direct light and of all, shares of their means."""
        pairs = (
            (self.direct, self.direct_by_radiance),
            (self.total, self.total_by_radiance),
        )
        one, other = ((ours - theirs) / theirs.mean() for ours, theirs in pairs)
        return np.asarray(one), np.asarray(other)


def cosine_ies(flux_lm: float, power: float, size_m: tuple[float, float, float]) -> str:
    """An IES file of an intensity that falls as a power of the cosine."""
    cosine = np.cos(np.radians(_GAMMA_DEG)).clip(0.0)
    candela = flux_lm * (power + 1.0) / (2.0 * np.pi) * cosine**power
    lines = [" ".join(f"{v:.8g}" for v in row) for row in (_GAMMA_DEG, [0.0], candela)]
    size = " ".join(f"{v:g}" for v in size_m)
    head = [
        "IESNA:LM-63-1995", "TILT=NONE",
        f"1 {flux_lm:g} 1 {len(_GAMMA_DEG)} 1 1 2 {size}", "1 1 25",
    ]  # fmt: skip
    return "\n".join([*head, *lines, ""])


LUMINAIRES = {
    "panels": cosine_ies(3000.0, 1.0, (0.3, 1.2, 0.0)),
    "small panels": cosine_ies(3000.0, 1.0, (0.05, 0.05, 0.0)),
    "spots": cosine_ies(800.0, 8.0, (-0.1, 0.0, 0.0)),
}


def lux_by_radiance(
    surfaces: Surfaces, ies: str, turn_deg: float, sensors_m: FloatArray, effort: RadianceEffort
) -> tuple[FloatArray, FloatArray]:
    """Lux (P,) on the level straight from lamps at _PLACES and in all, by `ies2rad`."""
    up = np.tile([0.0, 1.0, 0.0], (len(sensors_m), 1))
    rows = np.concatenate([turned(sensors_m), turned(up)], axis=1)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "lamp.ies").write_text(ies)
        run_in(folder, "ies2rad", "-dm", "-c", "1", "1", "1", "-o", "lamp", "lamp.ies")
        placed = [
            run_in(
                folder, "xform", "-rz", f"{turn_deg:g}",
                "-t", *(f"{v:g}" for v in turned(np.array(place))), "lamp.rad",
            )
            for place in _PLACES
        ]  # fmt: skip
        (folder / "lamps.rad").write_bytes(b"\n".join(placed))
        scene = write_scene(surfaces, cie_hour("16", _GROUND_ALBEDO), folder)
        options = "-I+", "-ds", "0.02", "-dc", "1", "-ss", "0"
        found = [
            luminance(traced(folder, (scene, "lamps.rad"), rows, each, *options))
            for each in (RadianceEffort(effort.rays, 0), effort)
        ]
    return np.asarray(found[0] * _LUMENS_PER_WATT), np.asarray(found[1] * _LUMENS_PER_WATT)


def compared_lamps(effort: RadianceEffort) -> list[ComparedLamps]:
    """Each kind of lamps in the room."""
    x, z = np.meshgrid(np.linspace(-1.6, 1.6, 4), np.linspace(-2.0, 2.0, 5), indexing="ij")
    places = np.stack([x.ravel(), np.full(x.size, _SENSORS_M), z.ravel()], axis=1)
    opened = OpenedScene(project_of_path(_SCENE))
    try:
        scene = opened.scene
    finally:
        opened.close()
    sensors = free_sensors(places, np.tile([0.0, 1.0, 0.0], (len(places), 1)), "room")
    work = work_of(scene, sensors, _TOLERANCE)
    found = []
    for (name, ies), turn_deg in zip(LUMINAIRES.items(), (30.0, 30.0, 0.0), strict=True):
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "lamp.ies"
            file.write_text(ies)
            placed = LampPlacement(str(file), [*_PLACES], rotation_deg=turn_deg)
            ours: Lighting = lighting_of(work, scene, {name: placed}, {}, (_GROUND_ALBEDO,) * 3)
        theirs = lux_by_radiance(surfaces_of(scene), ies, turn_deg, places, effort)
        light = ours.light
        found.append(
            ComparedLamps(name, light.direct[:, 0], theirs[0], light.total[:, 0], theirs[1])
        )
    return found


def candela_by_radiance(ies: str, gamma_deg: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Candela of a file by ours and by `ies2rad` with `rtrace`, 100 m from the lamp."""
    far = 100.0
    gamma = np.radians(gamma_deg)
    places = far * np.stack([np.sin(gamma), 0.0 * gamma, -np.cos(gamma)], axis=1)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "lamp.ies").write_text(ies)
        run_in(folder, "ies2rad", "-dm", "-c", "1", "1", "1", "-o", "lamp", "lamp.ies")
        rows = np.concatenate([places, -places / far], axis=1)
        light = traced(folder, ("lamp.rad",), rows, RadianceEffort(64, 0), "-I+", "-ds", "0")
        placed = LampPlacement(str(folder / "lamp.ies"), [0.0, 0.0, 0.0])
        luminaire = placed_luminaires({"lamp": placed}, None).kinds[0]
    theirs = luminance(light) * _LUMENS_PER_WATT * far**2
    return luminaire.candela_at(gamma_deg, 0.0), np.asarray(theirs)


def main() -> None:
    """Print a line for each kind of lamps."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition(":")[0])
    parser.add_argument("--rays", type=int, default=8192)
    for case in compared_lamps(RadianceEffort(parser.parse_args().rays, 12)):
        for told, error, lux in zip(
            ("direct", "all"), case.errors, (case.direct_by_radiance, case.total_by_radiance),
            strict=True,
        ):  # fmt: skip
            print(
                f"{case.name}, {told}: {lux.mean():,.1f} lx, {error.mean():+.2%} mean, "
                f"{np.sqrt(np.mean(error**2)):.2%} rms, {np.abs(error).max():.2%} most"
            )


if __name__ == "__main__":
    main()
