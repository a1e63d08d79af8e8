"""Light of plane clouds by discrete ordinates (PythonicDISORT)."""

import warnings
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from clouds.model.cloud_transport import droplets
from PythonicDISORT import pydisort

from vrut_lite.atmosphere.aerosols.phase_table import node_places
from vrut_lite.numeric_types import FloatArray

_STREAMS, _MOMENTS = 48, 256
AZIMUTHS = np.linspace(0.0, np.pi, 61)


class Ordinates(NamedTuple):
    """Diffuse light of a plane layer of droplets by a sun of irradiance 1 (on its normal).

    Attributes:
        mu: (n,) rising.
        base, top: (n, AZIMUTHS) radiance of what goes down at the base and up at the top; azimuths
            count from the way in which sunlight goes.
        transmittance: of the sun's flux, direct included.
        diffuse: the same without it.
    """

    mu: FloatArray
    base: FloatArray
    top: FloatArray
    transmittance: float
    diffuse: float

    def below(self, mu: float, azimuth: float) -> float:
        """Radiance of the base."""
        return float(self._at(self.base, mu, azimuth))

    def above(self, mu: float, azimuth: float) -> float:
        """Radiance of the top."""
        return float(self._at(self.top, mu, azimuth))

    def _at(self, radiance: FloatArray, mu: float, azimuth: float) -> float:
        around = abs((azimuth + np.pi) % (2.0 * np.pi) - np.pi)
        by_mu = [np.interp(around, AZIMUTHS, row) for row in radiance]
        return float(np.interp(mu, self.mu, by_mu))


@lru_cache(maxsize=64)
def ordinates_of(optical_depth: float, sun_sine: float) -> Ordinates:
    """Light of a layer of this depth; 48 streams, corrected as Nakajima and Tanaka 1988 do.

    Their series of light scattered once, of `_MOMENTS`, is replaced by the phase function itself:
    at the side it would oscillate by several percent.
    """
    chi = np.maximum(droplets().coefficients(_MOMENTS)[1], 0.0)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        mu, _, down, _, radiance = pydisort(
            np.array([optical_depth]), np.array([1.0 - 1e-9]), _STREAMS, chi[None], sun_sine, 1.0,
            0.0, NLeg=_STREAMS, NFourier=_STREAMS, f_arr=chi[_STREAMS], NT_cor=True,
        )  # fmt: skip
        base = np.asarray(radiance(optical_depth, AZIMUTHS))[_STREAMS // 2 :]
        top = np.asarray(radiance(0.0, AZIMUTHS))[: _STREAMS // 2]
        diffuse, direct = (float(flux) / sun_sine for flux in down(optical_depth))
    nodes = np.asarray(mu[: _STREAMS // 2])
    forward = float(chi[_STREAMS])
    scaled = optical_depth * (1.0 - forward)
    lit = -np.expm1(-scaled * (1.0 / nodes + 1.0 / sun_sine)) / (1.0 + nodes / sun_sine)
    passed = np.exp(-scaled / nodes) - np.exp(-scaled / sun_sine)
    passing = sun_sine / (nodes - sun_sine) * passed
    base = base + _beyond_series(chi, nodes, sun_sine) * (passing / (1.0 - forward))[:, None]
    top = top + _beyond_series(chi, -nodes, sun_sine) * (lit / (1.0 - forward))[:, None]
    order = np.argsort(nodes)
    return Ordinates(nodes[order], base[order], top[order], diffuse + direct, diffuse)


def _beyond_series(chi: FloatArray, mu: FloatArray, sun_sine: float) -> FloatArray:
    """What the phase function has (n, AZIMUTHS), sr^-1, that its moments have not."""
    across = np.sqrt((1.0 - mu * mu) * (1.0 - sun_sine**2))[:, None]
    nu = np.clip(mu[:, None] * sun_sine + across * np.cos(AZIMUTHS), -1.0, 1.0)
    order = np.arange(len(chi))
    series = np.polynomial.legendre.legval(nu, (2.0 * order + 1.0) * chi) / (4.0 * np.pi)
    place = np.sqrt(0.5 - 0.5 * nu)
    return np.asarray(np.interp(place, node_places(), droplets().values[1]) - series)
