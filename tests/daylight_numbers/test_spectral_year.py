"""Melanopic light of a year: hours have the light of single hours, and shares are counts."""

from dataclasses import replace

import numpy as np
import pytest
from boxes import box, floor, hour, quads
from daylight_numbers.glazing.glass import no_glass
from daylight_numbers.matrix.operator import operator_of
from daylight_numbers.matrix.sensors import free_sensors
from daylight_numbers.sky_cells import cell_radiances
from daylight_numbers.spectra.daylight import daylight_of_primaries, daylight_of_rgb
from daylight_numbers.spectra.reflectances import reflectances_of
from daylight_numbers.spectra.spectral_hour import spectral_hour
from daylight_numbers.spectra.spectral_sky import WAVELENGTHS_NM, SpectralSky
from daylight_numbers.spectra.spectral_surfaces import SpectralSurfaces
from daylight_numbers.spectra.spectral_year import SpectralYear, melanopic_columns, spectral_year
from daylight_numbers.spectra.year_spectra import YearSpectra, melanopic
from daylight_numbers.work import DaylightWork
from daylight_numbers.year.year import solved_year, year_matrices, year_of
from daylight_numbers.year.year_light import DAYS, HOURS, YearLight
from light_transport.transport import SceneTransport
from light_years import year_like

from vrut_lite.geometry.cube_map import texel_directions

NM = np.array(WAVELENGTHS_NM)
BLUE_SKY, WARM_SUN = np.array([0.5, 0.8, 1.4]), np.array([5.0, 4.5, 3.6])


def work_of(glass_rgb=None):
    """A floor with a box and a wall of a colour; with glass between them and the sky."""
    panes = [] if glass_rgb is None else [floor(-3, 3, -3, 3, y=2.5)]
    surfaces, layout = quads(
        floor(-3, 3, -3, 3), *box((-1, 0, -1), (0, 1.5, 0)), *panes, reflectance=[0.6, 0.4, 0.2]
    )
    glass, which = no_glass(len(surfaces.part)), np.full(len(surfaces.part), -1)
    if glass_rgb is not None:
        surfaces.opacity[-2:], surfaces.reflectance_rgb[-2:] = 0.5, 0.0
        glass.tint[-2:], glass.ior[-2:], glass.panes[-2:], which[-2:] = glass_rgb, 1.0001, 0, 0
    transport = SceneTransport(surfaces, layout)
    transport.add_rays(128)
    sensors = free_sensors([[1.0, 0.5, 0.0], [-2.0, 0.5, 1.0]], [[0, 1.0, 0], [1.0, 0, 0]], "yard")
    work = DaylightWork(transport, glass, sensors, operator_of(transport, glass, sensors, 0.02))
    patches = transport.patches
    tints = np.zeros((0, len(NM))) if glass_rgb is None else reflectances_of([glass_rgb], NM)
    own = SpectralSurfaces(
        reflectances_of(patches.reflectance_rgb.astype(float), NM),
        daylight_of_rgb(patches.emitted_rgb, NM), tints, which, glass_rgb is not None,
    )  # fmt: skip
    return work, own


def coloured_hour(key, sun):
    """A blue sky, brighter to the zenith, over green ground, and a warm sun."""
    sine = np.maximum(texel_directions(16)[..., 1:2], 0.0)
    cube = ((0.5 + sine) * BLUE_SKY).astype(np.float32)
    light = hour(cube=cube, key=key, irradiance=1.0)
    return replace(
        light,
        ground_radiance_rgb=(0.1, 0.2, 0.1),
        key_irradiance_rgb=tuple(sun * WARM_SUN),
        ground_albedo_rgb=(0.2, 0.2, 0.2),
    )


@pytest.mark.parametrize("glass_rgb", [None, (0.3, 0.5, 0.8)], ids=["open", "coloured glass"])
def test_hours_of_a_year_have_the_melanopic_light_of_single_hours(glass_rgb):
    """The year's six spectra, solved at every other wavelength, are here those of the hours."""
    work, own = work_of(glass_rgb)
    lights = [coloured_hour((1.0, 1.0, 0.3), 1.0), coloured_hour((-0.4, 0.5, 0.2), 0.3)]
    light = year_like([12, 37], lights)
    solved = solved_year(work.transport, light)
    year = year_of(year_matrices(work, light, solved), light)
    daylight, albedo = daylight_of_primaries(NM), np.full(len(NM), 0.2)
    spectra = YearSpectra(daylight, daylight, albedo, (0.0, 0.0))
    found = spectral_year(work, light, spectra, own, solved, year, 0.2)
    for n, of_hour in enumerate(lights):
        sky = SpectralSky(
            daylight_of_rgb(cell_radiances(of_hour.sky), NM),
            daylight_of_rgb(of_hour.ground_radiance_rgb, NM), albedo,
            daylight_of_rgb(of_hour.key_irradiance_rgb, NM),
            np.array(of_hour.key_direction), True,
        )  # fmt: skip
        single = melanopic(spectral_hour(work, sky, own, 0.2).irradiance)
        np.testing.assert_allclose(found.total[:, n], single, rtol=0.01)


def test_shares_of_a_year_count_its_hours_and_days():
    """A sensor with 250 lx from 11 to 15 every other day, another with 140 lx each morning."""
    hours = np.arange(DAYS * HOURS)
    day, clock = np.divmod(hours, HOURS)
    edi = np.zeros((2, len(hours)), np.float32)
    edi[0] = 260.0 * ((day % 2 == 0) & (clock >= 11) & (clock < 15))
    edi[1] = 140.0 * ((clock >= 7) & (clock < 11))
    nothing = np.zeros((len(hours), 3))
    light = YearLight(hours, nothing, nothing, nothing, np.zeros(3), "test")
    columns = melanopic_columns(SpectralYear(edi, (edi, edi)), light)
    np.testing.assert_allclose(columns["melanopic_250_percent"], [40.0 * 183 / 365, 0.0])
    np.testing.assert_allclose(columns["melanopic_250_days_percent"], [100.0 * 183 / 365, 0.0])
    np.testing.assert_allclose(columns["melanopic_136_days_percent"], [100.0 * 183 / 365, 100.0])
    late = edi.copy()
    late[:, clock == 12] = 0.0
    columns = melanopic_columns(SpectralYear(late, (edi, late)), light)
    assert columns["melanopic_250_days_percent"][0] == 0.0
    np.testing.assert_allclose(columns["melanopic_250_error_percent"][0], 5.0 * 183 / 365)
