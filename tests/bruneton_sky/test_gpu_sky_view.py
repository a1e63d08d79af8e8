"""The sky-view table's cube map: what the GPU makes of it against what the CPU does."""

from dataclasses import replace

import numpy as np
import pytest
from bruneton_sky import Atmosphere
from bruneton_sky.sky_view import fill_cube, sky_view
from bruneton_sky.sky_view.gpu import sky_view_job
from bruneton_sky.solver import SolverSizes, solve

GROUND = (3.0, 2.0, 1.0)
COARSE = SolverSizes(
    altitude=8, mu_s=8, direction_mu=8, direction_azimuth=8, degree=4, source_mu=8,
    source_azimuth=4, steps=12, node_bins=6, single_bins=12, multiple_bins=6,
)  # fmt: skip
NOON, LOW, SET = 65.0, 3.0, -5.0


@pytest.fixture(scope="module")
def field():
    """A coarsely solved Earth: any numbers will do."""
    return solve(Atmosphere.earth(), 2, COARSE)


def seen(field, altitude_m, sun_deg):
    """The table under a sun at an elevation, in no axis's plane."""
    elevation = np.radians(sun_deg)
    level = np.cos(elevation) * np.array([np.cos(0.7), np.sin(0.7)])
    return sky_view(field, altitude_m, np.array([level[0], np.sin(elevation), level[1]]))


def both(compute, view, size, **wanted):
    """Texels by the GPU and the CPU over the scale, and the scale."""
    job, scale = sky_view_job(view, size, GROUND, "test", "cube", read_back=True, **wanted)
    return compute(job), fill_cube(view, size, np.array(GROUND)) / scale, scale


def assert_rounded(gpu, cpu, single_precision=3e-5):
    """Half an ulp of float16, and a share of max(value, 1 %) for single precision, no more."""
    half_ulp = 0.5 * np.spacing(cpu.astype(np.float16)).astype(float)
    arithmetic = single_precision * np.maximum(cpu, 1e-2 * cpu.max())
    assert np.all(np.abs(gpu - cpu) <= half_ulp + arithmetic)


@pytest.mark.gl
@pytest.mark.parametrize("sun_deg", [NOON, LOW, SET])
@pytest.mark.parametrize("altitude_m", [0.0, 2000.0, 1e6])
def test_gpu_and_cpu_agree(compute, field, altitude_m, sun_deg):
    """From the ground, in the air and from space, by day, at sunset and in twilight.

    From space the last digit of 1 + mu is 1e-4 of a row of the limb's 80.
    """
    gpu, cpu, _ = both(compute, seen(field, altitude_m, sun_deg), 64)
    assert cpu.max() > 0
    assert_rounded(gpu, cpu, 3e-4 if altitude_m > 1e5 else 3e-5)


@pytest.mark.gl
@pytest.mark.parametrize("sun_deg", [NOON, LOW, SET])
def test_a_cards_float_cube_is_the_processors(compute, field, sun_deg):
    """In the format of "auto" on a card: within 1e-4, each texel over the larger of its value and
    a hundredth of the brightest."""
    gpu, cpu, _ = both(compute, seen(field, 2.0, sun_deg), 128, format="rgba32f")
    assert (np.abs(gpu - cpu) / np.maximum(cpu, 1e-2 * cpu.max())).max() < 1e-4


@pytest.mark.gl
@pytest.mark.parametrize("size", [7, 20, 33])
def test_sizes_that_are_no_multiple_of_a_work_group(compute, field, size):
    """The texels at the edges are written too."""
    gpu, cpu, _ = both(compute, seen(field, 2000.0, LOW), size)
    assert_rounded(gpu, cpu)


@pytest.mark.gl
def test_level_texels_show_the_sky(compute, field):
    """The middle row of an odd size is level, but for rounding: it shows no ground."""
    gpu, _, _ = both(compute, seen(field, 0.0, LOW), 33)
    sides = gpu[[0, 1, 4, 5]]
    level, above = sides[:, 16], sides[:, 15]
    assert np.all((level > 0.3 * above) & (level < 3.0 * above))
    np.testing.assert_array_equal(sides[:, 17:], np.broadcast_to(sides[0, 17, 0], (4, 16, 33, 3)))


@pytest.mark.gl
def test_a_sun_in_the_zenith_and_another_phase_function(compute, field):
    """The sun has no azimuth; Henyey and Greenstein's phase function has another form."""
    air = replace(field.atmosphere, mie_phase="henyey-greenstein", mie_g=-0.3)
    gpu, cpu, _ = both(compute, seen(replace(field, atmosphere=air), 0.0, 90.0), 32)
    assert_rounded(gpu, cpu)


@pytest.mark.gl
def test_only_the_faces_asked_for_are_computed(compute, field):
    """A layer of work groups for each wanted face; they are the same texels."""
    view = seen(field, 2000.0, LOW)
    whole, _, _ = both(compute, view, 16)
    some, _, _ = both(compute, view, 16, wanted=(2, 5))
    np.testing.assert_array_equal(some[[2, 5]], whole[[2, 5]])
    job, _ = sky_view_job(view, 16, GROUND, "test", "cube", wanted=(2, 5))
    assert job.groups == (2, 2, 2)
    assert not job.read_back


@pytest.mark.parametrize("altitude_m", [0.0, 1e6])
@pytest.mark.parametrize("sun_deg", [NOON, LOW, SET, -12.0])
def test_scale_fits_half_precision(field, altitude_m, sun_deg):
    """A power of two under which no texel overflows and few digits of the brightest are lost."""
    view = seen(field, altitude_m, sun_deg)
    _, scale = sky_view_job(view, 64, (0.0, 0.0, 0.0), "test", "cube")
    assert np.frexp(scale)[0] == 0.5
    brightest = fill_cube(view, 64, np.zeros(3)).max() / scale
    assert 2.0**8 < brightest < 2.0**15


def test_recipe_depends_on_the_table(field):
    """Equal tables make equal textures, another sun another."""
    jobs = [sky_view_job(seen(field, 0.0, sun), 8, GROUND, "test", "cube")[0] for sun in (5, 5, 6)]
    assert jobs[0].recipe == jobs[1].recipe != jobs[2].recipe
    assert jobs[0].compute_shader == jobs[2].compute_shader
