"""The GPU's cube map against the float64 model, texel by texel."""

import numpy as np
import pytest
from dynamic_skylight import HosekWilkieSky
from dynamic_skylight.hosek_wilkie.gpu_cube import gpu_cube_job
from dynamic_skylight.hosek_wilkie.sky import half_scale
from exact_cube import twin_cube

from vrut_lite.geometry.cube_map import texel_directions

GROUND = (1.0, 2.0, 3.0)


def on_gpu(compute, sky, azimuth, size, **wanted):
    """The map (6, size, size, 3) in W m^-2 sr^-1."""
    scale = half_scale(sky.brightest)
    job = gpu_cube_job("test", "cube", sky, azimuth, GROUND, size, scale, read_back=True, **wanted)
    return compute(job) * scale


def assert_rounded(cube, exact, scale):
    """Half an ulp of float16, and 2e-5 of max(value, 1 %) for single precision, no more."""
    half_ulp = 0.5 * np.spacing((exact / scale).astype(np.float16)).astype(float) * scale
    arithmetic = 2e-5 * np.maximum(exact, 1e-2 * exact.max())
    assert np.all(np.abs(cube - exact) <= half_ulp + arithmetic)


@pytest.mark.gl
@pytest.mark.parametrize("elevation_deg", [0.8, 12.0, 45.0, 89.0])
@pytest.mark.parametrize(("turbidity", "albedo"), [(1.0, 0.0), (3.0, 0.1), (10.0, 1.0)])
def test_every_texel_is_the_models_rounded(compute, turbidity, albedo, elevation_deg):
    """Within float16 rounding of the float64 twin, in clear air and haze, low and high sun."""
    sky = HosekWilkieSky(turbidity, albedo, np.radians(elevation_deg))
    exact = twin_cube(sky, 64, 2.0)
    exact[texel_directions(64)[..., 1] <= 0] = GROUND
    cube = on_gpu(compute, sky, 2.0, 64)
    assert_rounded(cube, exact, half_scale(sky.brightest))


@pytest.mark.gl
@pytest.mark.parametrize("elevation_deg", [0.8, 45.0])
def test_a_cards_float_cube_is_the_models(compute, elevation_deg):
    """In the format of "auto" on a card nothing is rounded: within 1e-4 of the float64 twin, each
    texel over the larger of its value and a hundredth of the brightest."""
    sky = HosekWilkieSky(3.0, 0.1, np.radians(elevation_deg))
    exact = twin_cube(sky, 128, 2.0)
    exact[texel_directions(128)[..., 1] <= 0] = GROUND
    cube = on_gpu(compute, sky, 2.0, 128, format="rgba32f")
    apart = np.abs(cube - exact) / np.maximum(exact, 1e-2 * exact.max())
    assert apart.max() < 1e-4


@pytest.mark.gl
def test_the_cpu_and_the_gpu_draw_the_same_sky(compute):
    """Whoever switches the device must not see it: one float16 step apart at most, 512 texels."""
    sky = HosekWilkieSky(4.0, 0.3, 0.3)
    scale = half_scale(sky.brightest)
    cpu = sky.cube_map_float16(512, -1.0, scale)
    gpu = on_gpu(compute, sky, -1.0, 512) / scale
    up = texel_directions(512)[..., 1] > 0
    apart = np.abs(gpu[up] - cpu[up].astype(float)) / np.spacing(cpu[up]).astype(float)
    assert apart.max() <= 1.0
    assert np.mean(apart > 0) < 0.05


@pytest.mark.gl
@pytest.mark.parametrize("size", [7, 20, 33])
def test_sizes_that_no_work_group_divides(compute, size):
    """Edges are written, and of an odd size the level row is ground as on the CPU."""
    sky = HosekWilkieSky(3.0, 0.1, 0.7)
    exact = twin_cube(sky, size, 0.5)
    exact[texel_directions(size)[..., 1] <= 1e-12] = GROUND
    assert_rounded(on_gpu(compute, sky, 0.5, size), exact, half_scale(sky.brightest))


@pytest.mark.gl
def test_only_the_faces_asked_for_are_computed(compute):
    """A layer of work groups for each wanted face; they are the same texels."""
    sky = HosekWilkieSky(3.0, 0.1, 0.7)
    whole = on_gpu(compute, sky, 0.5, 32)
    some = on_gpu(compute, sky, 0.5, 32, wanted=(2, 5))
    np.testing.assert_array_equal(some[[2, 5]], whole[[2, 5]])
    job = gpu_cube_job("test", "cube", sky, 0.5, GROUND, 32, 1.0, wanted=(2, 5))
    assert job.groups == (4, 4, 2)
    assert not job.read_back


@pytest.mark.gl
def test_the_gpu_rounds_instead_of_cutting(compute):
    """Mean signed rounding error near nothing: cut bits would darken by a quarter of 2^-10."""
    sky = HosekWilkieSky(3.0, 0.1, 0.7)
    exact = twin_cube(sky, 64, 0.5)
    up = texel_directions(64)[..., 1] > 0
    relative = on_gpu(compute, sky, 0.5, 64)[up] / exact[up] - 1.0
    assert abs(relative.mean()) < 2e-5
