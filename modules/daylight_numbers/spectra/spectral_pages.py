"""The report's part on spectral light: columns, a table, plans and sentences on the method."""

from pathlib import Path
from typing import NamedTuple

import numpy as np
from light_transport.public import CancelCheck, always

from daylight_numbers.matrix.sensors import Sensors
from daylight_numbers.opened_scene import OpenedScene
from daylight_numbers.pictures import PictureQuantity, plan_picture
from daylight_numbers.report import Table
from daylight_numbers.spectra.spectra_file import MaterialSpectra
from daylight_numbers.spectra.spectral_hour import SpectralHour, spectral_hour
from daylight_numbers.spectra.spectral_sky import WAVELENGTHS_NM, SpectralSky
from daylight_numbers.spectra.spectral_surfaces import SpectralSurfaces, spectral_surfaces
from daylight_numbers.spectra.spectral_year import melanopic_columns, spectral_year
from daylight_numbers.spectra.year_spectra import year_spectra
from daylight_numbers.work import DaylightWork
from daylight_numbers.year_pages import YearPages
from vrut_lite.headless import write_png
from vrut_lite.numeric_types import FloatArray
from vrut_lite.quantities import percent_text

_PICTURES = {
    "melanopic_edi_lx": PictureQuantity("melanopic EDI", "lx"),
    "cct_k": PictureQuantity("correlated colour temperature", "K"),
}


_OF_YEAR = PictureQuantity("time above 250 lx of melanopic EDI, 8:00 to 18:00", "%", from_zero=True)


class SpectralPages(NamedTuple):
    """Columns (P,) of sensors, arrays for `sensors.npz` alone, and parts of a page."""

    columns: dict[str, FloatArray]
    arrays: dict[str, FloatArray]
    tables: list[Table]
    pictures: dict[Path, str]
    method: list[str]


def spectral_pages(
    folder: Path,
    opened: OpenedScene,
    work: DaylightWork,
    sky: SpectralSky,
    measured: MaterialSpectra,
    tolerance: float,
    go_on: CancelCheck = always,
) -> tuple[SpectralPages, SpectralSurfaces]:
    """The spectral light of an hour, whose light is `sky`; pictures are written into a folder.

    Raises:
        UserError: no material has a measured name, or a picture cannot be written.
        GivenUp: by `go_on`.
    """
    surfaces = spectral_surfaces(opened.scene, work.transport, work.glass, measured)
    found = spectral_hour(work, sky, surfaces, tolerance, go_on)
    columns = found.columns()
    pictures: dict[Path, str] = {}
    for name, quantity in _PICTURES.items():
        if np.any(work.sensors.cell >= 0) and np.any(columns[name] > 0.0):
            path = folder / f"{name}.png"
            write_png(path, plan_picture(work.sensors, columns[name], quantity))
            pictures[path] = f"{_capital(quantity.title)} ({quantity.unit}), north (-z) up"
    pages = SpectralPages(
        columns,
        _arrays(found),
        [_table(work.sensors, columns)],
        pictures,
        _method(opened, sky, surfaces, measured),
    )
    return pages, surfaces


def spectral_year_pages(
    folder: Path,
    opened: OpenedScene,
    work: DaylightWork,
    surfaces: SpectralSurfaces,
    of_year: YearPages,
    tolerance: float,
    go_on: CancelCheck = always,
) -> SpectralPages:
    """The melanopic light of a year that is known in colours; moves the scene's clock.

    Raises:
        UserError: the sky has no light for an hour, or a picture cannot be written.
        GivenUp: by `go_on`.
    """
    light = of_year.light
    spectra = year_spectra(opened, light, opened.standard_offset_h)
    found = spectral_year(
        work, light, spectra, surfaces, of_year.solved, of_year.year, tolerance, go_on
    )
    columns = melanopic_columns(found, light)
    pictures: dict[Path, str] = {}
    shown = columns["melanopic_250_percent"]
    if np.any(work.sensors.cell >= 0) and np.any(shown > 0.0):
        path = folder / "melanopic_250_percent.png"
        write_png(path, plan_picture(work.sensors, shown, _OF_YEAR))
        pictures[path] = f"{_capital(_OF_YEAR.title)} ({_OF_YEAR.unit})"
    said = (
        "daylight of the sky's colours"
        if not spectra.is_own
        else "sums of three fitted to the sky's own at eight hours, three for the sun; on open "
        "level ground, tried at hours between with the sun above 5°, melanopic EDI by sky errs by "
        f"{percent_text(spectra.error[0], 1)} at most, by sun {percent_text(spectra.error[1], 1)}"
    )
    method = [f"Spectra of a year: {said}. Its melanopic EDI is without blinds."]
    return SpectralPages(columns, {}, [_year_table(work.sensors, columns)], pictures, method)


