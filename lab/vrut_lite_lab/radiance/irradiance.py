"""Light at points and along rays by Radiance's `rtrace`, which the wheel `pyradiance` brings."""

import importlib.util
import os
import subprocess
import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from daylight_numbers.glazing.glass import Glass
from light_transport.hour.illumination import Illumination
from light_transport.surfaces.surfaces import Surfaces

from vrut_lite.errors import UserError
from vrut_lite.numeric_types import FloatArray, Vector
from vrut_lite_lab.radiance.scene_files import turned, write_scene, write_sky, write_sun

# Nothing is interpolated between points, and paths end by chance, without bias.
_EXACT = ("-aa", "0", "-as", "0", "-lr", "-12", "-dt", "0", "-dj", "0", "-u+")
# A ray's weight below which it goes on by chance, in shares of one of the first rays.
_LEAST_WEIGHT = 0.5


@dataclass(frozen=True)
class RadianceEffort:
    """How hard Radiance tries: rays from each point, and how many bounces they may take."""

    rays: int = 32_768
    bounces: int = 24


def radiance_folder() -> Path | None:
    """Where Radiance is installed."""
    found = importlib.util.find_spec("pyradiance")
    return None if found is None or found.origin is None else Path(found.origin).parent


def irradiance_by_radiance(
    surfaces: Surfaces,
    hour: Illumination,
    places_m: FloatArray,
    normals: FloatArray,
    effort: RadianceEffort = RadianceEffort(),
) -> FloatArray:
    """Irradiance (P, 3), W m^-2, without the key light's own, at points (P, 3) in world axes.

    Raises:
        UserError: Radiance is not installed.
    """
    whole, of_key_light = both_by_radiance(surfaces, hour, places_m, normals, effort)
    return whole - of_key_light


def both_by_radiance(
    surfaces: Surfaces,
    hour: Illumination,
    places_m: FloatArray,
    normals: FloatArray,
    effort: RadianceEffort = RadianceEffort(),
    glass: Glass | None = None,
) -> tuple[FloatArray, FloatArray]:
    """Irradiance (P, 3), W m^-2, of all light, and of it that straight from the key light.

    Raises:
        UserError: Radiance is not installed.
    """
    rows = np.concatenate([turned(places_m), turned(normals)], axis=1)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        scene, sky = write_scene(surfaces, hour, folder, glass), write_sky(hour, folder)
        sun = write_sun(hour.key_direction, hour.key_irradiance_rgb, folder)
        every = traced(folder, (scene, sky, sun), rows, effort, "-I+")
        return every, traced(folder, (scene, sun), rows, RadianceEffort(effort.rays, 0), "-I+")


def radiance_by_radiance(
    surfaces: Surfaces,
    hour: Illumination,
    eye_m: Vector,
    directions: FloatArray,
    effort: RadianceEffort,
) -> FloatArray:
    """Radiance (R, 3), W m^-2 sr^-1, that comes to an eye from directions (R, 3), world axes.

    Raises:
        UserError: Radiance is not installed.
    """
    eyes = np.broadcast_to(np.asarray(eye_m, float), directions.shape)
    rows = np.concatenate([turned(eyes), turned(directions)], axis=1)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        scene, sky = write_scene(surfaces, hour, folder), write_sky(hour, folder)
        sun = write_sun(hour.key_direction, hour.key_irradiance_rgb, folder)
        return traced(folder, (scene, sky, sun), rows, effort)


def traced(
    folder: Path, files: tuple[str, ...], rows: FloatArray, effort: RadianceEffort, *options: str
) -> FloatArray:
    """What `rtrace` finds (R, 3) along rays (R, 6): places and directions."""
    (folder / "scene.oct").write_bytes(run_in(folder, "oconv", *files))
    points = "".join(" ".join(f"{value:.9g}" for value in row) + "\n" for row in rows).encode()
    ambient = ("-ab", str(effort.bounces), "-ad", str(effort.rays))
    weight = ("-lw", f"{_LEAST_WEIGHT / effort.rays:.3g}")
    out = run_in(
        folder, "rtrace", *options, "-h", *_EXACT, *ambient, *weight, "scene.oct", told=points
    )
    return np.array(out.split(), float).reshape(-1, 3)


def run_in(folder: Path, *command: str, told: bytes | None = None) -> bytes:
    """What one of Radiance's programs says that runs in a folder.

    Raises:
        UserError: Radiance is not installed.
    """
    home = radiance_folder()
    if home is None:
        raise UserError("Radiance is not installed: pip install pyradiance")
    environment = dict(os.environ, PATH=f"{home / 'bin'}:{os.environ['PATH']}")
    environment["RAYPATH"] = f".:{home / 'lib'}"
    return subprocess.run(
        command, cwd=folder, env=environment, input=told, capture_output=True, check=True
    ).stdout
