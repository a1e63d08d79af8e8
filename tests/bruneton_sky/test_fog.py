"""Ground fog: its visibility, its density, and the computations that take it into account."""

from dataclasses import replace

import numpy as np
import pytest
from bruneton_sky import Atmosphere, earth_spectral, precompute, single_scattering
from bruneton_sky.atmosphere import KOSCHMIEDER
from bruneton_sky.geometry import horizon_mu, make_ray, y_at_top
from bruneton_sky.optical_path import optical_depth, optical_depth_to_top
from bruneton_sky.published.pipeline.pipeline import run_pipeline
from bruneton_sky.published.precompute import march_tables, transmittance_table
from bruneton_sky.published.single_scattering import scattered_without_phase
from bruneton_sky.raised_ground import raise_ground
from bruneton_sky.settings import BrunetonSkySettings, atmosphere_of, spectral_atmosphere_of
from bruneton_sky.single_scattering_kernels import fast_scattered_without_phase
from bruneton_sky.solver import solve
from bruneton_sky.sun_light import sun_irradiance
from bruneton_sky.tables.sizes import TableSizes
from hypothesis import given
from hypothesis import strategies as st
from long_parameters import mostly_long
from shader_probe import ShaderProbe

from vrut_lite.errors import UserError
from vrut_lite.kernel.settings import change

AIR = earth_spectral((600.0, 550.0, 450.0)).with_aerosol(0.1)
SIZES = TableSizes(altitude=4, mu=8, nu=4, mu_s=6)


def rays(mu_s: float) -> tuple[np.ndarray, np.ndarray]:
    """mu, nu of views all around and close to the level."""
    down = np.linspace(-1.0, -0.1, 6)
    mu = np.concatenate([down, [-1e-3, 0.0, 1e-3, 0.01], -down])
    return mu, mu * mu_s + 0.5 * np.sqrt((1.0 - mu**2) * (1.0 - mu_s**2))


@pytest.mark.parametrize("visibility_m", [50.0, 200.0, 1000.0, 10_000.0])
def test_contrast_at_the_visibility_is_two_percent(visibility_m: float) -> None:
    """All the air at the ground together leaves 2 % of contrast at the visibility at 550 nm."""
    foggy = AIR.with_fog(visibility_m, 100.0)
    at_550 = sum(kind.extinction[1] for kind in foggy.scatterers())
    assert at_550 == pytest.approx(KOSCHMIEDER / visibility_m, rel=1e-12)
    assert np.exp(-KOSCHMIEDER) == pytest.approx(0.02, rel=1e-3)
    assert foggy.fog_scattering == foggy.fog_extinction
    assert len(set(foggy.fog_extinction)) == 1


def test_hazy_air_gets_no_fog() -> None:
    """Through air of optical depth 1 over 1200 m one sees 4.6 km: there is no fog of 6 km, and
    one of 4.5 km starts from nothing, without a jump."""
    hazy = AIR.with_aerosol(1.0)
    assert not hazy.with_fog(6000.0, 100.0).foggy
    assert 0.0 < hazy.with_fog(4500.0, 100.0).fog_extinction[0] < 3e-5
    with pytest.raises(ValueError, match=r"visibility_m must lie between 0\.001 and"):
        AIR.with_fog(0.0, 100.0)


@pytest.mark.parametrize("height_m", [5.0, 100.0, 1000.0])
def test_optical_depth_is_that_of_quadrature(height_m: float, other_planet: Atmosphere) -> None:
    """The closed form against 20,000 midpoints in y, from a level ray to the zenith: 1e-6."""
    for planet in (AIR, other_planet):
        fog = replace(planet.with_fog(200.0, height_m), rayleigh_scattering=0.0, mie_scattering=0.0)
        fog = replace(fog, mie_extinction=0.0, absorption_extinction=0.0)
        for altitude_m in (0.0, 1.7, 3.0 * height_m):
            lowest = float(horizon_mu(fog.ground_radius_m, altitude_m))
            mu = np.array([lowest + 1e-4, 0.0, 0.01, 0.3, 1.0])
            ray = make_ray(fog.ground_radius_m, altitude_m, mu)
            top_m = min(40.0 * height_m + altitude_m, fog.top_altitude_m)
            end = y_at_top(ray, top_m)
            share = (np.arange(20_000) + 0.5) / 20_000
            y = ray.y[:, None] + (end - ray.y)[:, None] * share
            altitude = ray.perigee_altitude_m[:, None] + y * y
            p = ray.perigee_radius_m[:, None]
            metres = 2.0 * (y * y + p) / np.sqrt(y * y + 2.0 * p) * (end - ray.y)[:, None] / 20_000
            expected = (np.exp(-altitude / height_m) * metres).sum(axis=1) * fog.fog_extinction[0]
            ours = optical_depth(fog, ray, np.asarray(top_m), end)[:, 0]
            np.testing.assert_allclose(ours, expected, rtol=1e-6)


@pytest.mark.parametrize("mu_s", [0.9, 0.3, 0.05, -0.03])
def test_compiled_kernel_agrees_with_numpy(mu_s: float) -> None:
    """Light scattered once: the compiled rule and numpy's differ by rounding, 1e-6."""
    foggy = AIR.with_fog(200.0, 100.0)
    mu, nu = rays(mu_s)
    for altitude_m in (0.0, 2.0, 100.0, 3000.0, 50_000.0):
        twin = scattered_without_phase(foggy, altitude_m, mu, mu_s, nu)
        fast = fast_scattered_without_phase(foggy, altitude_m, mu, mu_s, nu)
        for ours, exact in zip(fast, twin, strict=True):
            np.testing.assert_allclose(ours, exact, rtol=1e-6, atol=1e-9 * exact.max())


