"""Make modules/clouds/model/data/cloud_transport.npz: diffuse light in plane layers of droplets.

    python -m vrut_lite_lab.cloud_transport

Adding and doubling in float64 (van de Hulst 1963; Hansen and Travis 1974, "Light scattering in
planetary atmospheres", section 3) for a conservative layer. The phase function is that of fog's
droplets at 550 nm, cut by delta-M (Wiscombe 1977) after `STREAMS` moments; depths are the scaled
ones. `modules/clouds/model/cloud_transport.py` says what the tables mean.
"""

from typing import NamedTuple

import numpy as np
from clouds.model.cloud_transport import (
    FILE,
    FLUX_DEPTHS,
    FLUX_SINES,
    NODE_DEPTHS,
    NODE_SINES,
    NODE_VIEWS,
    droplets,
)
from numpy.typing import NDArray

from vrut_lite.atmosphere.aerosols.phase_table import node_cosines
from vrut_lite.numeric_types import FloatArray

STREAMS = 16
_THINNEST = 1e-7
_LEAST_DEPTH = 0.02
_AZIMUTHS = 17


class TransportLayer(NamedTuple):
    """What one Fourier mode of radiance meets in a layer; the same from above and below.

    Attributes:
        reflect, transmit: (n, n) of radiance at the nodes; direct light included.
        beam_up, beam_down: (n, suns) diffuse radiance by beams of irradiance 1 that face it.
        beam: (suns,) transmittance of the beams.
    """

    reflect: FloatArray
    transmit: FloatArray
    beam_up: FloatArray
    beam_down: FloatArray
    beam: FloatArray


class Between(NamedTuple):
    """Radiance (n, k) down and up between two layers."""

    down: NDArray
    up: NDArray


def moments() -> tuple[FloatArray, float]:
    """Legendre coefficients (STREAMS,) after delta-M, and the share f that it takes for forward."""
    chi = droplets().coefficients(STREAMS)[1]
    forward = float(chi[-1])
    return (chi[:-1] - forward) / (1.0 - forward), forward


def scattered_twice(nu: FloatArray) -> FloatArray:
    """Phase function P2 (...,), 4 pi over the sphere, of light scattered twice: moments squared."""
    squares = (2.0 * np.arange(STREAMS) + 1.0) * moments()[0] ** 2
    return np.asarray(np.polynomial.legendre.legval(nu, squares))


def legendre(mode: int, mu: FloatArray) -> FloatArray:
    """Associated Legendre functions (STREAMS, n), normalised by sqrt((l - m)! / (l + m)!)."""
    table = np.zeros((STREAMS, mu.size))
    first = np.ones(mu.size)
    for k in range(1, mode + 1):
        first = first * np.sqrt((2.0 * k - 1.0) / (2.0 * k)) * np.sqrt(1.0 - mu * mu)
    table[mode] = first
    for degree in range(mode + 1, STREAMS):
        low = np.sqrt((degree - 1.0) ** 2 - mode**2)
        before = table[degree - 2] if degree > mode + 1 else 0.0
        table[degree] = ((2 * degree - 1) * mu * table[degree - 1] - low * before) / np.sqrt(
            degree**2 - mode**2
        )
    return table


class Mode:
    """One Fourier mode in azimuth: phase matrices, thin layers, doubling.

    Args:
        number: of the mode.
        suns: (k,) sines of the elevation of beams.
    """

    def __init__(self, number: int, suns: NDArray, nodes: int = STREAMS):
        x, w = np.polynomial.legendre.leggauss(nodes)
        self.mu, self.weight = 0.5 * (x + 1.0), 0.5 * w
        self.number, self.suns = number, suns
        chi = moments()[0]
        self._chi = (2.0 * np.arange(STREAMS) + 1.0) * chi

    def phase(self, to: FloatArray, from_: FloatArray) -> FloatArray:
        """Mode of the phase function (n, k), 4 pi over the sphere."""
        to_part = legendre(self.number, to)
        return np.asarray((to_part * self._chi[:, None]).T @ legendre(self.number, from_))

    def layer(self, depth: float) -> TransportLayer:
        """A layer of a scaled optical depth, by doubling a thin one."""
        doublings = max(int(np.ceil(np.log2(depth / _THINNEST))), 0)
        thin = self._thin(depth / 2.0**doublings)
        for _ in range(doublings):
            thin = together(thin, thin)
        return thin

    def nothing(self) -> TransportLayer:
        """A layer of depth 0."""
        n, k = self.mu.size, self.suns.size
        none = np.zeros((n, k))
        return TransportLayer(np.zeros((n, n)), np.eye(n), none, none, np.ones(k))

    def source(self, view: FloatArray, between: Between) -> FloatArray:
        """Source (views, k) that a field sends towards views; their mu is positive downward."""
        weights = 0.5 * self.weight
        down = (self.phase(view, self.mu) * weights) @ between.down
        return np.asarray(down + (self.phase(view, -self.mu) * weights) @ between.up)

    def _thin(self, depth: float) -> TransportLayer:
        rise = (depth / self.mu)[:, None]
        weights = 0.5 * self.weight
        gone = np.exp(-depth / self.mu)
        return TransportLayer(
            rise * self.phase(self.mu, -self.mu) * weights,
            np.diag(gone) + rise * self.phase(self.mu, self.mu) * weights,
            rise * self.phase(self.mu, -self.suns) / (4.0 * np.pi),
            rise * self.phase(self.mu, self.suns) / (4.0 * np.pi),
            np.exp(-depth / self.suns),
        )


