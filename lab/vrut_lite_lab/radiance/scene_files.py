"""A scene and an hour in Radiance's words (Ward 1994): polygons, a sky of data, a sun.

Radiance's axes have z up: (x, y, z) here is (x, -z, y) there.
"""

from pathlib import Path

import numpy as np
from daylight_numbers.glazing.glass import Glass
from light_transport.hour.illumination import Illumination
from light_transport.surfaces.surfaces import GROUND, Surfaces

from vrut_lite.geometry.cube_map import sample_cube
from vrut_lite.numeric_types import FloatArray, Vector

# Of the sky's data.
_STEP_DEG = 0.5
_SUN_DEG = 0.53
_PANES_APART_M = 0.02
_SKY = """void colordata above
9 its_r its_g its_b sky_r.dat sky_g.dat sky_b.dat sky.cal height azimuth
0
0
above glow sky
0
0
4 1 1 1 0
sky source dome
0
0
4 0 0 1 180
void glow earth
0
0
4 {0} {1} {2} 0
earth source below
0
0
4 0 0 -1 180
"""
_SKY_CAL = """its_r(r, g, b) = r;
its_g(r, g, b) = g;
its_b(r, g, b) = b;
height = Asin(if(Dz - 1, 1, if(-1 - Dz, -1, Dz))) * 180 / PI;
azimuth = if(Dx * Dx + Dy * Dy - 1e-12, mod(Atan2(Dx, Dy) * 180 / PI + 360, 360), 0);
"""
_SUN = """void light sunlight
0
0
3 {0} {1} {2}
sunlight source sun
0
0
4 {3} {4} {5} {6}
"""


def turned(places: FloatArray) -> FloatArray:
    """Vectors (..., 3) in Radiance's axes."""
    return np.stack([places[..., 0], -places[..., 2], places[..., 1]], axis=-1)


def write_scene(
    surfaces: Surfaces, hour: Illumination, folder: Path, glass: Glass | None = None
) -> str:
    """Write triangles as `scene.rad`: Lambert's, the ground's with the hour's albedo.

    Triangles that `glass` has are Radiance's glass: a pane each, see `_panes`.
    """
    reflectance = surfaces.reflectance_rgb.copy()
    reflectance[surfaces.part == GROUND] = hour.ground_albedo_rgb
    colours, which = np.unique(reflectance, axis=0, return_inverse=True)
    lines = [
        f"void plastic m{number}\n0\n0\n5 {r:.7g} {g:.7g} {b:.7g} 0 0\n"
        for number, (r, g, b) in enumerate(colours)
    ]
    corners = turned(surfaces.corners_m + surfaces.centre_m)
    clear = np.zeros(len(corners), bool) if glass is None else glass.clear
    if glass is not None:
        lines += _panes(glass, corners)
    for number in np.flatnonzero(~clear):
        paint, triangle = which.ravel()[number], corners[number]
        numbers = " ".join(f"{value:.9g}" for value in triangle.ravel())
        lines.append(f"m{paint} polygon p{number}\n0\n0\n9 {numbers}\n")
    (folder / "scene.rad").write_text("".join(lines))
    return "scene.rad"


def _panes(glass: Glass, corners: FloatArray) -> list[str]:
    """Polygons of glass, one behind the other where it has several panes."""
    lines = []
    for number in np.flatnonzero(glass.clear):
        triangle = corners[number]
        side = np.cross(triangle[1] - triangle[0], triangle[2] - triangle[0])
        side *= _PANES_APART_M / np.linalg.norm(side)
        tint = " ".join(f"{t:.7g}" for t in glass.tint[number])
        lines.append(f"void glass g{number}\n0\n0\n4 {tint} {glass.ior[number]:.7g}\n")
        for pane in range(int(glass.panes[number])):
            numbers = " ".join(f"{value:.9g}" for value in (triangle + pane * side).ravel())
            lines.append(f"g{number} polygon g{number}_{pane}\n0\n0\n9 {numbers}\n")
    return lines


def write_sky(hour: Illumination, folder: Path) -> str:
    """Write the dome as `sky.rad`, and below the horizon the hour's open ground."""
    turn = np.arange(0.0, 360.0 + 1e-9, _STEP_DEG)
    height, azimuth = np.radians(np.meshgrid(turn[turn <= 90.0], turn, indexing="ij"))
    # Half a texel above the horizon no ground is mixed in.
    seen = np.maximum(height, 1.0 / hour.sky.shape[1])
    level = np.cos(seen)
    directions = [level * np.sin(azimuth), np.sin(seen), -level * np.cos(azimuth)]
    radiance = sample_cube(hour.sky, np.stack(directions, axis=-1))
    rows, columns = height.shape
    for channel, name in enumerate("rgb"):
        values = "\n".join(f"{value:.6g}" for value in radiance[..., channel].ravel())
        head = f"2\n0 90 {rows}\n0 360 {columns}\n"
        (folder / f"sky_{name}.dat").write_text(head + values + "\n")
    (folder / "sky.cal").write_text(_SKY_CAL)
    (folder / "sky.rad").write_text(_SKY.format(*hour.ground_radiance_rgb))
    return "sky.rad"


def write_sun(direction: Vector, irradiance_rgb: Vector, folder: Path) -> str:
    """Write the key light as `sun.rad`, an even disc of half a degree."""
    solid_angle_sr = 2.0 * np.pi * (1.0 - np.cos(np.radians(_SUN_DEG / 2.0)))
    x, y, z = turned(np.asarray(direction, float))
    radiance = np.asarray(irradiance_rgb) / solid_angle_sr
    (folder / "sun.rad").write_text(_SUN.format(*radiance, x, y, z, _SUN_DEG))
    return "sun.rad"
