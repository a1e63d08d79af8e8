"""Spectra of a year's light from its colours: three spectra for the sky, three for the sun.

A clear sky's spectra are nearly sums of three; those are fitted to the sky's own at some heights of
the sun, by least squares over all cells, and tried at the heights between. A sky that has colours
alone is daylight of its colours, which is such a sum exactly.
"""

from typing import NamedTuple

import numpy as np

from daylight_numbers.opened_scene import OpenedScene
from daylight_numbers.sky_cells import cell_radiances, cell_weights
from daylight_numbers.spectra.daylight import daylight_of_primaries
from daylight_numbers.spectra.eye_responses import MELANOPIC, eye_responses
from daylight_numbers.spectra.reflectances import reflectances_of
from daylight_numbers.spectra.spectral_sky import WAVELENGTHS_NM, spectral_sky
from daylight_numbers.year.year_light import YearLight, middle_of
from vrut_lite.geometry.colour import luminance
from vrut_lite.numeric_types import FloatArray

# Hours at which skies are asked for their spectra: fitted and tried in turn.
_HOURS = 16
# Edge of the maps of their spectra.
_CUBE = 12
# Heights of the sun (sine) from which hours are fitted, and from which the fit is tried: 5 degrees.
_FITTED_SINE, _TRIED_SINE = 0.02, 0.087


class YearSpectra(NamedTuple):
    """Spectra (3, W) at `WAVELENGTHS_NM` of red, green and blue of 1: `sky` and `sun`; `albedo`
    (W,) of the ground disc.

    `error`: greatest error, as a share, of the melanopic EDI of open level ground by sky and by sun
    at the tried hours, whose sun is 5 degrees up or higher; 0 where the sky has colours alone.
    """

    sky: FloatArray
    sun: FloatArray
    albedo: FloatArray
    error: tuple[float, float]

    @property
    def is_own(self) -> bool:
        """Whether they are fitted to the sky's own."""
        return self.error != (0.0, 0.0)


def year_spectra(opened: OpenedScene, light: YearLight, offset_h: float) -> YearSpectra:
    """The spectra of a year whose light in colours is known; the scene's clock is moved.

    Raises:
        UserError: the sky has no light for an hour.
    """
    sine = light.sun_direction[:, 1]
    shines = (luminance(light.sun_irradiance_rgb) > 0.0) & (sine > _FITTED_SINE)
    by_height = np.flatnonzero(shines)[np.argsort(sine[shines], kind="stable")]
    places = np.linspace(0, len(by_height) - 1, min(_HOURS, len(by_height))).astype(int)
    fits, tried = _Fit(), []
    weights = cell_weights()
    for n, number in enumerate(by_height[places].tolist()):
        opened.go_to(middle_of(int(light.hour[number]), offset_h))
        hour = opened.hour()
        seen = spectral_sky(opened, hour, _CUBE)
        if not seen.is_own:
            continue
        sample = _Sample(
            cell_radiances(hour.sky), seen.cells, np.asarray(hour.key_irradiance_rgb), seen.sun
        )
        if n % 2 == 0:
            fits.add(sample, weights, seen.albedo)
        elif sine[number] > _TRIED_SINE:
            tried.append(sample)
    if not fits.count or not tried:
        return _of_colours(light)
    sky, sun = fits.sky(), fits.sun()
    errors = [sample.errors(sky, sun, weights) for sample in tried]
    of_sky, of_sun = np.max(np.abs(errors), axis=0).tolist()
    return YearSpectra(sky, sun, fits.albedo, (of_sky, of_sun))


def _of_colours(light: YearLight) -> YearSpectra:
    daylight = daylight_of_primaries(WAVELENGTHS_NM)
    albedo = reflectances_of([light.ground_albedo_rgb], WAVELENGTHS_NM)[0]
    return YearSpectra(daylight, daylight, albedo, (0.0, 0.0))


class _Sample(NamedTuple):
    """Colours and spectra of an hour: cells (CELLS, 3) and (CELLS, W), the sun (3,) and (W,)."""

    rgb: FloatArray
    spectra: FloatArray
    sun_rgb: FloatArray
    sun: FloatArray

    def errors(self, sky: FloatArray, sun: FloatArray, weights: FloatArray) -> tuple[float, float]:
        """Errors of melanopic light of sky and sun by three spectra each (3, W), as shares."""
        truth = np.array([weights @ self.spectra, self.sun])
        found = np.array([(weights @ self.rgb) @ sky, self.sun_rgb @ sun])
        ratio = melanopic(found) / np.maximum(melanopic(truth), 1e-12) - 1.0
        return float(ratio[0]), float(ratio[1])


class _Fit:
    """Sums of least squares over hours, each with the same weight."""

    def __init__(self) -> None:
        self.count = 0
        self.sky_square = np.zeros((3, 3))
        self.sky_sum = np.zeros((3, len(WAVELENGTHS_NM)))
        self.albedo = np.zeros(len(WAVELENGTHS_NM))
        self._suns: list[tuple[FloatArray, FloatArray]] = []

    def add(self, sample: _Sample, weights: FloatArray, albedo: FloatArray) -> None:
        """An hour's."""
        level = float(luminance(weights @ sample.rgb))
        weighted = sample.rgb * (weights / level**2)[:, None]
        self.sky_square += weighted.T @ sample.rgb
        self.sky_sum += weighted.T @ sample.spectra
        bright = float(luminance(sample.sun_rgb))
        self._suns.append((sample.sun_rgb / bright, sample.sun / bright))
        self.albedo, self.count = albedo, self.count + 1

    def sky(self) -> FloatArray:
        """Three spectra (3, W) of the sky."""
        return np.asarray(np.linalg.solve(self.sky_square, self.sky_sum), np.float64)

    def sun(self) -> FloatArray:
        """Three spectra (3, W) of the sun."""
        rgb, spectra = (np.array(part) for part in zip(*self._suns, strict=True))
        return np.asarray(np.linalg.lstsq(rgb, spectra, rcond=None)[0])


def melanopic(spectral: FloatArray) -> FloatArray:
    """Melanopic EDI (...,) in lx of spectra (..., W) at `WAVELENGTHS_NM`."""
    return np.asarray(eye_responses(spectral, WAVELENGTHS_NM).edi_lx[..., MELANOPIC])
