"""The integration rules of the study: against each other's twins, and against the integral."""

from dataclasses import replace

import numpy as np
import pytest
from bruneton_sky import Atmosphere, single_scattering

from vrut_lite_lab.study.rules.against_truth import (
    RuleError,
    fewest_nodes,
    gauss_legendre_radiance,
    rule_errors,
    truth,
)
from vrut_lite_lab.study.rules.airs import SeaLevelRays, rays_to, rgb_airs, spectral_airs
from vrut_lite_lab.study.rules.kernels import classical_radiance
from vrut_lite_lab.study.rules.run_times import cpu_run_times

# notes: "Quadrature and numerical stability", section 2: relative RMSE in atmosphere A.
PUBLISHED = {
    25.0: {
        "midpoint": (3.4e-2, 6.7e-4, 4.2e-5),
        "trapezoid": (7.6e-2, 1.4e-3, 8.7e-5),
        "simpson-trapezoid": (2.3e-2, 1.6e-5, 1.8e-7),
    },
    87.0: {
        "midpoint": (2.6e-2, 4.3e-4, 2.7e-5),
        "trapezoid": (4.4e-2, 7.4e-4, 4.7e-5),
        "simpson-trapezoid": (8.8e-3, 8.2e-6, 9.7e-8),
    },
    93.0: {
        "midpoint": (9.8e-3, 5.8e-4, 1.6e-4),
        "trapezoid": (1.7e-2, 6.4e-4, 1.2e-4),
        "simpson-trapezoid": (7.1e-3, 6.3e-4, 1.5e-4),
    },
}
COARSE = ((16, 8), (128, 64))
FINEST = ((512, 256),)


@pytest.fixture(scope="module")
def coarse() -> dict[float, list[RuleError]]:
    """Errors in atmosphere A of all but the finest samples, by the sun's zenith angle."""
    air = spectral_airs()["A"]
    return {sun: list(rule_errors("A", air, sun, COARSE, (8, 12))) for sun in (25, 60, 80, 87, 93)}


def rms(errors: list[RuleError], rule: str, samples: int | tuple[int, int]) -> float:
    (found,) = (each.rms for each in errors if (each.rule, each.samples) == (rule, samples))
    return found


@pytest.mark.parametrize("sun", PUBLISHED)
def test_errors_are_those_of_the_note(coarse, sun: float) -> None:
    """The reference table's figures come out, to the two digits that it prints."""
    for rule, (low, medium, _) in PUBLISHED[sun].items():
        assert rms(coarse[sun], rule, (16, 8)) == pytest.approx(low, rel=0.05)
        assert rms(coarse[sun], rule, (128, 64)) == pytest.approx(medium, rel=0.05)


@pytest.mark.parametrize("sun", [25.0, 93.0])
def test_errors_of_the_finest_samples_are_those_of_the_note(sun: float) -> None:
    """At 512 x 256 too; the note's rms over the 81 rays is met on nine of them within a third."""
    air, rays = spectral_airs()["A"], rays_to(sun)
    # One direction of each ring, toward the sun, away from it and across.
    some = [0, 8, 40, 41, 44, 72, 76, 36, 80]
    rays = SeaLevelRays(rays.mu[some], rays.mu_s, rays.nu[some])
    right = truth(air, rays)
    for rule, (_, _, finest) in PUBLISHED[sun].items():
        off = classical_radiance(air, rays, rule, (512, 256)) / right - 1.0
        assert 0.3 < np.sqrt((off**2).mean()) / finest < 3.0


def test_low_sample_order_holds_wherever_the_sun_is_up(coarse) -> None:
    """At 16 x 8 Simpson errs least and trapezoid most, for zenith angles of 0 to 93 degrees."""
    for errors in coarse.values():
        of = [rms(errors, rule, (16, 8)) for rule in ("simpson", "midpoint", "trapezoid")]
        assert of == sorted(of)


