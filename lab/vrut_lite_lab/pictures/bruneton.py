"""Pictures of the Bruneton sky: a climb to space, a day, the thesis's figures, the tables.

    python -m vrut_lite_lab.pictures.bruneton FOLDER

Writes bruneton_climb.jpg, bruneton_day.jpg, bruneton_thesis.jpg (figures A.6 to A.9 of Hvezda
2020, which print the sun's elevation but neither camera nor field of view) and
bruneton_tables.jpg (the tables of its figure 4.5). Exposure is automatic, the tone map the
host's; there is no sun's disc.
"""

import sys
from pathlib import Path
from typing import NamedTuple

import numpy as np
from bruneton_sky.background import background_cube, surroundings
from bruneton_sky.published.precompute import irradiance_table, march_tables
from bruneton_sky.settings import BrunetonSkySettings, atmosphere_of
from bruneton_sky.solver import SourceField, solve
from bruneton_sky.solver_job import solve_air
from bruneton_sky.tables.sizes import TableSizes
from numpy.typing import NDArray
from PIL import Image

from vrut_lite.geometry.panorama import fisheye_directions, sample_sky
from vrut_lite.pictures.display import display_picture
from vrut_lite_lab.pictures.drawing import HEIGHT, WIDTH, sheet, sun_direction, view_directions

CUBE_SIZE, FISHEYE_PX = 1024, 280
Picture = NDArray[np.integer]


class NorthView(NamedTuple):
    """A camera that looks north; the sun stands so far east of that."""

    caption: str
    height_m: float
    sun_elevation_deg: float
    pitch_deg: float
    sun_azimuth_deg: float = 25.0


CLIMB = (
    NorthView("the ground, sun 20 deg", 2.0, 20.0, 15.0),
    NorthView("2 km", 2e3, 20.0, 5.0),
    NorthView("12 km", 12e3, 20.0, -2.0),
    NorthView("100 km", 100e3, 20.0, -12.0),
    NorthView("3000 km", 3e6, 20.0, -55.0),
    NorthView("3000 km, sun 12 deg below the level", 3e6, -12.0, -50.0),
)
THESIS = (
    NorthView("A.6 on the ground, sun 30 deg", 2.0, 30.0, 20.0, 0.0),
    NorthView("A.7 on the ground, sun -2.03 deg", 2.0, -2.03, 15.0, 0.0),
    NorthView("A.8 inside the atmosphere, 20 km", 20e3, 10.0, -3.0, 0.0),
    NorthView("A.9 in space, 6000 km", 6e6, -20.0, -60.0, 40.0),
)
DAY_DEG = (45.0, 20.0, 8.0, 2.0, 0.0, -2.0, -4.0, -6.0, -9.0, -12.0)


def draw(field: SourceField, view: NorthView) -> Picture:
    """The camera's picture (300, 480, 3)."""
    sun = sun_direction(view.sun_elevation_deg, view.sun_azimuth_deg)
    around = surroundings(field, view.height_m, sun)
    cube = background_cube(around, CUBE_SIZE)
    return display_picture(sample_sky(cube, view_directions(view.pitch_deg)).astype(np.float32))


def fisheye(field: SourceField, sun_elevation_deg: float) -> Picture:
    """The whole sky from the ground, the sun towards the top."""
    around = surroundings(field, 0.0, sun_direction(sun_elevation_deg, 0.0))
    directions, inside = fisheye_directions(FISHEYE_PX)
    radiance = sample_sky(background_cube(around, 256), directions) * inside[..., None]
    return display_picture(radiance.astype(np.float32), inside=inside)


def table_pictures() -> list[tuple[str, Picture]]:
    """The tables of the thesis's figure 4.5: T, E, and slices of S and single Mie."""
    atmosphere = atmosphere_of(BrunetonSkySettings(preset="earth-clear"))
    field, sizes = solve(atmosphere), TableSizes()
    scattering, mie = march_tables(field, sizes)
    irradiance = irradiance_table(field, sizes)
    transmittance = field.transmittance[0].reshape(*field.transmittance.shape[1:2], -1, 4)
    flat = [
        ("transmittance T: mu across, altitude up", transmittance[..., :3]),
        ("irradiance E of the sky: mu_s across", irradiance[..., :3] / irradiance.max()),
    ]
    for height in (0, 10, 20):
        for name, table in (("S", scattering), ("single Mie", mie)):
            plane = table[height, :, :, :, :3]
            picture = plane.reshape(plane.shape[0], -1, 3)
            flat.append(
                (f"{name}, altitude node {height}: nu and mu_s across", picture / picture.max())
            )
    return [(caption, _as_bytes(values[::-1])) for caption, values in flat]


def _as_bytes(values: NDArray[np.floating]) -> Picture:
    """Square roots of the values, so that dark parts show; a node is a block of pixels."""
    picture = (255.0 * np.sqrt(np.clip(values, 0.0, 1.0))).astype(np.uint8)
    return np.asarray(Image.fromarray(picture).resize((WIDTH, HEIGHT), Image.Resampling.NEAREST))


def main(folder: Path) -> None:
    """Write all sheets."""
    folder.mkdir(parents=True, exist_ok=True)
    field = solve_air(atmosphere_of(BrunetonSkySettings()))
    sheets = {
        "climb": sheet([(view.caption, draw(field, view)) for view in CLIMB], 3),
        "day": sheet([(f"sun {deg:g} deg", fisheye(field, deg)) for deg in DAY_DEG], 5),
        "thesis": sheet([(view.caption, draw(field, view)) for view in THESIS], 2),
        "tables": sheet(table_pictures(), 2),
    }
    for name, paper in sheets.items():
        paper.save(folder / f"bruneton_{name}.jpg", quality=88)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
