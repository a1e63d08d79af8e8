"""Table, cube map, ground and ambient light: the fast sky against the exact one."""

from dataclasses import replace

import numpy as np
import pytest
from bruneton_sky import Atmosphere, single_scattering
from bruneton_sky.background import (
    albedo_rgb,
    ambient_coefficients,
    background_cube,
    surroundings,
)
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from vrut_lite.geometry.colour import rgb_from_spectrum
from vrut_lite.geometry.cube_map import texel_directions, texel_solid_angles
from vrut_lite.geometry.frames import direction_from_angles, world_from_enu
from vrut_lite.geometry.spherical_harmonics import evaluate_irradiance

HAZY = Atmosphere.earth().with_aerosol(0.2)


def world_sun(azimuth_deg: float, elevation_deg: float) -> NDArray[np.float64]:
    """World direction of a sun at an azimuth from north, clockwise."""
    return world_from_enu(direction_from_angles(np.radians(azimuth_deg), np.radians(elevation_deg)))


def exact_sky(
    air: Atmosphere, height_m: float, sun: NDArray[np.float64], size: int
) -> tuple[NDArray[np.bool_], NDArray[np.float64]]:
    """Which texels are sky, and their radiance by the exact twin."""
    direction = texel_directions(size)
    up = direction[..., 1] > 0
    nu = np.clip(direction[up] @ sun, -1.0, 1.0)
    mu = direction[up][:, 1]
    spectral = single_scattering(air, height_m, mu, sun[1], nu, samples=24)
    return up, rgb_from_spectrum(spectral, air.wavelength_nm, 3.0)


@pytest.mark.parametrize(
    ("elevation_deg", "height_m", "tolerance"),
    [(80.0, 0.0, 4e-3), (20.0, 2000.0, 4e-3), (2.0, 0.0, 6e-3), (-3.0, 0.0, 1e-2)],
)
def test_cube_agrees_with_direct_evaluation(
    elevation_deg: float, height_m: float, tolerance: float
) -> None:
    """99 % of the texels above a thousandth of the brightest lie within 1 %, as stated."""
    sun = world_sun(130.0, elevation_deg)
    up, exact = exact_sky(HAZY, height_m, sun, 32)
    ours = background_cube(surroundings(HAZY, height_m, sun), 32)[up]
    bright = exact > 1e-3 * exact.max()
    error = np.abs(ours[bright] / exact[bright] - 1.0)
    assert np.quantile(error, 0.99) < tolerance
    assert error.mean() < 0.3 * tolerance


@pytest.mark.parametrize("azimuth_deg", [0.0, 90.0, 180.0, 270.0])
def test_brightest_texel_is_toward_the_sun(azimuth_deg: float) -> None:
    """North is -Z and east +X: a sun in each quarter must light its own side."""
    sun = world_sun(azimuth_deg, 20.0)
    cube = background_cube(surroundings(HAZY, 0.0, sun), 32)
    brightest = texel_directions(32).reshape(-1, 3)[cube.sum(axis=-1).argmax()]
    assert brightest @ sun > np.cos(np.radians(8.0))


def test_a_clear_sky_is_blue_and_a_low_sun_red() -> None:
    """Channels are red, green, blue: away from the sun blue leads, at sunset red under the sun."""
    noon = background_cube(surroundings(Atmosphere.earth(), 0.0, world_sun(0.0, 60.0)), 16)
    zenith = noon[2, 8, 8]
    assert zenith[2] > 1.5 * zenith[1] > 1.5 * zenith[0]
    around = surroundings(HAZY, 0.0, world_sun(0.0, 1.0))
    assert around.sun_irradiance_rgb[0] > 3.0 * around.sun_irradiance_rgb[2]