def _year_table(sensors: Sensors, columns: dict[str, FloatArray]) -> Table:
    rows = []
    for plane, name in enumerate(sensors.names):
        here = sensors.plane == plane
        hours = columns["melanopic_250_percent"][here]
        error = columns["melanopic_250_error_percent"][here]
        rows.append(
            [
                name,
                f"{hours.mean():.1f} ± {np.sqrt(np.mean(error**2)):.1f}",
                f"{hours.min():.1f}",
                f"{hours.max():.1f}",
                f"{columns['melanopic_250_days_percent'][here].mean():.1f}",
                f"{columns['melanopic_136_days_percent'][here].mean():.1f}",
            ]
        )
    names = [
        "plane", "hours with 250 lx %, mean", "least", "most",
        "days with 250 lx in 4 h by noon %", "with 136 lx %",
    ]  # fmt: skip
    return Table("Melanopic EDI of the year, 8:00 to 18:00", names, rows)


def _arrays(found: SpectralHour) -> dict[str, FloatArray]:
    return {
        "wavelength_nm": np.array(WAVELENGTHS_NM),
        "spectral_irradiance": found.irradiance,
        "spectral_irradiance_error": found.noise,
    }


def _table(sensors: Sensors, columns: dict[str, FloatArray]) -> Table:
    rows = []
    for plane, name in enumerate(sensors.names):
        here = sensors.plane == plane
        edi, error = columns["melanopic_edi_lx"][here], columns["melanopic_edi_error_lx"][here]
        kelvin, duv = columns["cct_k"][here], columns["duv"][here]
        has_colour = np.isfinite(kelvin)
        rows.append(
            [
                name,
                f"{edi.mean():,.0f} ± {np.sqrt(np.mean(error**2)):,.0f}",
                f"{edi.min():,.0f}",
                f"{edi.max():,.0f}",
                f"{edi.mean() / max(columns['spectral_illuminance_lx'][here].mean(), 1e-12):.3f}",
                f"{np.median(kelvin[has_colour]):,.0f}" if has_colour.any() else "none",
                f"{np.median(duv[has_colour]):+.4f}" if has_colour.any() else "none",
            ]
        )
    names = ["plane", "mean melanopic EDI lx", "least lx", "most lx", "melanopic ratio",
             "median CCT K", "median Duv"]  # fmt: skip
    return Table("Spectral light of the hour", names, rows)


def _method(
    opened: OpenedScene, sky: SpectralSky, surfaces: SpectralSurfaces, measured: MaterialSpectra
) -> list[str]:
    count = len(WAVELENGTHS_NM)
    source = (
        "of the sky's own spectra"
        if sky.is_own
        else "of daylight by CIE's three components, for the sky has colours alone"
    )
    layers = f"; {', '.join(opened.light.layers)} by their colours" if opened.light.layers else ""
    named = f"; {', '.join(sorted(measured.shares))} by {measured.file}" if measured.shares else ""
    return [
        f"Spectral light: {count} wavelengths from {WAVELENGTHS_NM[0]:g} to "
        f"{WAVELENGTHS_NM[-1]:g} nm {source}{layers}.",
        "Colours of surfaces become smooth reflectances (Jakob and Hanika 2019) under D65, "
        f"emission daylight of its colour{named}.",
        "Alpha-opic EDI by CIE S 026:2018, colour temperature and Duv as Ohno 2013.",
        *(
            ["Coloured glass is looked through at each wavelength; first light on surfaces has the "
             "tint of its mean over their rays."]
            if surfaces.glass_is_own
            else []
        ),
    ]  # fmt: skip


def _capital(title: str) -> str:
    """The title with a capital in front, and those of its abbreviations."""
    return title[:1].upper() + title[1:]
