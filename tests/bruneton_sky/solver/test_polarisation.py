"""Q and U of the sky: operator, solver and output against independent programs and closed forms."""

from dataclasses import replace
from functools import lru_cache
from pathlib import Path

import numpy as np
import pytest
from bruneton_sky import Atmosphere, earth_spectral
from bruneton_sky.settings import BrunetonSkySettings, atmosphere_of
from bruneton_sky.solved_sky import SolvedSky
from bruneton_sky.solver import SolverSizes, solve
from bruneton_sky.solver.polarisation import (
    MOLECULES_RATIO,
    harmonics_at,
    molecules_terms,
    polarised_operator,
    wigner,
)
from bruneton_sky.solver.scattering_operator import legendre
from bruneton_sky.solver_rungs import rung_sizes, rung_tolerance
from plane_parallel import solve_slab, stokes_of_slab
from scalar_air import scalar_sky
from scipy.interpolate import CubicSpline

from vrut_lite.geometry.polarisation import neutral_points
from vrut_lite.numeric_types import FloatArray

DATA = Path(__file__).parents[2] / "data"

DEGREE = 5


def solved(atmosphere: Atmosphere, **sizes: int) -> SolvedSky:
    """The sky with all orders, at usual sizes but for some."""
    changed = replace(rung_sizes(atmosphere), **sizes)
    tolerance = rung_tolerance(atmosphere)
    return SolvedSky(field=solve(atmosphere, 20, changed, all_orders=True, tolerance=tolerance))


def nu_of(mu: FloatArray, mu_s: FloatArray, azimuth: FloatArray) -> FloatArray:
    """Cosine of the angle between views and sun."""
    return np.asarray(mu * mu_s + np.sqrt((1 - mu**2) * (1 - mu_s**2)) * np.cos(azimuth))


@pytest.mark.parametrize(
    ("depth", "mu_s", "albedo", "rows"),
    [
        (0.5, 0.2, 0.0, [
            (-0.1, 0, 0.35082997, 0.01524525, 0.0),
            (-0.52, 90, 0.09759154, 0.07273772, 0.02406753),
            (0.1, 90, 0.08801144, 0.05898050, 0.02077195),
            (0.84, 180, 0.05854240, 0.03041692, 0.0),
        ]),
        (1.0, 0.6, 0.8, [
            (-0.2, 60, 0.49089856, 0.03578087, 0.20191494),
            (-0.84, 120, 0.50469021, 0.06450226, 0.00462844),
            (0.52, 120, 0.39713938, 0.01320450, 0.11236937),
            (0.84, 180, 0.31265451, 0.08807208, 0.0),
        ]),
        (2.0, 0.5, 0.25, [
            (-0.1, 90, 0.38996680, 0.14594872, 0.20141378),
            (0.5, 90, 0.18418650, 0.03343917, 0.03374152),
            (0.9, 180, 0.17935403, 0.04973153, 0.0),
        ]),
    ],
)  # fmt: skip
def test_the_slab_has_the_published_light(depth, mu_s, albedo, rows) -> None:
    """I, |Q|, |U| of an irradiance of pi: Natraj, Li and Yung 2009 (depths 0.5 and 1), Natraj and
    Hovenier 2012 (depth 2), to 1e-4 of I. The slab is what the solver is held to."""
    slab = solve_slab(depth, mu_s, albedo)
    for mu, azimuth_deg, *expected in rows:
        ours = np.abs(np.pi * stokes_of_slab(slab, mu, np.radians(azimuth_deg)))
        assert ours == pytest.approx(expected, abs=1e-4 * expected[0])


def great_planet(depth: FloatArray, albedo: float, rho: float = 0.0) -> Atmosphere:
    """Molecules alone on a planet a hundred times as large as Earth, whose air is a slab."""
    earth, none = Atmosphere.earth(ozone=False), (0.0,) * 3
    height_m = earth.rayleigh_scale_height_m
    column_m = -height_m * np.expm1(-earth.top_altitude_m / height_m)
    return replace(
        earth,
        ground_radius_m=6.36e8,
        solar_irradiance=(1.0,) * 3,
        rayleigh_scattering=tuple(depth / column_m),
        mie_scattering=none,
        mie_extinction=none,
        ground_albedo=(albedo,) * 3,
        rayleigh_depolarisation=rho,
    )