def test_trapezoid_is_the_worst_at_medium_quality(coarse) -> None:
    """At 128 x 64, where the published ranking calls it the best (26.2 of 26.2 to 26.4 mW)."""
    for sun in (25, 60, 80, 87):
        others = ("midpoint", "simpson", "simpson-trapezoid")
        worst = max(rms(coarse[sun], rule, (128, 64)) for rule in others)
        assert rms(coarse[sun], "trapezoid", (128, 64)) > 1.5 * worst


@pytest.mark.parametrize("sun", [25.0, 60.0, 87.0])
def test_midpoint_errs_half_as_much_the_other_way(sun: float) -> None:
    """Theory: -1/2 of the trapezoid's error; a midpoint's own half cell of depth spoils a third."""
    air, rays = spectral_airs()["A"], rays_to(sun)
    right = truth(air, rays)
    midpoint, trapezoid = (
        classical_radiance(air, rays, rule, (128, 64)) / right - 1.0
        for rule in ("midpoint", "trapezoid")
    )
    assert np.linalg.norm(midpoint + 0.5 * trapezoid) < 0.35 * np.linalg.norm(midpoint)


@pytest.mark.parametrize("rule", ["midpoint", "trapezoid", "simpson"])
@pytest.mark.parametrize("sun", [0.0, 60.0, 90.0, 96.0])
def test_kernel_is_the_twin(rule: str, sun: float) -> None:
    """The compiled rules are `single_scattering`'s: the same sums in another order (1e-11)."""
    air, rays = rgb_airs()["evaluation"], rays_to(sun)
    twin = single_scattering(air, 0.0, *rays, rule=rule, samples=(12, 6))
    fast = classical_radiance(air, rays, rule, (12, 6))
    np.testing.assert_allclose(fast, twin, rtol=1e-11)


def test_kernel_is_the_twin_on_another_planet() -> None:
    """Nothing of the Earth is built in: a small planet with high, thin, red-absorbing air."""
    mars = replace(
        Atmosphere.earth(ozone=False),
        ground_radius_m=3_389_500.0,
        top_altitude_m=100_000.0,
        rayleigh_scale_height_m=11_000.0,
        mie_scale_height_m=9000.0,
        mie_extinction=(6e-5, 5e-5, 4.5e-5),
    )
    rays = rays_to(70.0)
    twin = single_scattering(mars, 0.0, *rays, rule="simpson", samples=(20, 10))
    np.testing.assert_allclose(
        classical_radiance(mars, rays, "simpson", (20, 10)), twin, rtol=1e-11
    )


def test_the_other_simpson_gives_odd_nodes_the_trapezoids_depth() -> None:
    """Plain sums over one ray: even nodes by Simpson's rule, odd ones half a step further."""
    air, rays = rgb_airs()["A"], SeaLevelRays(np.array([1.0]), 1.0, np.array([1.0]))
    # Toward the zenith with the sun there, all light passes the same column: numbers for one.
    nodes, step = np.linspace(0.0, 60_000.0, 5), 15_000.0
    total = np.zeros(3)
    for weight, h, k in zip((1, 4, 2, 4, 1), nodes, range(5), strict=True):
        depth = np.zeros(3)
        for kind in air.scatterers():
            d = np.exp(-nodes / kind.scale_height_m)
            path = step / 3 * sum(d[j] + 4 * d[j + 1] + d[j + 2] for j in range(0, k - 1, 2))
            path += step / 2 * (d[k - 1] + d[k]) * (k % 2)
            light = np.exp(-np.linspace(h, 60_000.0, 3) / kind.scale_height_m)
            path += (60_000.0 - h) / 6 * (light[0] + 4 * light[1] + light[2])
            depth += path * kind.extinction
        for kind, phase in zip(air.scatterers(), (3 / (8 * np.pi), _mie_forward(0.8)), strict=True):
            source = kind.scattering * phase * np.exp(-h / kind.scale_height_m)
            total += weight * step / 3 * source * np.exp(-depth)
    got = classical_radiance(air, rays, "simpson-trapezoid", (4, 2))[0]
    np.testing.assert_allclose(got, total, rtol=1e-9)


