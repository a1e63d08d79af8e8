"""The sky-view table that a card makes, in the cube drawn from it, beside the processor's."""

from dataclasses import replace

import numpy as np
import pytest
from bruneton_sky.light import ROOM_ALOFT
from bruneton_sky.settings import BrunetonSkySettings, atmosphere_of
from bruneton_sky.sky_view import fill_cube, sky_view
from bruneton_sky.sky_view.gpu import cube_scale
from bruneton_sky.sky_view.table import coarse_view
from bruneton_sky.sky_view.table_on_card import table_cube_job, table_on_card
from bruneton_sky.solver import SolverSizes, SourceField, solve

from vrut_lite.sky.cube_sum import sum_of_parts

BINS, ROWS = 2, 3
GROUND = np.array([0.3, 0.2, 0.1])
COARSE = SolverSizes(
    altitude=8, mu_s=24, direction_mu=8, direction_azimuth=8, degree=4, source_mu=8,
    source_azimuth=6, steps=12, node_bins=6, single_bins=12, multiple_bins=6,
)  # fmt: skip
# Over the larger of the value and a hundredth of the brightest. Where particles alone scatter
# again, light changes fast with the azimuth from the sun, which both devices take from a cosine in
# single precision: the square root of its last digit is 3e-4.
WORST = {
    "haze": 1e-4, "molecules": 1e-4, "aerosol": 5e-4, "fog under the stratosphere": 5e-4,
    "a small planet's": 1e-4,
}  # fmt: skip
SIZE = 64
NOON, LOW, SET, DEEP, NIGHT = 65.0, 4.0, -3.0, -8.0, -20.0
# In the haze and over it, under the edge of the air and over it, and as high as weather satellites.
HEIGHTS_M = (20.0, 3e3, 5.9e4, 6.5e4, 4e5, 3.6e7)


def air_of(**settings):
    return atmosphere_of(BrunetonSkySettings(**settings))


@pytest.fixture(scope="module")
def fields() -> dict[str, SourceField]:
    """Coarsely solved airs: any numbers will do. Fog has particles of several kinds."""
    airs = {
        "haze": air_of(),
        "fog under the stratosphere": air_of(fog_visibility_m=800.0),
        "molecules": replace(air_of(preset="earth-clear"), mie_scattering=(0.0,) * 4),
        "aerosol": replace(air_of(), rayleigh_scattering=(0.0,) * 4),
        "a small planet's": replace(air_of(), ground_radius_m=2.4e6, top_altitude_m=9e4),
    }
    return {name: solve(air, 3, COARSE) for name, air in airs.items()}


def sun_at(elevation_deg):
    """In no axis's plane."""
    elevation = np.radians(elevation_deg)
    level = np.cos(elevation) * np.array([np.cos(0.7), np.sin(0.7)])
    return np.array([level[0], np.sin(elevation), level[1]])


def job_of(field, sun_deg, scale=1.0, size=SIZE, finer=1.0, altitude_m=0.0):
    table = table_on_card(field, altitude_m, sun_at(sun_deg), finer)
    return table_cube_job(table, size, GROUND * scale, scale, "test", "cube", read_back=True)


def apart(compute, field, sun_deg, finer=1.0, altitude_m=0.0):
    view = sky_view(field, altitude_m, sun_at(sun_deg), finer)
    scale = cube_scale(view, np.zeros(3))
    card = compute(job_of(field, sun_deg, scale, SIZE, finer, altitude_m))[..., :3]
    processor = fill_cube(view, SIZE, GROUND * scale).astype(float) / scale
    assert processor.max() > 1.0
    return (np.abs(card - processor) / np.maximum(processor, 1e-2 * processor.max())).max()


@pytest.mark.gl
@pytest.mark.parametrize("sun_deg", [NOON, LOW, SET, DEEP])
@pytest.mark.parametrize("air", WORST)
def test_the_cards_table_is_the_processors(compute, fields, air, sun_deg):
    """By day, at sunset and in twilight, per texel of the cube that is drawn from it."""
    assert apart(compute, fields[air], sun_deg) < WORST[air]


@pytest.mark.gl
@pytest.mark.parametrize("sun_deg", [LOW, NIGHT])
@pytest.mark.parametrize("altitude_m", HEIGHTS_M)
@pytest.mark.parametrize("air", ["haze", "fog under the stratosphere", "a small planet's"])
def test_the_cards_table_aloft_is_the_processors(compute, fields, air, altitude_m, sun_deg):
    """Sky, limb, and the ground behind air, up to where the planet is small; at night the twilight
    at its edge is all there is."""
    assert apart(compute, fields[air], sun_deg, altitude_m=altitude_m) < 2.0 * WORST[air]


@pytest.mark.gl
def test_a_sun_in_the_zenith_and_a_table_of_another_size(compute, fields):
    """The sun has no azimuth; no work group divides the rows and columns."""
    assert apart(compute, fields["haze"], 90.0, finer=1.33) < WORST["haze"]


@pytest.mark.parametrize("sun_deg", [NOON, LOW, SET, DEEP, NIGHT])
@pytest.mark.parametrize("altitude_m", HEIGHTS_M)
@pytest.mark.parametrize("air", ["haze", "fog under the stratosphere", "a small planet's"])
def test_the_coarse_table_tells_the_scale(fields, air, altitude_m, sun_deg):
    """A mirrored sky is in half precision: its brightest texel must stay below the largest half,
    and its darkest parts above the smallest."""
    where = fields[air], altitude_m, sun_at(sun_deg)
    scale, right = (
        cube_scale(view, np.zeros(3)) for view in (coarse_view(*where), sky_view(*where))
    )
    assert right <= ROOM_ALOFT * scale <= 64.0 * right


@pytest.mark.gl
def test_two_skies_in_one_job_keep_their_tables_apart(compute, fields):
    """A night's sum: each sky's cube is drawn before the next one's table is written."""
    field, half = fields["haze"], np.full(3, 0.5)
    jobs = [job_of(field, NOON), job_of(field, LOW)]
    total = compute(sum_of_parts([(job, half) for job in jobs]))[..., :3]
    each = [compute(job)[..., :3] for job in jobs]
    np.testing.assert_allclose(total, 0.5 * each[0] + 0.5 * each[1], rtol=1e-6)
    assert not np.allclose(*each, rtol=0.1)


def test_a_moved_sun_brings_no_buffer(fields):
    """Tables and the matter along rays are the same objects, which the card has already; only in
    twilight rays have other bins. The recipe is another, and that of an equal sun the same."""

    def sent(job, step):
        kept = dict(first.programs[step].buffers)
        return [at for at, values in job.programs[step].buffers if values is not kept[at]]

    for altitude_m in (0.0, 3e4):
        first, again, moved, low = (
            job_of(fields["haze"], sun, altitude_m=altitude_m) for sun in (NOON, NOON, 40.0, SET)
        )
        assert first.recipe == again.recipe != moved.recipe
        assert [sent(moved, step) for step in (0, 1)] == [[], []]
        assert sent(low, 0) == [BINS, ROWS]