def test_ground_reflects_sky_and_sun() -> None:
    """Every texel below the horizon is albedo / pi (E_sky + E_sun sin elevation)."""
    air = replace(HAZY, ground_albedo=(0.2, 0.3, 0.4))
    sun = world_sun(200.0, 35.0)
    around = surroundings(air, 0.0, sun)
    cube = background_cube(around, 64).astype(float)
    up = np.maximum(texel_directions(64)[..., 1], 0.0) * texel_solid_angles(64)
    irradiance = np.einsum("fij,fijc->c", up, cube) + around.sun_irradiance_rgb * sun[1]
    ground = cube[texel_directions(64)[..., 1] < 0]
    assert ground == pytest.approx(
        np.broadcast_to(np.array([0.2, 0.3, 0.4]) / np.pi * irradiance, ground.shape), rel=1e-5
    )


def test_picture_size_does_not_change_the_light() -> None:
    """Ground and ambient come from their own small cube."""
    around = surroundings(HAZY, 0.0, world_sun(10.0, 30.0))
    small, large = background_cube(around, 16), background_cube(around, 96)
    assert np.array_equal(small[3, 0, 0], large[3, 0, 0])


def test_ambient_light_is_the_sky_on_level_ground() -> None:
    """E(up) of the harmonics is the sky's irradiance within their 1.5 %; E(down) is pi L_ground."""
    around = surroundings(HAZY, 0.0, world_sun(10.0, 30.0))
    coefficients = ambient_coefficients(around)
    assert coefficients.shape == (25, 3)
    assert coefficients.dtype == np.float32
    sky = np.pi * around.ground_radiance_rgb / 0.1 - around.sun_irradiance_rgb * 0.5
    assert evaluate_irradiance(coefficients, (0.0, 1.0, 0.0)) == pytest.approx(sky, rel=0.015)
    down = evaluate_irradiance(coefficients, (0.0, -1.0, 0.0))
    assert down == pytest.approx(np.pi * around.ground_radiance_rgb, rel=0.05)


def test_many_wavelengths_become_colour() -> None:
    """With eight wavelengths the CIE integral makes the colours; it lies near the three's."""
    nm = np.linspace(380.0, 730.0, 15)
    three = replace(
        Atmosphere.earth(ozone=False), mie_scattering=(0.0,) * 3, mie_extinction=(0.0,) * 3
    )
    many = replace(
        three,
        wavelength_nm=tuple(nm),
        solar_irradiance=tuple(np.interp(nm, [440.0, 550.0, 680.0], [1.91198, 1.8504, 1.474])),
        rayleigh_scattering=tuple(1.355776e-5 * (550.0 / nm) ** 4),
        mie_scattering=(0.0,) * 15,
        mie_extinction=(0.0,) * 15,
        absorption_extinction=(0.0,) * 15,
        ground_albedo=(0.3,) * 15,
    )
    assert albedo_rgb(many) == pytest.approx(0.3)
    sun = world_sun(0.0, 40.0)
    cubes = [background_cube(surroundings(air, 0.0, sun), 16) for air in (three, many)]
    # 12 %: the three samples take the sun's own spectrum between them, `many` straight lines.
    assert cubes[1][2] == pytest.approx(cubes[0][2], rel=0.12)


@settings(deadline=None, max_examples=40)
@given(
    azimuth=st.floats(0.0, 360.0),
    elevation=st.floats(-90.0, 90.0) | st.sampled_from([-90.0, -0.1, 0.0, 90.0]),
    height_m=st.floats(0.0, 60_000.0) | st.sampled_from([0.0, 60_000.0]),
    g=st.sampled_from([0.0, 0.8, 0.95]),
)
def test_every_sun_gives_a_finite_sky(
    azimuth: float, elevation: float, height_m: float, g: float
) -> None:
    """From nadir to zenith, ground to top: no NaN and no negative radiance, odd sizes too."""
    air = HAZY.with_aerosol(0.2, mie_g=g)
    cube = background_cube(surroundings(air, height_m, world_sun(azimuth, elevation)), 7)
    assert np.isfinite(cube).all()
    assert (cube >= 0).all()