def beams_between(above: TransportLayer, below: TransportLayer) -> Between:
    """Diffuse radiance between two layers, lit by the beams from above."""
    reflected = below.beam_up * above.beam
    there_and_back = np.eye(len(above.reflect)) - above.reflect @ below.reflect
    down = np.linalg.solve(there_and_back, above.beam_down + above.reflect @ reflected)
    return Between(np.asarray(down), np.asarray(reflected + below.reflect @ down))


def even_between(above: TransportLayer, below: TransportLayer) -> Between:
    """Radiance between two layers, lit from above by even light of radiance 1; mode 0."""
    there_and_back = np.eye(len(above.reflect)) - above.reflect @ below.reflect
    down = np.linalg.solve(there_and_back, above.transmit.sum(axis=1, keepdims=True))
    return Between(down, np.asarray(below.reflect @ down))


def together(above: TransportLayer, below: TransportLayer) -> TransportLayer:
    """Two layers as one."""
    there_and_back = np.eye(len(above.reflect)) - above.reflect @ below.reflect
    down = np.linalg.solve(there_and_back, above.transmit)
    beams = beams_between(above, below)
    return TransportLayer(
        above.reflect + above.transmit @ below.reflect @ down,
        below.transmit @ down,
        above.beam_up + above.transmit @ beams.up,
        below.beam_down * above.beam + below.transmit @ beams.down,
        above.beam * below.beam,
    )


def flux_table() -> tuple[FloatArray, FloatArray]:
    """Transmittance of sunlight (depths, sines) and of even light (depths,), direct included."""
    mode = Mode(0, FLUX_SINES)
    flux = 2.0 * np.pi * mode.weight * mode.mu
    beams, even = [], []
    for depth in FLUX_DEPTHS:
        layer = mode.layer(depth)
        beams.append(flux @ layer.beam_down / FLUX_SINES + layer.beam)
        even.append(flux @ layer.transmit.sum(axis=1) / np.pi)
    return np.array(beams), np.array(even)


def source_table() -> FloatArray:
    """Sources (sines + 1, below, above, views, 4), as `cloud_transport` has them."""
    azimuth = np.linspace(0.0, np.pi, _AZIMUTHS)
    # Between two layers of nothing there is no light, whose logarithm would be needed.
    depths = np.maximum(NODE_DEPTHS, _LEAST_DEPTH)
    shape = (NODE_SINES.size, depths.size, depths.size, NODE_VIEWS.size)
    sources, even = np.zeros((*shape, _AZIMUTHS)), np.zeros(shape)
    for number in range(STREAMS):
        mode = Mode(number, NODE_SINES)
        layers = [mode.layer(depth) for depth in depths]
        wave = (1.0 if number == 0 else 2.0) * np.cos(number * azimuth)
        for a, above in enumerate(layers):
            for b, below in enumerate(layers):
                source = mode.source(NODE_VIEWS, beams_between(above, below))
                sources[:, b, a] += source.T[..., None] * wave
                if number == 0:
                    even[:, b, a] = mode.source(NODE_VIEWS, even_between(above, below))[:, 0]
    # In the logarithm all azimuths weigh alike, and nothing gets negative.
    logs = np.log(sources)
    waves = np.cos(np.arange(3) * azimuth[:, None])
    level = np.sqrt(np.outer(1.0 - NODE_SINES**2, 1.0 - NODE_VIEWS**2))[..., None]
    nu = np.outer(NODE_SINES, NODE_VIEWS)[..., None] + level * np.cos(azimuth)
    twice = np.log(scattered_twice(np.clip(nu, -1.0, 1.0)))
    # One weight for all directions of two depths: where sun or view stand on the normal a weight of
    # its own could not be told from the mean.
    beside = np.eye(_AZIMUTHS) - waves @ np.linalg.pinv(waves)
    rest = twice @ beside
    weight = np.einsum("sbavk,svk->ba", logs, rest) / (rest * rest).sum()
    fourth = np.broadcast_to(weight[:, :, None, None], (*shape, 1))
    waving = (logs - fourth * twice[:, None, None]) @ np.linalg.pinv(waves).T
    last = np.zeros((1, *shape[1:], 4))
    last[..., 0] = even[:1]
    return np.concatenate([np.concatenate([waving, fourth], axis=-1), last])


def main() -> None:
    """Compute and write the tables."""
    beams, even = flux_table()
    np.savez_compressed(
        FILE,
        forward=moments()[1],
        sun_transmittance=beams.astype(np.float32),
        even_transmittance=even.astype(np.float32),
        source=source_table().astype(np.float16),
        log_twice=np.log(scattered_twice(node_cosines())).astype(np.float32),
    )


if __name__ == "__main__":
    main()