@pytest.mark.parametrize("rho", [0.0285, 0.3])
@pytest.mark.parametrize("mu_s", [0.3, 0.6])
def test_a_great_planets_sky_is_that_of_the_slab(mu_s: float, rho: float) -> None:
    """On a planet a hundred times as large as Earth the air is a slab: from ground and space I is
    within 0.6 %, Q and U are within 0.4 % of I. Scalar transfer errs by 2 to 9 % there."""
    depth, albedo = np.array([0.1, 0.25, 0.5]), 0.3
    air = great_planet(depth, albedo, rho)
    sky, scalar, worst = solved(air), scalar_sky(air), 0.0
    for lane, tau in enumerate(depth):
        slab = solve_slab(tau, mu_s, albedo, air.rayleigh_anisotropy)
        for altitude_m, mu in ((0.0, 0.1), (0.0, 0.5), (0.0, 0.95), (1e5, -0.3), (1e5, -0.9)):
            for azimuth in np.radians([0.0, 60.0, 120.0, 180.0]):
                where = altitude_m, mu, mu_s, nu_of(mu, mu_s, azimuth)
                exact = stokes_of_slab(slab, mu, azimuth)
                if mu < 0.0:
                    exact[0] -= slab.ground * np.exp(tau / mu)
                ours = sky.stokes(*where)[lane]
                assert ours[0] == pytest.approx(exact[0], rel=6e-3)
                assert ours[1:] == pytest.approx(exact[1:], abs=4e-3 * exact[0])
                worst = max(worst, abs(scalar.radiance(*where)[lane] / exact[0] - 1.0))
    assert worst > 0.02


