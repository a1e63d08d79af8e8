"""The atmosphere: Bruneton's numbers, haze, and what is refused."""

import math
from dataclasses import replace

import numpy as np
import pytest
from bruneton_sky import Atmosphere, earth_spectral, single_scattering
from bruneton_sky.atmosphere_numbers import SPECTRAL_FIELDS
from bruneton_sky.raised_ground import raise_ground
from bruneton_sky.solver.particles import kinds_of, shares_at

from vrut_lite.atmosphere.aerosol import optical_depth_of_turbidity
from vrut_lite.atmosphere.aerosols import type_optics
from vrut_lite.atmosphere.aerosols.droplets import droplets_phase


def test_earth_is_brunetons_demonstration_atmosphere() -> None:
    """Names and numbers that others script against, from Bruneton's 2017 demo."""
    earth = Atmosphere.earth()
    assert earth.rayleigh_scattering == (5.80234e-6, 1.355776e-5, 3.310001e-5)
    assert earth.absorption_extinction == (6.497e-7, 1.8809e-6, 8.502e-8)
    assert earth.mu_s_min == pytest.approx(math.cos(math.radians(102)))
    assert Atmosphere.earth(ozone=False).absorption_extinction == (0.0, 0.0, 0.0)
    # Its aerosol optical depth, extinction times scale height.
    assert earth.mie_extinction[1] * earth.mie_scale_height_m == pytest.approx(0.005328)


def test_ozone_is_a_tent() -> None:
    """The absorber is 1 at 25 km and falls linearly to 0 at 10 and 40 km, and stays there."""
    heights = [0.0, 10e3, 17.5e3, 25e3, 32.5e3, 40e3, 60e3]
    assert Atmosphere.earth().absorber(heights) == pytest.approx([0, 0, 0.5, 1, 0.5, 0, 0])


def test_one_number_serves_every_wavelength(other_planet: Atmosphere) -> None:
    """A single value is repeated per wavelength; equal atmospheres are equal cache keys."""
    grey = replace(other_planet, ground_albedo=0.5)  # type: ignore[arg-type]
    assert grey.ground_albedo == (0.5,) * 4
    assert hash(grey) == hash(replace(other_planet, ground_albedo=(0.5,) * 4))


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("ground_radius_m", 0.0),
        ("rayleigh_scale_height_m", -1.0),
        ("mie_g", 1.0),
        ("ground_albedo", (0.1, 0.1, 1.1)),
        ("mie_scattering", (1.0, 0.0, 0.0)),
        ("solar_irradiance", (1.0, float("nan"), 1.0)),
        ("rayleigh_scattering", (1e-6, 1e-6)),
        ("absorber_altitude_m", (10e3, 10e3, 40e3)),
        ("absorber_density", (0.0, 1.0)),
        ("absorber_density", (0.0, -1.0, 0.0)),
        ("wavelength_nm", (680.0, 440.0, 550.0)),
        ("wavelength_nm", (550.0, 550.0, 440.0)),
        ("wavelength_nm", (-1.0, -2.0, -3.0)),
        ("wavelength_nm", ()),
        ("ground_albedo", ()),
        ("ground_albedo", -0.1),
        ("ground_radius_m", (6.36e6, 6.37e6)),
        ("ground_radius_m", 1e300),
        ("top_altitude_m", 1e-300),
        ("rayleigh_scale_height_m", 1e13),
        ("absorber_altitude_m", 0.0),
        ("top_altitude_m", float("inf")),
        ("mie_extinction", (1e-6, 1e-6, float("nan"))),
        ("mie_scale_height_m", "thin"),
        ("sun_angular_radius_rad", None),
        ("mu_s_min", 1.0),
        ("mu_s_min", -1.5),
        ("mie_g", (0.8, 0.8, 0.8)),
        ("mie_phase", "mie"),
        ("mie_phase", 0.8),
    ],
)
def test_impossible_air_is_refused_by_name(name: str, value: object) -> None:
    """A wrong value is named at once, in one sentence, before it becomes a wrong sky."""
    with pytest.raises(ValueError, match=name):
        replace(Atmosphere.earth(), **{name: value})  # type: ignore[arg-type]


