"""The named atmospheres, and what they are made from: molecules, ozone, dust."""

import math
from dataclasses import replace

import numpy as np
import pytest
from bruneton_sky import Atmosphere, precompute, single_scattering
from bruneton_sky.presets import PRESETS, earth_spectral, earth_standard, preset
from bruneton_sky.published.gpu_single_scattering import atmosphere_uniforms
from bruneton_sky.raised_ground import raise_ground

from vrut_lite.atmosphere.clear_air import COLUMN_M, molecule_density
from vrut_lite.atmosphere.gases import ozone_absorption, rayleigh_scattering
from vrut_lite.geometry.colour import solar_irradiance


def test_earth_at_three_wavelengths_is_the_demonstration() -> None:
    """The formulas give Bruneton's printed numbers; the solar spectrum is the host's, and his ozone
    is that 5 nm further."""
    ours, demo = earth_spectral((680.0, 550.0, 440.0)), Atmosphere.earth()
    assert ours.rayleigh_scattering == pytest.approx(demo.rayleigh_scattering, rel=1e-6)
    further = earth_spectral((685.0, 555.0, 445.0))
    assert further.absorption_extinction == pytest.approx(demo.absorption_extinction, rel=5e-5)
    for name in ("mie_scattering", "mie_extinction", "mie_g", "ground_albedo", "mu_s_min"):
        assert getattr(ours, name) == getattr(demo, name)
    assert ours.solar_irradiance == pytest.approx(solar_irradiance(ours.wavelength_nm), rel=0)


def test_rayleigh_agrees_with_penndorfs_table() -> None:
    """Penndorf 1957, table III: 30.60, 12.26 and 5.178 per 1000 km at 0 C, here for 15 C.

    Edlen's refractive indices of air at 15 C and 1013 hPa, depolarisation 0.035.
    """
    index = 1.0 + np.array([2.816e-4, 2.7782e-4, 2.7558e-4])
    ours = rayleigh_scattering((440, 550, 680), index, 2.54743e25, depolarisation=0.035)
    printed = np.array([30.60e-6, 12.26e-6, 5.178e-6]) * 273.15 / 288.15
    assert ours == pytest.approx(printed, rel=5e-3)


def test_rayleigh_agrees_with_an_independent_program() -> None:
    """colour-science's cross section (Bodhaine et al. 1999, with the Lorentz-Lorenz factor)."""
    phenomena = pytest.importorskip("colour.phenomena.rayleigh")
    wavelength = np.array([400.0, 550.0, 700.0])
    index = phenomena.air_refraction_index_Bodhaine1999(wavelength / 1000.0)
    king = phenomena.F_air_Bodhaine1999(wavelength / 1000.0)
    density = 2.54690e25
    theirs = phenomena.scattering_cross_section(wavelength * 1e-7) * 1e-4 * density
    assert rayleigh_scattering(wavelength, index, density) * king == pytest.approx(theirs, rel=1e-3)


def test_rayleigh_falls_with_density_and_the_fourth_power() -> None:
    """The printed formula at n - 1 = 3e-4, N = 2.5e25: 1.26e-5 at 550 nm, worked by hand."""
    by_hand = 8 * math.pi**3 * 0.00060009**2 / (3 * 2.5e25 * 550e-9**4)
    assert rayleigh_scattering(550.0, 1.0003, 2.5e25) == pytest.approx(by_hand, rel=1e-9)
    half, whole = rayleigh_scattering([550.0, 275.0], 1.0003, 2.5e25)
    assert whole / half == pytest.approx(16.0)
    # d = 0.035: (6 + 0.105) / (6 - 0.245).
    corrected = rayleigh_scattering(550.0, 1.0003, 2.5e25, depolarisation=0.035)
    assert corrected / by_hand == pytest.approx(6.105 / 5.755)


@pytest.mark.parametrize(
    ("name", "arguments"),
    [
        ("wavelength_nm", (0.0, 1.0003, 2.5e25)),
        ("refractive_index", (550.0, 0.9, 2.5e25)),
        ("molecules_per_m3", (550.0, 1.0003, 0.0)),
        ("depolarisation", (550.0, 1.0003, 2.5e25, 0.9)),
        ("wavelength_nm", (float("nan"), 1.0003, 2.5e25)),
    ],
)
def test_impossible_molecules_are_refused_by_name(name: str, arguments: tuple[float, ...]) -> None:
    """One sentence names the argument, before it becomes a wrong sky."""
    with pytest.raises(ValueError, match=name):
        rayleigh_scattering(*arguments)


def test_ozone_column_is_three_hundred_dobson_units() -> None:
    """At 605 nm, its peak, 300 DU absorb 300 x 2.687e20 x 5.019e-25 = 4.05 % vertically."""
    air = earth_spectral((400.0, 605.0, 800.0))
    altitude = np.linspace(10e3, 40e3, 3001)
    column = np.trapezoid(air.absorber(altitude), altitude)
    assert air.absorption_extinction[1] * column == pytest.approx(0.040457, rel=1e-3)
    assert ozone_absorption(605.0, 300.0, column) == pytest.approx(air.absorption_extinction[1])
    assert not any(earth_spectral((400.0, 600.0), ozone=False).absorption_extinction)


def test_earth_of_2008_has_its_published_numbers() -> None:
    """Bruneton and Neyret 2008: coefficients per metre, scale heights 8 and 1.2 km, no ozone."""
    air = preset("earth-2008")
    # Powers differ between processors by their last digit.
    assert air.rayleigh_scattering == pytest.approx((5.8e-6, 1.35e-5, 3.31e-5), rel=1e-14)
    assert air.mie_scattering == (4e-6,) * 3
    assert air.mie_extinction == pytest.approx((4e-6 / 0.9,) * 3)
    assert (air.rayleigh_scale_height_m, air.mie_scale_height_m, air.mie_g) == (8000, 1200, 0.8)
    assert not any(air.absorption_extinction)