def matrix_of(nu: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """P11, P12, P33 of a smooth scattering matrix with P22 = P11."""
    p11 = (1.0 + 0.3 * nu + 0.4 * nu**2 + 0.1 * nu**3) / (4.0 * np.pi * (1.0 + 0.4 / 3.0))
    return p11, -0.4 * p11 * (1.0 - nu**2), p11 * nu


def frame(mu: FloatArray, phi: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Unit vectors (3, ...) of views, rising zenith angle, and rising azimuth."""
    mu, phi = np.broadcast_arrays(mu, phi)
    sine, c, s = np.sqrt(1.0 - mu**2), np.cos(phi), np.sin(phi)
    return (
        np.stack([sine * c, sine * s, mu]),
        np.stack([mu * c, mu * s, -sine]),
        np.stack([-s, c, np.zeros_like(c)]),
    )


def stokes_of(i: FloatArray, waves: FloatArray, mu: FloatArray, phi: FloatArray) -> FloatArray:
    """I, Q, U (3, n) of coefficients of harmonics, ordered by m, then l."""
    rows = [legendre(m, DEGREE, mu) * np.cos(m * phi) for m in range(DEGREE + 1)]
    polarised = np.einsum("kh,pkhn->pn", waves, harmonics_at(DEGREE, mu, phi))
    return np.concatenate([[i @ np.concatenate(rows)], polarised])


def test_harmonics_scatter_as_matrices_do() -> None:
    """Any light, with rotations from plane to plane and the matrix itself summed over directions,
    leaves with the coefficients that chi11, chi12, chi22 and chi33 make, to 1e-3 (the sum's error).
    """
    rng = np.random.default_rng(1)
    pairs = [(l, m) for m in range(DEGREE + 1) for l in range(m, DEGREE + 1)]  # noqa: E741
    shared = np.array([l >= 2 for l, _ in pairs])  # noqa: E741
    degree = np.array([l for l, _ in pairs])  # noqa: E741
    i, waves = rng.normal(size=len(pairs)), rng.normal(size=(2, shared.sum()))
    x, weight = np.polynomial.legendre.leggauss(40)
    p11, p12, p33 = (2.0 * np.pi * weight * part for part in matrix_of(x))
    chi11, chi12 = (wigner(0, s, DEGREE, x) @ part for s, part in ((0, p11), (2, p12)))
    plus = wigner(2, 2, DEGREE, x) @ (p11 + p33)
    minus = wigner(2, -2, DEGREE, x) @ (p11 - p33)
    chi22, chi33 = 0.5 * (plus + minus), 0.5 * (plus - minus)
    few = degree[shared]
    scattered = chi11[degree] * i
    scattered[shared] += chi12[few] * waves[0]
    polarised = np.stack([chi12[few] * i[shared] + chi22[few] * waves[0], chi33[few] * waves[1]])
    mu, w = np.polynomial.legendre.leggauss(24)
    turn = (np.arange(48) + 0.5) * 2.0 * np.pi / 48
    mu, turn = (part.ravel() for part in np.meshgrid(mu, turn, indexing="ij"))
    solid = np.repeat(w, 48) * 2.0 * np.pi / 48
    light, (n, theta, phi) = stokes_of(i, waves, mu, turn), frame(mu, turn)
    for mu_to, turn_to in ((0.3, 0.7), (-0.6, 2.0), (0.9, -1.0)):
        to, to_theta, to_phi = frame(np.array(mu_to), np.array(turn_to))
        nu = to @ n
        chi = 2.0 * np.arctan2(to @ phi, to @ theta)
        along = light[1] * np.cos(chi) + light[2] * np.sin(chi)
        across = light[2] * np.cos(chi) - light[1] * np.sin(chi)
        p11, p12, p33 = matrix_of(nu)
        q, u = p12 * light[0] + p11 * along, p33 * across
        chi = 2.0 * np.arctan2(-(to_phi @ n), -(to_theta @ n))
        summed = [
            (solid * part).sum()
            for part in (
                p11 * light[0] + p12 * along,
                q * np.cos(chi) - u * np.sin(chi),
                q * np.sin(chi) + u * np.cos(chi),
            )
        ]
        ours = stokes_of(scattered, polarised, np.array([mu_to]), np.array([turn_to]))[:, 0]
        assert summed == pytest.approx(ours, abs=1e-3)


def test_molecules_polarise_by_three_coefficients() -> None:
    """Their Q and U are those of e with 6^(1/2) times the radiance's coefficients of degree two."""
    mu, turn = np.array([0.8, -0.3, 0.1]), np.array([0.4, 2.0, 3.0])
    e = np.array([0.7, -0.2, 0.5])
    # Coefficients of 3 mu^2 - 1, mu s cos(phi), s^2 cos(2 phi) for unit i_20, i_21, i_22.
    b = e * np.sqrt([5.0 / 16.0, 15.0 / 4.0, 15.0 / 16.0]) / np.sqrt(np.pi)
    ours = np.einsum("t,ptn->pn", b, molecules_terms(mu, turn))
    exact = MOLECULES_RATIO * np.einsum("h,phn->pn", e, harmonics_at(2, mu, turn)[:, 0])
    assert ours == pytest.approx(exact, rel=1e-12)


def test_projection_finds_the_coefficients() -> None:
    """Q and U at the nodes give back e and b, to float32's 1e-5."""
    sizes = SolverSizes(polarised_mu=32)
    operator = polarised_operator(3e6, (0.0, 500.0, 20_000.0), sizes)
    waves = np.random.default_rng(2).normal(size=(2, operator.degree.size))
    # b of m = 0 makes odd light, which no sky has.
    waves[1, :4] = 0.0
    turn = (np.arange(6) + 0.5) * np.pi / 6
    mu = operator.directions.mu
    directions = np.broadcast_arrays(mu[..., None], turn)
    terms = harmonics_at(DEGREE, *(part.ravel() for part in directions))
    light = np.einsum("kh,pkhn->pn", waves, terms).reshape(2, *mu.shape, 6, 1)
    ours = operator.project(light.astype(np.float32))[..., 0]
    assert ours == pytest.approx(np.broadcast_to(waves, ours.shape), abs=1e-5)


@lru_cache
def hazy_sky(rho: float = 0.0285) -> SolvedSky:
    """The module's own air with molecules that depolarise."""
    return solved(replace(atmosphere_of(BrunetonSkySettings()), rayleigh_depolarisation=rho))


def test_the_sky_vibrates_across_the_scattering_plane() -> None:
    """Thin air of molecules alone: the vibration is across view and sun, on the stated side, and
    the degree is D (1 - nu^2) / (D (1 + nu^2) + 4 (1 - D) / 3)."""
    thin = replace(
        earth_spectral((500.0,), ozone=False),
        rayleigh_scattering=(1e-9,), mie_scattering=(0.0,), mie_extinction=(0.0,),
        ground_albedo=(0.0,), rayleigh_depolarisation=0.1,
    )  # fmt: skip
    sky, dipoles = solved(thin), thin.rayleigh_anisotropy
    for mu, mu_s, azimuth in ((0.5, 0.5, 1.0), (0.2, 0.8, 2.5), (0.9, 0.1, 1.6), (0.4, 0.3, 0.2)):
        nu = nu_of(np.array(mu), np.array(mu_s), np.array(azimuth))
        degree, angle = (part[0] for part in sky.polarisation(0.0, mu, mu_s, nu))
        share = dipoles * (1 - nu**2) / (dipoles * (1 + nu**2) + 4 / 3 * (1 - dipoles))
        assert degree == pytest.approx(share, abs=2e-4)
        # Clockwise from the sun, seen from above: a falling azimuth about +z.
        view, down, left = frame(np.array(mu), np.array(-azimuth))
        sun = frame(np.array(mu_s), np.array(0.0))[0]
        vibration = np.cos(angle) * -down + np.sin(angle) * left
        across = np.cross(view, sun)
        assert abs(vibration @ across) == pytest.approx(np.linalg.norm(across), rel=1e-4)


def test_the_zenith_is_polarised_as_the_suns_plane_says() -> None:
    """In the zenith Q is by the sun's vertical plane, and the limit of views in that plane."""
    mu = np.cos([0.0, 1e-3])
    q, u = np.moveaxis(hazy_sky().stokes(0.0, mu, 0.5, nu_of(mu, 0.5, 0.0)), -1, 0)[1:]
    assert q[0] == pytest.approx(q[1], rel=5e-3)
    assert np.abs(u).max() < 1e-4 * np.abs(q).max()
    assert q.max() < 0.0


# Cosines of the views' zenith angles in the file of Coulson's tables, and their degree of
# polarisation in the zenith by the cosine of the sun's zenith angle, depth 0.1.
COULSON_MU = np.array(
    [0.02, 0.06, 0.1, 0.16, 0.2, 0.28, 0.32, 0.4, 0.52, 0.64, 0.72, 0.84, 0.92, 0.96, 0.98, 1.0]
)
COULSON_ZENITH = {
    0.1: 0.01208528 / 0.01329056,
    0.2: 0.01464596 / 0.01708067,
    0.4: 0.01443698 / 0.02137087,
    0.6: 0.01145848 / 0.02596029,
    0.8: 0.00657989 / 0.03178761,
}


@lru_cache(maxsize=1)
def slab_sky() -> SolvedSky:
    """Slabs of depth 0.1, 0.25 and 0.5 over black ground."""
    return solved(great_planet(np.array([0.1, 0.25, 0.5]), 0.0))


@pytest.mark.parametrize(
    "row", np.loadtxt(DATA / "coulson_dave_sekera.txt"), ids=lambda row: f"{row[0]}-{row[1]}"
)
def test_neutral_points_are_coulsons(row: FloatArray) -> None:
    """Babinet's, Brewster's and Arago's points of molecules lie within 0.4 degrees of those of
    the tables of Coulson, Dave and Sekera, suns 6 to 53 degrees high."""
    depth, mu_s, towards, away = row[0], row[1], row[2:18], row[18:34]
    sun_deg, up_deg = np.degrees(np.arcsin([mu_s]))[0], np.degrees(np.arcsin(COULSON_MU))
    angle_deg = np.arange(up_deg[0], 180.0 - up_deg[0], 0.25)
    table_deg = np.concatenate([up_deg, 180.0 - up_deg[-2::-1]])
    printed = CubicSpline(table_deg, -np.concatenate([towards, away[-2::-1]]))(angle_deg)
    mu, nu = np.sin(np.radians(angle_deg)), np.cos(np.radians(angle_deg - sun_deg))
    lane = [0.1, 0.25].index(depth)
    q = slab_sky().stokes(0.0, mu, mu_s, nu)[:, lane, 1]
    found, exact = (neutral_points(angle_deg, values, sun_deg) for values in (q, printed))
    assert tuple(found) == pytest.approx(tuple(exact), abs=0.4, nan_ok=True)


def test_the_zenith_is_polarised_as_coulson_says() -> None:
    """The degree in the zenith of molecules is that of his tables to 0.001, from 0.21 with a sun 53
    degrees high to 0.91 shortly before sunset."""
    mu_s = np.array(list(COULSON_ZENITH))
    degree, _ = slab_sky().polarisation(0.0, 1.0, mu_s, mu_s)
    assert degree[:, 0] == pytest.approx(list(COULSON_ZENITH.values()), abs=1e-3)


def test_neutral_points_at_sunset_lie_where_they_are_seen() -> None:
    """With the sun on the horizon of clear air, beyond tables of slabs, Arago's point is 16 to 24
    degrees above the antisun, Babinet's 14 to 24 above the sun (Coulson 1988, chapter 5: 18 to 21
    and 15 to 21)."""
    air = replace(earth_spectral((450.0, 550.0)), rayleigh_depolarisation=0.0285)
    clear = replace(air, mie_scattering=(0.0,) * 2, mie_extinction=(0.0,) * 2)
    angle_deg = np.arange(2.0, 179.0, 0.5)
    mu, nu = np.sin(np.radians(angle_deg)), np.cos(np.radians(angle_deg))
    for q in solved(clear).stokes(0.0, mu, 0.0, nu)[..., 1].T:
        found = neutral_points(angle_deg, q, 0.0)
        assert 14.0 < found.babinet < 24.0
        assert 16.0 < found.arago < 24.0


def test_radiance_is_that_without_stokes() -> None:
    """I is `radiance` to the last bit, also where the field has few polarised orders, whose Q and U
    are solved at the first call and within 3 % of I those of the sky that has all."""
    few = solved(hazy_sky().atmosphere, polarised_orders=1)
    where = 2.0, np.array([0.1, 0.6]), 0.4, np.array([0.2, 0.5])
    for sky in (hazy_sky(), few):
        assert np.array_equal(sky.stokes(*where)[..., 0], sky.radiance(*where))
    whole = hazy_sky().stokes(*where)
    assert few.stokes(*where)[..., 1:] == pytest.approx(whole[..., 1:], abs=1e-3 * whole.max())


# Sun's zenith angle, elevation, azimuth from the sun (degrees), altitude (m), lane of 635, 570, 520
# and 445 nm, scalar over vector light - 1 and its standard error (percent): a Monte Carlo program
# with Mie's matrices of the same aerosol type, rho 0.0285.
_TRACED = {
    "molecules": [
        (80.0, 1.0, 180.0, 0.0, 3, -4.91, 0.05),
        (87.0, 80.0, 180.0, 0.0, 3, 5.82, 0.05),
        (93.0, 3.0, 180.0, 0.0, 3, -17.32, 0.64),
    ],
    "default": [
        (80.0, 3.0, 180.0, 0.0, 3, -3.95, 0.05),
        (87.0, 1.0, 180.0, 0.0, 3, -6.38, 0.10),
        (87.0, 90.0, 0.0, 0.0, 3, 4.81, 0.06),
        (30.0, 30.0, 180.0, 0.0, 2, 2.13, 0.02),
        (93.0, 6.0, 180.0, 0.0, 3, -8.94, 0.36),
        (60.0, 60.0, 180.0, 0.0, 0, 1.24, 0.02),
        (60.0, -89.0, 0.0, 110_000.0, 3, 1.67, 0.06),
        (80.0, -60.0, 180.0, 110_000.0, 3, 0.51, 0.05),
        (60.0, 40.0, 180.0, 5000.0, 3, 2.83, 0.03),
        (30.0, -20.0, 180.0, 5000.0, 3, -0.61, 0.02),
        (60.0, -9.5, 180.0, 110_000.0, 3, -1.76, 0.03),
    ],
}


@pytest.mark.parametrize("name", _TRACED)
def test_what_polarisation_changes_is_that_of_monte_carlo(name: str) -> None:
    """Scalar over vector light, from -17 to +6 %: within 0.12 % and two standard errors."""
    air = hazy_sky().atmosphere
    if name == "molecules":
        none = dict.fromkeys(
            (
                f"{kind}_{what}"
                for kind in ("mie", "aloft", "stratosphere")
                for what in ("scattering", "extinction")
            ),
            (0.0,) * 4,
        )
        air = replace(air, **none)
    vector, scalar = solved(air), scalar_sky(replace(air, rayleigh_depolarisation=0.0))
    for zenith_deg, up_deg, azimuth_deg, height_m, lane, share, noise in _TRACED[name]:
        mu, mu_s = np.sin(np.radians(up_deg)), np.cos(np.radians(zenith_deg))
        where = height_m, mu, mu_s, nu_of(mu, mu_s, np.radians(azimuth_deg))
        ours = 100.0 * (scalar.radiance(*where)[lane] / vector.radiance(*where)[lane] - 1.0)
        assert ours == pytest.approx(share, abs=0.12 + 2.0 * noise)


def test_no_polarised_orders_is_scalar_transfer() -> None:
    """Orders that carry no polarisation change no light; each one more comes nearer to all."""
    air = hazy_sky().atmosphere
    mu = np.repeat([0.05, 0.3, 0.9], 3)
    where = 0.0, mu, 0.2, nu_of(mu, np.full(9, 0.2), np.tile([0.0, 1.6, 3.1], 3))
    whole = hazy_sky().radiance(*where)
    error = [
        np.abs(solved(air, polarised_orders=n).radiance(*where) / whole - 1.0).max()
        for n in range(4)
    ]
    assert error[0] > 0.02
    assert np.all(np.diff(error) < 0.0)
    assert error[3] < 5e-3