def _mie_forward(g: float) -> float:
    """Cornette and Shanks's function straight ahead."""
    return 3 / (4 * np.pi) * (1 - g * g) / ((2 + g * g) * (1 - g) ** 3)


@pytest.mark.long
def test_few_nodes_reach_simpsons_finest() -> None:
    """Ten Gauss-Legendre nodes err less than 512 x 256 Simpson, by day in either atmosphere."""
    for name, air in spectral_airs().items():
        errors = list(rule_errors(name, air, 25.0, FINEST, (8, 10)))
        found = fewest_nodes(errors, "simpson")
        assert found is not None
        assert found.samples == 10


def test_no_number_of_nodes_is_invented() -> None:
    """Where no tried number of nodes is enough, the study says so instead of naming one."""
    errors = [
        RuleError("A", 25.0, "simpson", (512, 256), 1e-9, 1e-8),
        RuleError("A", 25.0, "gauss-legendre", 4, 1e-3, 1e-2),
    ]
    assert fewest_nodes(errors, "simpson") is None


def test_compiled_gauss_legendre_is_the_twin() -> None:
    """What is timed is what is measured: kernel and float64 twin agree to the kernel's 1e-8."""
    air, rays = spectral_airs()["evaluation"], rays_to(87.0)
    twin = single_scattering(air, 0.0, *rays, samples=10)
    np.testing.assert_allclose(gauss_legendre_radiance(air, rays, 10), twin, rtol=2e-8)


def test_directions_in_shadow_do_not_count() -> None:
    """With the sun at 96 degrees some rays see nothing lit: errors are finite all the same."""
    errors = list(rule_errors("A", spectral_airs()["A"], 96.0, ((16, 8),), (8,)))
    # The note: 0.07 midpoint, 0.17 trapezoid, 0.10 Simpson; it does not say which rays it left out.
    assert rms(errors, "midpoint", (16, 8)) == pytest.approx(0.07, rel=0.12)
    assert rms(errors, "trapezoid", (16, 8)) == pytest.approx(0.17, rel=0.12)
    assert rms(errors, "simpson-trapezoid", (16, 8)) == pytest.approx(0.10, rel=0.12)


@pytest.mark.long
def test_run_times_hold_the_error_of_what_was_timed() -> None:
    """A line of the run times has the error of that rule at three wavelengths."""
    lines = list(cpu_run_times(rgb_airs()["A"], 25.0, ((16, 8),), (8,)))
    assert [(line.rule, line.samples) for line in lines][-1] == ("gauss-legendre", 8)
    assert all(line.ns_per_ray > 0 for line in lines)
    # The note, for three wavelengths and 25 and 80 degrees together: 2.0e-2 and 1.2e-6.
    assert 1e-2 < lines[2].rms < 4e-2
    assert lines[-1].rms < 1.2e-6


@pytest.mark.long
@pytest.mark.gl
def test_shader_errs_like_its_twin() -> None:
    """On the upper face Simpson 16 x 8 errs by its rule, 12 nodes by single precision only."""
    from vrut_lite.geometry.cube_map import texel_directions
    from vrut_lite_lab.study.rules.shader_run_times import shader_run_times

    air = rgb_airs()["A"]
    said, lines = shader_run_times(air, 60.0, ((16, 8),), (12,), size=8)
    assert said
    errors = {line.rule: line.rms for line in lines}
    zenith = np.radians(60.0)
    face = texel_directions(8)[2].reshape(-1, 3)
    nu = face @ [0.0, np.cos(zenith), -np.sin(zenith)]
    rays = SeaLevelRays(face[:, 1], float(np.cos(zenith)), nu)
    off = classical_radiance(air, rays, "simpson", (16, 8)) / truth(air, rays) - 1.0
    assert errors["simpson"] == pytest.approx(np.sqrt((off**2).mean()), rel=1e-3)
    assert errors["gauss-legendre"] < 2e-6
    assert "simpson-trapezoid" not in errors
