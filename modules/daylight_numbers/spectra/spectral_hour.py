"""An hour's light by wavelength at sensors: 41 hours of one colour each, computed three by three.

Rays of sensors serve all wavelengths; bounces between patches are solved for each. Coloured glass:
`tinted_light.py`.
"""

from typing import NamedTuple

import numpy as np
from light_transport.public import CancelCheck, always

from daylight_numbers.now import sun_shares
from daylight_numbers.spectra.colour_temperature import colour_temperature
from daylight_numbers.spectra.eye_responses import MELANOPIC, RECEPTORS, eye_responses
from daylight_numbers.spectra.spectral_sky import WAVELENGTHS_NM, SpectralSky
from daylight_numbers.spectra.spectral_surfaces import SpectralSurfaces, bands
from daylight_numbers.spectra.tinted_light import through_glass
from daylight_numbers.work import DaylightWork
from daylight_numbers.year.year import sent_by_cells
from vrut_lite.numeric_types import FloatArray


class SpectralHour(NamedTuple):
    """Spectral irradiance (P, W) at `WAVELENGTHS_NM`, W m^-2 nm^-1, and its standard error by
    rays (P, W)."""

    irradiance: FloatArray
    noise: FloatArray

    def columns(self) -> dict[str, FloatArray]:
        """Columns (P,) by names with units: EDI with its error, colour temperature and Duv.

        The melanopic ratio is EDI over illuminance (CIE S 026, melanopic DER).
        """
        found = eye_responses(self.irradiance, WAVELENGTHS_NM)
        error = eye_responses(self.noise, WAVELENGTHS_NM)
        colour = colour_temperature(found.xyz)
        edi, lux = found.edi_lx, found.illuminance_lx
        columns = {
            "melanopic_edi_lx": edi[:, MELANOPIC],
            "melanopic_edi_error_lx": error.edi_lx[:, MELANOPIC],
        }
        for n, name in enumerate(RECEPTORS):
            if n != MELANOPIC:
                columns[f"{name}_edi_lx"] = edi[:, n]
        with np.errstate(divide="ignore", invalid="ignore"):
            columns["melanopic_ratio"] = edi[:, MELANOPIC] / lux
        columns["spectral_illuminance_lx"] = lux
        return {**columns, "cct_k": colour.cct_k, "duv": colour.duv}


def spectral_hour(
    work: DaylightWork,
    sky: SpectralSky,
    surfaces: SpectralSurfaces,
    tolerance: float,
    go_on: CancelCheck = always,
) -> SpectralHour:
    """The light of an hour at the sensors of a scene without measured panes.

    Args:
        work: of the scene.
        sky: spectra of the hour's light.
        surfaces: spectra of the scene's surfaces and glass.
        tolerance: as of the work; it rules the rays through coloured glass.
        go_on: called between steps.

    Raises:
        GivenUp: by `go_on`.
    """
    transport = work.transport
    assert transport.patches is not None
    direct = sent_by_cells(transport) @ sky.nodes
    if np.any(sky.sun > 0.0) and sky.towards[1] > 0.0:
        direct += transport.sunlit_patches(sky.towards)[:, None] * sky.sun
    reflectance = surfaces.reflectance.copy()
    reflectance[transport.patches.on_ground] = sky.albedo
    radiances = np.vstack([sky.cells, sky.ground])
    shape = len(work.sensors), len(WAVELENGTHS_NM)
    irradiance, noise = np.zeros((2, *shape))
    for at in through_glass(work, surfaces, tolerance, bands(np.arange(len(WAVELENGTHS_NM)))):
        go_on()
        k, own = at.bands.columns, at.bands.own
        light, emitted, sent_back = (
            part[:, k].astype(np.float32) for part in (direct, surfaces.emitted, reflectance)
        )
        radiosity = at.radiosity(light, emitted, sent_back)
        mean, error = at.operator.irradiance(radiances[:, k], np.asarray(radiosity, float))
        sun = sun_shares(transport, at.glass, work.sensors, sky.towards[None])[:, 0]
        total = mean + sun * sky.sun[k]
        irradiance[:, own], noise[:, own] = total[:, : len(own)], error[:, : len(own)]
    return SpectralHour(irradiance, noise)
