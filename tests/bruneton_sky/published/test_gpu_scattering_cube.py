"""The job that writes single scattering as a cube map, against the float64 twin per texel."""

from dataclasses import replace

import numpy as np
import pytest
from bruneton_sky import Atmosphere, single_scattering
from bruneton_sky.geometry import end_of_ray, make_ray
from bruneton_sky.optical_path import optical_depth
from bruneton_sky.presets import COLOUR_NM, earth_spectral, preset
from bruneton_sky.published.gpu_single_scattering import single_scattering_cube_job

from vrut_lite.geometry.colour import rgb_from_spectrum
from vrut_lite.geometry.cube_map import texel_directions

GROUND = np.array([20.0, 30.0, 10.0])
SUN = np.array([0.3, 0.4, -0.866])
SUN = SUN / np.linalg.norm(SUN)


def cube_job(air: Atmosphere, altitude_m: float = 0.0, sun=SUN, size: int = 16, **options):
    """A job of the tests' module, read back in single precision unless asked otherwise."""
    options = {"format": "rgba32f", "read_back": True} | options
    return single_scattering_cube_job("test", "cube", air, altitude_m, sun, size, **options)


def twin_cube(air: Atmosphere, altitude_m: float, sun, size: int, **options):
    """The cube (6, size, size, 3) in float64: air light, and the ground through the air."""
    directions = texel_directions(size)
    mu = directions[..., 1]
    nu = np.clip(directions @ sun, -1.0, 1.0)
    spectral = single_scattering(air, altitude_m, mu, sun[1], nu, **options)
    rgb = rgb_from_spectrum(spectral, air.wavelength_nm)
    ray = make_ray(air.ground_radius_m, altitude_m, mu)
    seen = np.exp(-optical_depth(air, ray, *end_of_ray(ray, air.top_altitude_m)))
    return rgb + ray.hits_ground()[..., None] * seen * GROUND


@pytest.mark.gl
@pytest.mark.parametrize("altitude_m", [0.0, 2000.0, 30_000.0, 60_000.0])
@pytest.mark.parametrize("size", [16, 7])
def test_texels_agree_with_the_cpu(compute, altitude_m: float, size: int) -> None:
    """From the ground to the top, faces in OpenGL's order, in an even and an odd size."""
    air = preset("earth-clear")
    cube = compute(cube_job(air, altitude_m, size=size, ground_rgb=GROUND))
    assert cube == pytest.approx(twin_cube(air, altitude_m, SUN, size), rel=5e-5)


@pytest.mark.gl
@pytest.mark.parametrize("rule", ["midpoint", "trapezoid", "simpson"])
def test_every_rule_agrees_with_the_cpu(compute, rule: str) -> None:
    """The rule is a uniform: the cube of any of them is right to float32."""
    air, options = earth_spectral(COLOUR_NM), {"rule": rule, "samples": (16, 8)}
    cube = compute(cube_job(air, 100.0, ground_rgb=GROUND, **options))
    assert cube == pytest.approx(twin_cube(air, 100.0, SUN, 16, **options), rel=5e-5)


@pytest.mark.gl
def test_sun_below_the_horizon(compute) -> None:
    """Three degrees down, where the planet's shadow crosses the sky."""
    air = preset("earth-twilight")
    sun = np.array([np.cos(-0.05), np.sin(-0.05), 0.0])
    cube = compute(cube_job(air, 1.7, sun))
    truth = twin_cube(air, 1.7, sun, 16)
    sky = texel_directions(16)[..., 1] > 0
    assert cube[sky] == pytest.approx(truth[sky], rel=2e-4)
    assert truth[sky].min() > 0


@pytest.mark.gl
def test_half_precision_is_rounded_not_cut(compute) -> None:
    """Half an ulp of float16, in units of the scale; the mean error is nothing."""
    air = preset("earth-clear")
    truth = twin_cube(air, 0.0, SUN, 16)
    sky = texel_directions(16)[..., 1] > 0
    halves = compute(cube_job(air, scale=4.0, format="rgba16f"))[sky]
    exact = truth[sky] / 4.0
    half_ulp = 0.5 * np.spacing(exact.astype(np.float16)).astype(float)
    assert (np.abs(halves - exact) <= half_ulp + 5e-5 * exact).all()
    assert abs(np.mean(halves / exact - 1.0)) < 3e-5


@pytest.mark.gl
def test_only_the_faces_asked_for_are_computed(compute) -> None:
    """A layer of work groups for each wanted face; they are the same texels."""
    air = preset("mars-like")
    whole = compute(cube_job(air))
    some = compute(cube_job(air, wanted=(2, 5)))
    np.testing.assert_array_equal(some[[2, 5]], whole[[2, 5]])
    assert cube_job(air, wanted=(2, 5)).groups == (2, 2, 2)


def test_another_atmosphere_uses_the_same_shader() -> None:
    """Every parameter is a uniform: the driver compiles once."""
    job = cube_job(preset("earth-clear"))
    others = [
        cube_job(preset("mars-like")),
        cube_job(preset("earth-hazy"), 5000.0, -SUN),
        cube_job(preset("earth-clear"), rule="simpson", samples=(32, 16)),
        cube_job(replace(preset("earth-clear"), mie_phase="henyey-greenstein")),
        cube_job(preset("earth-clear"), samples=8),
    ]
    assert {other.compute_shader for other in others} == {job.compute_shader}
    assert len({other.recipe for other in [job, *others]}) == len(others) + 1
    lengths = [[np.size(value) for value in other.uniforms.values()] for other in others]
    assert lengths == [[np.size(value) for value in job.uniforms.values()]] * len(others)


def test_shader_skips_an_absorber_that_absorbs_nothing() -> None:
    """Without ozone the shader is told of no absorber, and skips its paths."""
    assert cube_job(preset("earth-2008")).uniforms["absorber_nodes"] == 0
    assert cube_job(preset("earth-clear")).uniforms["absorber_nodes"] == 3


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"samples": 33}, "samples"),
        ({"samples": 0}, "samples"),
        ({"samples": (16, 8)}, "samples"),
        ({"rule": "boole", "samples": (4, 4)}, "rule"),
        ({"rule": "simpson", "samples": (5, 4)}, "even"),
        ({"altitude_m": -1.0}, "altitude_m"),
        ({"altitude_m": 60_001.0}, "altitude_m"),
        ({"altitude_m": float("nan")}, "altitude_m"),
        ({"air": earth_spectral(np.linspace(400, 700, 8))}, "wavelengths"),
        (
            {
                "air": replace(
                    Atmosphere.earth(),
                    absorber_altitude_m=tuple(range(9)),
                    absorber_density=(1.0,) * 9,
                )
            },
            "absorber nodes",
        ),
    ],
)
def test_arguments_beyond_the_shader_are_refused(options: dict, words: str) -> None:
    """One sentence, before anything reaches the GPU."""
    given = {"air": preset("earth-clear")} | options
    with pytest.raises(ValueError, match=words):
        cube_job(**given)