@pytest.mark.parametrize(
    "rule", mostly_long(["midpoint", "trapezoid", "simpson"], "simpson".__eq__)
)
def test_classical_rules_agree_in_fog(rule: str) -> None:
    """Textbook rules that know nothing of fog's top find the same light as 48 nodes on each
    segment: 1 % of the brightest ray, in air so low that even intervals resolve the fog."""
    foggy = replace(AIR.with_fog(500.0, 100.0), top_altitude_m=3000.0)
    mu, nu = rays(0.6)
    steep = np.abs(mu) > 0.05
    for altitude_m in (2.0, 300.0):
        exact = single_scattering(foggy, altitude_m, mu[steep], 0.6, nu[steep], samples=48)
        ours = single_scattering(
            foggy, altitude_m, mu[steep], 0.6, nu[steep], rule=rule, samples=(1000, 300)
        )
        assert np.abs(ours - exact).max() < 0.01 * exact.max()


def test_fog_stands_on_the_local_ground() -> None:
    """A plateau has the fog of the plain: in settings, and in air whose ground is raised."""
    wish = BrunetonSkySettings(fog_visibility_m=300.0, fog_height_m=50.0)
    plain, plateau = atmosphere_of(wish), atmosphere_of(wish, 1500.0)
    at_ground = [sum(k.extinction for k in air.scatterers()) for air in (plain, plateau)]
    for total in at_ground:
        assert np.interp(550.0, (520.0, 570.0), total[[2, 1]]) == pytest.approx(
            KOSCHMIEDER / 300.0, rel=1e-3
        )
    assert raise_ground(plain, 1500.0).fog_extinction == plain.fog_extinction
    assert plateau.fog_scale_height_m == 50.0


def test_without_fog_there_is_no_scatterer_for_it() -> None:
    """No fog is the default and adds no term."""
    clear = atmosphere_of(BrunetonSkySettings())
    assert not clear.foggy
    assert "fog" not in {each.name for each in clear.scatterers()}
    assert atmosphere_of(BrunetonSkySettings(fog_height_m=500.0)) == clear


@pytest.mark.parametrize(
    ("name", "value"),
    [("fog_visibility_m", 49.0), ("fog_visibility_m", 1e5), ("fog_height_m", 1.0)],
)
def test_settings_have_bounds(name: str, value: float) -> None:
    """Values outside the bounds of the fog settings are refused."""
    with pytest.raises(UserError, match=name):
        change(BrunetonSkySettings(), "bruneton_sky", name, value)


def test_sun_shines_through_fog() -> None:
    """The sun's light falls by the fog's own depth over the sine of its elevation."""
    wish = BrunetonSkySettings(fog_visibility_m=200.0, fog_height_m=20.0)
    foggy, clear = spectral_atmosphere_of(wish), spectral_atmosphere_of(BrunetonSkySettings())
    passed = sun_irradiance(foggy, 0.0, 0.5) / sun_irradiance(clear, 0.0, 0.5)
    np.testing.assert_allclose(passed, np.exp(-foggy.fog_extinction[0] * 20.0 / 0.5), rtol=1e-3)
    table = transmittance_table(foggy, TableSizes())
    np.testing.assert_allclose(table[0, 0], np.exp(-optical_depth_to_top(foggy, 0.0, 1.0)))


def test_published_tables_refuse_fog() -> None:
    """The lowest two of 32 altitudes stand 60 m apart and the next 180 m: one sentence says so."""
    foggy = AIR.with_fog(500.0, 100.0)
    for make in (
        lambda: precompute(foggy, sizes=SIZES),
        lambda: run_pipeline(foggy, SIZES),
        lambda: march_tables(solve(foggy, 1), SIZES),
    ):
        with pytest.raises(ValueError, match="cannot hold ground fog"):
            make()


@given(
    st.floats(50.0, 20_000.0), st.floats(5.0, 1000.0), st.floats(0.0, 60_000.0),
    st.floats(-1.0, 1.0), st.floats(-0.3, 1.0),
)  # fmt: skip
def test_radiance_is_finite_and_not_negative(
    visibility_m: float, height_m: float, altitude_m: float, mu: float, mu_s: float
) -> None:
    """Finite and not negative, whatever the fog, the observer, the view and the sun."""
    foggy = AIR.with_fog(visibility_m, height_m)
    light = single_scattering(foggy, altitude_m, mu, mu_s, mu * mu_s)
    assert np.isfinite(light).all()
    assert (light >= 0.0).all()


@pytest.mark.gl
@pytest.mark.parametrize("rule", ["gauss-legendre", "midpoint", "trapezoid", "simpson"])
def test_shader_agrees_with_the_cpu(gl_owner, rule: str) -> None:
    """GLSL in float32 against float64: 1e-3 of each ray's light where it is a thousandth of the
    brightest at least, the limit that clear air keeps in twilight."""
    foggy = AIR.with_fog(300.0, 100.0)
    samples = 24 if rule == "gauss-legendre" else (32, 16)
    probe = ShaderProbe(gl_owner)
    for mu_s in (0.8, 0.2, -0.02):
        mu, nu = rays(mu_s)
        for altitude_m in (0.0, 2.0, 100.0, 2000.0):
            columns = np.broadcast_arrays(altitude_m, mu, mu_s, nu)
            given_rays = np.stack(columns, axis=1).astype(np.float32)
            exact = single_scattering(foggy, *given_rays.astype(float).T, rule, samples)
            ours = probe.radiance(foggy, given_rays, rule, samples)
            assert np.isfinite(ours).all()
            lit = exact > 1e-3 * exact.max()
            assert np.abs(ours / np.where(lit, exact, 1.0) - 1.0)[lit].max() < 1e-3
            assert np.abs(ours - exact)[~lit].max(initial=0.0) < 1e-5 * exact.max()
