"""Spectra of an hour's light: those of the sky itself, or daylight of its colours.

A sky's spectra come in a small cube map; their shape over their luminance is smooth, so that it is
interpolated and multiplied by the luminance of the sky's fine map. Clouds, glows and skies that
have colours alone are daylight of their colours (`spectra/daylight.py`).
"""

from typing import NamedTuple

import numpy as np
from light_transport.public import Illumination

from daylight_numbers.opened_scene import OpenedScene
from daylight_numbers.sky_cells import cell_directions, cell_radiances, node_means
from daylight_numbers.spectra.daylight import daylight_of_primaries, daylight_of_rgb
from daylight_numbers.spectra.reflectances import reflectances_of
from vrut_lite.geometry.colour import luminance
from vrut_lite.geometry.cube_map import sample_cube, texel_directions
from vrut_lite.messages.sky import SkySpectraSeen
from vrut_lite.numeric_types import Float32Array, FloatArray

# 41 wavelengths.
WAVELENGTHS_NM = tuple(np.arange(380.0, 781.0, 10.0).tolist())
# Edge of the cube map of spectra.
CUBE = 24
_LEAST = 1e-12


class SpectralSky(NamedTuple):
    """Light at `WAVELENGTHS_NM` (W), per nm.

    `cells` (CELLS, W): radiance of the sky's cells; `ground` (W,): radiance of open ground;
    `albedo` (W,): of the ground disc; `sun` (W,): irradiance of the key light; `towards` (3,): unit
    vector to it; `is_own`: whether these are the sky's own spectra.
    """

    cells: FloatArray
    ground: FloatArray
    albedo: FloatArray
    sun: FloatArray
    towards: FloatArray
    is_own: bool

    @property
    def nodes(self) -> FloatArray:
        """Radiance (GROUND_NODE + 1, W) of the ray table's cells and, last, of open ground."""
        return np.vstack([node_means(self.cells), self.ground])


def spectral_sky(opened: OpenedScene, hour: Illumination, size: int = CUBE) -> SpectralSky:
    """The spectra of the present hour, whose light in colours is `hour`, by a map of an edge."""
    seen, clear = opened.spectra(WAVELENGTHS_NM, size), opened.clear_hour()
    towards = np.asarray(hour.key_direction, float)
    sky_rgb = cell_radiances(hour.sky)
    if seen.cube is None:
        parts = (sky_rgb, hour.ground_radiance_rgb, hour.key_irradiance_rgb)
        cells, ground, sun = (daylight_of_rgb(rgb, WAVELENGTHS_NM) for rgb in parts)
        albedo = reflectances_of([hour.ground_albedo_rgb], WAVELENGTHS_NM)[0]
        return SpectralSky(cells, ground, albedo, sun, towards, False)
    clear_rgb = cell_radiances(clear.sky)
    cells = _shape(seen, clear.sky) * luminance(clear_rgb)[:, None]
    return SpectralSky(
        _layered(cells, clear_rgb, sky_rgb),
        _layered(
            np.asarray(seen.ground_radiance), clear.ground_radiance_rgb, hour.ground_radiance_rgb
        ),
        np.asarray(seen.ground_albedo),
        _layered(
            np.asarray(seen.sun_irradiance), clear.key_irradiance_rgb, hour.key_irradiance_rgb
        ),
        towards,
        True,
    )


def _shape(seen: SkySpectraSeen, clear: Float32Array) -> FloatArray:
    """Spectra (CELLS, W) over the luminance that the fine map (6, n, n, 3) has there."""
    assert seen.cube is not None
    cube = seen.cube.values.astype(float)
    above = texel_directions(len(cube[0])).copy()
    above[..., 1] = np.abs(above[..., 1])
    shape = cube / np.maximum(luminance(sample_cube(clear, above)), _LEAST)[..., None]
    # The lower half mirrors the upper one, so that texels at the horizon have neighbours.
    half = len(cube[0]) // 2
    shape[3] = shape[2, ::-1]
    for side in (0, 1, 4, 5):
        shape[side, half:] = shape[side, :half][::-1]
    return np.asarray(sample_cube(shape, cell_directions()).mean(axis=1))


def _layered(spectra: FloatArray, clear_rgb: object, rgb: object) -> FloatArray:
    """Spectra (..., W) of light whose colours (..., 3) layers change from `clear_rgb` to `rgb`.

    Spectra are dimmed with the luminance; the difference of colours that is left is added as
    daylight.
    """
    before, after = np.asarray(clear_rgb, float), np.asarray(rgb, float)
    left = luminance(after) / np.maximum(luminance(before), _LEAST)
    more = (after - left[..., None] * before) @ daylight_of_primaries(WAVELENGTHS_NM)
    return np.maximum(spectra * left[..., None] + more, 0.0)
