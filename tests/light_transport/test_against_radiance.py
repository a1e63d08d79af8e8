"""Radiance (LBNL) as a second truth: irradiance on a grid in a furnished room, all bounces.

Needs the wheel `pyradiance`, which the product does not: skipped where it is not installed.
"""

import importlib.util
import os
import subprocess
from pathlib import Path

import numpy as np
import pytest
from boxes import hour
from light_transport.bake import Bake
from light_transport.layout.layout import lay_out
from light_transport.surfaces.surfaces import surfaces_of

from vrut_lite.geometry.cube_map import texel_directions
from vrut_lite.scene.loading import load_scene
from vrut_lite.scene.packing import packed

INDOOR = Path(__file__).parents[2] / "scenes" / "work" / "indoor.glb"
# Radiance's axes: z up.
SKY = """void brightfunc above
2 b sky.cal
0
0
above glow sky
0
0
4 1 1 1 0
sky source dome
0
0
4 0 0 1 360
"""


def radiance_folder():
    found = importlib.util.find_spec("pyradiance")
    if found is None or found.origin is None:
        pytest.skip("Radiance (the wheel pyradiance) is not installed")
    return Path(found.origin).parent


def turned(points):
    return np.stack([points[..., 0], -points[..., 2], points[..., 1]], axis=-1)


def write_room(surfaces, folder):
    lines = [SKY]
    colours, which = np.unique(surfaces.reflectance_rgb, axis=0, return_inverse=True)
    for number, (r, g, b) in enumerate(colours):
        lines.append(f"void plastic m{number}\n0\n0\n5 {r} {g} {b} 0 0\n")
    corners = turned(surfaces.corners_m + surfaces.centre_m)
    for number, triangle in enumerate(corners):
        numbers = " ".join(f"{value:.7g}" for value in triangle.ravel())
        lines.append(f"m{which.ravel()[number]} polygon p{number}\n0\n0\n9 {numbers}\n")
    (folder / "room.rad").write_text("".join(lines))
    (folder / "sky.cal").write_text("b = 0.2 + if(Dz, Dz, 0);\n")


def by_radiance(surfaces, points, folder):
    """Irradiance (P,) on level planes."""
    home = radiance_folder()
    environment = dict(os.environ, PATH=f"{home / 'bin'}:{os.environ['PATH']}")
    environment["RAYPATH"] = f".:{home / 'lib'}"
    write_room(surfaces, folder)

    def run(command, **options):
        return subprocess.run(
            command, cwd=folder, env=environment, capture_output=True, check=True, **options
        ).stdout

    (folder / "room.oct").write_bytes(run(["oconv", "room.rad"]))
    lines = "".join(f"{x} {y} {z} 0 0 1\n" for x, y, z in turned(points))
    bounces = ["-ab", "10", "-ad", "8000", "-lw", "1e-6", "-aa", "0", "-as", "0"]
    out = run(["rtrace", "-I+", "-h", *bounces, "room.oct"], input=lines.encode())
    return np.array(out.split(), float).reshape(-1, 3).mean(axis=1)


@pytest.mark.long
def test_a_grid_in_a_room_has_radiance_s_irradiance(tmp_path):
    """At 0.85 m, a sky brighter towards the zenith and ground of 0.2: within 2 % rms."""
    radiance_folder()
    scene = packed(load_scene(str(INDOOR)))
    surfaces = surfaces_of(scene)
    if (surfaces.part < 0).any():
        surfaces.reflectance_rgb[surfaces.part < 0] = 0.2
    # The lamps are off.
    surfaces.emitted_rgb[:] = 0.0
    lower, upper = np.asarray(scene.lower_m), np.asarray(scene.upper_m)
    x, z = np.meshgrid(*(np.linspace(lower[k], upper[k], 7)[1:-1] for k in (0, 2)))
    points = np.stack([x.ravel(), np.full(x.size, lower[1] + 0.85), z.ravel()], axis=1)
    bake = Bake(surfaces, lay_out(scene, surfaces, texels=40_000))
    bake.add_rays(256)
    up = np.maximum(texel_directions(64)[..., 1:2], 0.0)
    cube = np.repeat(0.2 + up, 3, axis=-1).astype(np.float32)
    now = hour(cube=cube, ground=0.2)
    level = np.tile([0.0, 1.0, 0.0], (len(points), 1))
    found = bake.irradiance_at(points, level, now, rays=32_768).mean(axis=1)
    expected = by_radiance(surfaces, points, tmp_path)
    print(found / expected - 1.0)
    inside = expected > 0.02 * np.median(expected)
    error = (found - expected)[inside] / expected[inside].mean()
    assert abs(error.mean()) < 0.01
    assert np.sqrt(np.mean(error**2)) < 0.02