def test_turbidity_maps_to_aerosol_optical_depth() -> None:
    """Preetham's turbidity 3 is AOD(550) 0.20, Bruneton's 0.0053 is turbidity 1.05."""
    assert optical_depth_of_turbidity(3.0) == pytest.approx(0.2009, abs=1e-4)
    assert optical_depth_of_turbidity(1.05) == pytest.approx(0.0055, abs=2e-4)
    assert optical_depth_of_turbidity(0.5) == 0.0


def test_turbidity_residual_is_the_stated_one() -> None:
    """The formula misses the definition tau_R (T - 1) by 7 to 8 %, as `aerosol` documents.

    Below turbidity 2 it is the absolute difference that stays small: 0.009.
    """
    molecules = 1.355776e-5 * 8000.0
    turbidity = np.linspace(2.0, 10.0, 81)
    residual = optical_depth_of_turbidity(turbidity) / (molecules * (turbidity - 1.0)) - 1.0
    assert residual.max() < -0.065
    assert residual.min() > -0.08
    thin = np.linspace(1.0, 2.0, 101)
    difference = optical_depth_of_turbidity(thin) - molecules * (thin - 1.0)
    assert np.abs(difference).max() < 0.009


def test_haze_follows_angstroms_law(other_planet: Atmosphere) -> None:
    """Optical depth is as asked at 550 nm, falls as wavelength^-1.3, and keeps its albedo."""
    hazy = other_planet.with_aerosol(0.3)
    depth = np.array(hazy.mie_extinction) * hazy.mie_scale_height_m
    assert depth == pytest.approx(0.3 * (np.array(hazy.wavelength_nm) / 550.0) ** -1.3)
    ratio = np.array(hazy.mie_scattering) / hazy.mie_extinction
    assert ratio == pytest.approx(
        np.array(other_planet.mie_scattering) / other_planet.mie_extinction
    )


def test_sun_of_another_order_of_wavelengths_is_the_same(other_planet: Atmosphere) -> None:
    """Wavelengths may rise or fall: each keeps its own coefficients."""
    turned = {
        name: tuple(reversed(getattr(other_planet, name)))
        for name in ("wavelength_nm", *SPECTRAL_FIELDS)
    }
    rising = replace(other_planet, **turned)  # type: ignore[arg-type]
    where = 1000.0, 0.4, 0.3, 0.1
    falling = single_scattering(other_planet, *where)
    assert single_scattering(rising, *where)[::-1] == pytest.approx(falling, rel=1e-12)


def test_a_types_air_lies_in_two_layers() -> None:
    """The depth is the type's; at 12 km most of it is the free troposphere's, and a plateau
    cuts the lower layer away first."""
    optics = type_optics("continental-average")
    air = earth_spectral((550.0,)).with_optics(optics)
    assert air.aerosol_depth()[0] == pytest.approx(0.146, abs=1e-3)
    low, aloft = air.particles()
    high = [kind.extinction[0] * np.exp(-12_000.0 / kind.scale_height_m) for kind in (low, aloft)]
    assert high[1] > 3.0 * high[0]
    above = raise_ground(air, 3000.0)
    one = air.in_one_layer(1000.0)
    depths = [
        sum(
            kind.extinction[0] * -kind.scale_height_m * np.expm1(-60_000.0 / kind.scale_height_m)
            for kind in a.scatterers()[1:]
        )
        for a in (air, one)
    ]
    assert len(one.scatterers()) == 2
    assert depths[1] == pytest.approx(depths[0])
    shares = [a.aloft_extinction[0] / a.mie_extinction[0] for a in (air, above)]
    assert shares[1] > 2.0 * shares[0]


def test_droplets_scatter_where_fog_is() -> None:
    """Their share of what particles scatter is all in thick fog, none far above it."""
    foggy = (
        earth_spectral((550.0,)).with_aerosol(0.1).with_fog(200.0, 50.0, droplets_phase((550.0,)))
    )
    shares = shares_at(foggy, 16, [0.0, 100.0, 3000.0])
    assert shares[:, kinds_of(foggy).index("fog"), 0] == pytest.approx([1.0, 0.97, 0.0], abs=0.03)
    assert kinds_of(foggy.with_fog(200.0, 50.0)) == ("aerosol",)
