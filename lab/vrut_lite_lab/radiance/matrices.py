"""A year of weather at sensors by Radiance's own matrices, beside the year's product.

    python -m vrut_lite_lab.radiance.matrices prague.epw [SCENE ...] [--rays N ...] [--points N]

The two-phase method (rfluxmtx; 2,305 patches of Reinhart), in which the sun is apart: bounces
of it come from the patch that it stands in, its own light by a ray to its disc. Prints
differences to the year's product and CPU seconds of both. It needs the extra `radiance`.
"""

import argparse
import resource
import tempfile
from pathlib import Path

import numpy as np
from daylight_numbers.sky_cells import cell_directions, cell_solid_angles, node_of_cell
from light_transport.surfaces.surfaces import Surfaces

from vrut_lite.geometry.colour import LUMENS_PER_WATT, luminance
from vrut_lite.numeric_types import FloatArray, IntArray
from vrut_lite_lab.radiance.grids import GRIDS
from vrut_lite_lab.radiance.irradiance import run_in
from vrut_lite_lab.radiance.scene_files import turned, write_scene
from vrut_lite_lab.radiance.year import SCENES, YearHere, rms, year_here

_RAYS = (65_536,)
_BOUNCES = 24
# Rows of Reinhart's division from the horizon up, and their patches; the zenith is one more.
_PARTS = 4
_ROWS = 7 * _PARTS
_IN_ROW = np.repeat((30, 30, 24, 24, 18, 12, 6), _PARTS) * _PARTS
_PATCHES = int(_IN_ROW.sum()) + 1
_HALF_RAD = np.pi / 2.0 / (_ROWS + 0.5)
RECEIVERS = f"""#@rfluxmtx h=u u=+Y
void glow earth
0
0
4 1 1 1 0
earth source below
0
0
4 0 0 -1 180
#@rfluxmtx h=r{_PARTS} u=+Y
void glow above
0
0
4 1 1 1 0
above source dome
0
0
4 0 0 1 180
"""


def patch_of(directions: FloatArray) -> IntArray:
    """The patch (...) of Reinhart's division of directions (..., 3), world axes, above ground."""
    x, y, z = np.moveaxis(turned(directions), -1, 0)
    row = np.minimum((np.arcsin(np.clip(z, 0.0, 1.0)) / _HALF_RAD).astype(int), _ROWS)
    turn = np.mod(np.arctan2(x, y) / (2.0 * np.pi), 1.0)
    count = np.append(_IN_ROW, 1)[row]
    first = np.append(0, np.cumsum(_IN_ROW))[row]
    return np.asarray(first + np.mod((turn * count + 0.5).astype(int), count))


def solid_angles() -> FloatArray:
    """Of patches (_PATCHES,), in sr."""
    edges = np.sin(np.append(np.arange(_ROWS + 1) * _HALF_RAD, np.pi / 2.0))
    each = 2.0 * np.pi * np.diff(edges) / np.append(_IN_ROW, 1)
    return np.repeat(each, np.append(_IN_ROW, 1))


def coefficients(
    here: YearHere, surfaces: Surfaces, rays: int, bounces: int
) -> tuple[FloatArray, float]:
    """Irradiance (P, 1 + _PATCHES, 3) by unit radiance of ground and patches, and CPU seconds."""
    sensors = here.work.sensors
    rows = np.concatenate([turned(sensors.places_m), turned(sensors.normals)], axis=1)
    points = "".join(" ".join(f"{value:.9g}" for value in row) + "\n" for row in rows).encode()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        scene = write_scene(surfaces, here.opened.hour(), folder)
        (folder / "receivers.rad").write_text(RECEIVERS)
        before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
        out = run_in(
            folder, "rfluxmtx", "-h", "-faa", "-I+", "-y", f"{len(rows)}", "-ab", f"{bounces}",
            "-ad", f"{rays}", "-lr", "-12", "-lw", f"{0.5 / rays:.3g}", "-u+", "-", "receivers.rad",
            scene, told=points,
        )  # fmt: skip
        cpu_s = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before
    return np.array(out.split(), float).reshape(len(rows), 1 + _PATCHES, 3), cpu_s


def year_by_matrices(here: YearHere, whole: FloatArray, straight: FloatArray) -> FloatArray:
    """Lux (P, H) by coefficients of all light, and of that straight from the sky."""
    light = here.light
    directions = cell_directions()
    patch = patch_of(directions).ravel()
    node = np.repeat(node_of_cell(), directions.shape[1])
    share = np.zeros((_PATCHES, light.sky.shape[1] - 1))
    np.add.at(share, (patch, node), np.repeat(cell_solid_angles(), directions.shape[1]))
    share /= share.sum(axis=1, keepdims=True)
    lux = np.zeros((len(whole), len(light.hour)))
    above = np.flatnonzero(light.sun_direction[:, 1] > 0.0)
    stands_in = patch_of(light.sun_direction[above])
    bounced = whole[:, 1:] - straight[:, 1:]
    for k in range(3):
        sky = np.vstack([light.sky[:, -1, k], share @ light.sky[:, :-1, k].T.astype(float)])
        found = whole[..., k] @ sky
        sun = light.sun_irradiance_rgb[above, k] / solid_angles()[stands_in]
        found[:, above] += bounced[:, stands_in, k] * sun
        lux += luminance(np.eye(3)[k]) * LUMENS_PER_WATT * found
    return lux + here.year.sun


def main() -> None:
    """Print lines for each scene."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition(":")[0])
    parser.add_argument("weather")
    parser.add_argument("scenes", nargs="*", default=SCENES)
    parser.add_argument("--rays", type=int, nargs="+", default=_RAYS)
    parser.add_argument("--points", type=int, default=9)
    told = parser.parse_args()
    for scene in told.scenes:
        grid = next(grid for grid in GRIDS if grid.scene == scene)
        with year_here(grid, told.weather, told.points) as here:
            ours = here.year.total.astype(float)
            is_day = here.is_day
            for rays in told.rays:
                whole, cpu_s = coefficients(here, here.surfaces, rays, _BOUNCES)
                straight, more_s = coefficients(here, here.surfaces, rays, 1)
                theirs = year_by_matrices(here, whole, straight)
                error = ((theirs - ours) / ours.mean(axis=0))[:, is_day]
                of_sum = theirs.sum(axis=1) / ours.sum(axis=1) - 1.0
                print(
                    f"{scene}, {rays:,} rays: hours {error.mean():+.2%} mean, {rms(error):.2%} rms;"
                    f" year {of_sum.mean():+.2%} mean, {rms(of_sum):.2%} rms; CPU "
                    f"{cpu_s + more_s:.0f} s, ours {here.cpu_s:.0f} s, at {told.points} points",
                    flush=True,
                )


if __name__ == "__main__":
    main()