def test_presets_have_the_haze_and_top_of_their_names() -> None:
    """Turbidity 6 is AOD(550) 0.50 by Preetham's formula; twilight reaches up to 120 km."""
    hazy = preset("earth-hazy")
    assert hazy.mie_extinction[1] * hazy.mie_scale_height_m == pytest.approx(0.50, abs=5e-3)
    assert preset("earth-twilight").top_altitude_m == 120_000.0


def test_sky_of_mars_is_rust_by_day() -> None:
    """Dust that absorbs blue makes more red than blue; the Earth's sky is the other way round."""
    view = 2.0, np.array([0.9, 0.5, 0.2]), 0.6, 0.2
    mars, earth = preset("mars-like"), preset("earth-clear")
    of_mars, of_earth = (
        single_scattering(air, *view) / air.solar_irradiance for air in (mars, earth)
    )
    assert (of_mars[:, 0] > of_mars[:, 1]).all()
    assert (of_mars[:, 1] > of_mars[:, 2]).all()
    assert (of_earth[:, 0] < of_earth[:, 2]).all()
    # Sunlight thins with the square of the distance, 1.5237 astronomical units.
    assert np.divide(mars.solar_irradiance, earth.solar_irradiance) == pytest.approx(
        0.4307, abs=1e-4
    )


@pytest.mark.parametrize("name", PRESETS)
def test_presets_differ_and_are_reproducible(name: str) -> None:
    """A name stands for one atmosphere, equal each time it is asked for, and for no other."""
    assert preset(name) == preset(name)
    assert [other for other in PRESETS if preset(other) == preset(name)] == [name]


def test_unknown_preset_is_refused_with_the_names() -> None:
    """The refusal lists the presets."""
    with pytest.raises(ValueError, match=r"venus.*mars-like"):
        preset("venus")


def test_the_modules_earth_has_the_standard_density() -> None:
    air, altitude_m = earth_standard(), np.linspace(0.0, 1e5, 11)
    assert air.molecules(altitude_m) == pytest.approx(molecule_density(altitude_m), rel=1e-12)
    assert air.column_m == pytest.approx(COLUMN_M, rel=1e-12)


def test_the_modules_earth_has_the_molecules_that_are_measured() -> None:
    """Bodhaine et al. 1999, table 3; the demonstration has 8 to 13 % more."""
    air = earth_standard((400.0, 550.0, 700.0))
    depth = np.array(air.rayleigh_scattering) * air.column_m
    assert depth == pytest.approx([0.36021, 0.09709, 0.03642], rel=2e-3)
    demonstration = earth_spectral(air.wavelength_nm)
    more = np.array(demonstration.rayleigh_scattering) * demonstration.column_m / depth
    assert more == pytest.approx([1.076, 1.117, 1.135], abs=0.005)


def test_the_published_method_refuses_air_that_it_cannot_hold() -> None:
    """On the CPU and on the GPU, in a sentence that says what to do."""
    for compute in (precompute, atmosphere_uniforms):
        with pytest.raises(ValueError, match=r"use bruneton_sky\.solve for the real Earth"):
            compute(earth_standard())


def test_weak_absorbers_have_their_published_columns() -> None:
    """Vertical depth of nitrogen dioxide at 440 nm (0.2 DU of 5.1e-23 m^2), and of oxygen's pairs
    at 577 nm: 11e-56 m^5 (Greenblatt et al. 1990) times the column of the squared density."""
    air = earth_standard(np.arange(400.0, 700.0, 0.5))
    nm = np.array(air.wavelength_nm)
    dioxide = np.interp(440.0, nm, air.gas_absorption) * air.column_m
    assert dioxide == pytest.approx(0.2 * 2.687e20 * 5.11e-23, rel=0.01)
    pairs = np.array(air.pair_absorption)
    oxygen_per_m3 = 0.20946 * 2.547e25
    assert np.interp(577.2, nm, pairs) == pytest.approx(11e-56 * oxygen_per_m3**2, rel=5e-3)
    # Few wavelengths stand for a band each: the means over it agree.
    few = earth_standard((570.0, 620.0))
    assert few.pair_absorption[0] == pytest.approx(
        np.average(pairs, weights=np.exp(-0.5 * ((nm - 570.0) / 21.2) ** 2)), rel=0.1
    )


@pytest.mark.parametrize("raised_m", [-400.0, 3000.0, 30_000.0])
def test_a_raised_ground_keeps_a_density_of_layers(raised_m: float) -> None:
    air, high = earth_standard(), raise_ground(earth_standard(), raised_m)
    at = np.array([0.0, 4000.0, 60_000.0])
    coefficient = np.array(high.rayleigh_scattering)[0] * high.molecules(at)
    np.testing.assert_allclose(
        coefficient, air.rayleigh_scattering[0] * air.molecules(at + raised_m), rtol=1e-9
    )


@pytest.mark.parametrize("above_m", [(-1.0,), (9000.0, 3000.0), (1000.0, 2000.0, 3000.0), (1e8,)])
def test_layers_of_molecules_that_do_not_rise_are_refused(above_m: tuple[float, ...]) -> None:
    with pytest.raises(ValueError, match=r"rayleigh_above_m of the atmosphere (must|needs)"):
        replace(
            earth_standard(),
            rayleigh_above_m=above_m,
            rayleigh_above_scale_height_m=(9000.0,) * min(len(above_m), 2),
        )
