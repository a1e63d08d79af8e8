"""Light in plane layers of cloud, by tables of adding and doubling (vrut_lite_lab.cloud_transport).

Layers scatter without loss, by the phase function of droplets (Deirmendjian's C1, Mie's theory).
Delta-M takes a share `forward_share` of the scattered light for not scattered: the tables count in
scaled optical depth, (1 - forward_share) times the real one. All that is public here takes real
depths unless it says "scaled".

Source of multiply scattered light (sr^-1 times the sun's irradiance), per scaled depth, for an
azimuth phi between sun and view: exp(c0 + c1 cos(phi) + c2 cos(2 phi) + c3 log P2), within 0.8 %
rms. P2 is the phase function of light scattered twice; with it thin layers need few waves. Numbers
depend on the depths above and below, the sine of the sun's elevation and the view's cosine mu to
the layer's normal, positive where one looks up to the sun's side. After the last sine c0 is the
source by even light of radiance 1 from above; even light from below gives 1 minus it, since even
light all round stays even.
"""

from functools import lru_cache
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from vrut_lite.atmosphere.aerosols import droplets as fog
from vrut_lite.atmosphere.aerosols.phase_table import PHASE_NODES, PhaseTable, node_cosines
from vrut_lite.messages.clouds import Particles
from vrut_lite.numeric_types import FloatArray

FILE = Path(__file__).parent / "data" / "cloud_transport.npz"
_CRYSTALS = Path(__file__).parent / "data" / "ice_crystals.npz"
# Nodes of the flux tables: scaled optical depths, and sines of the sun's elevation.
FLUX_DEPTHS = np.geomspace(0.01, 400.0, 48)
FLUX_SINES = np.linspace(0.02, 1.0, 50)
# Nodes of the source table: scaled optical depths above and below, sines of the sun's elevations,
# denser near the horizon, and of the view's, evenly spaced: an azimuth's part is linear in the
# angle to the normal.
DEPTH_SCALE, MOST_DEPTH, LOWEST_RAD = 0.3, 60.0, 0.04
_DEPTHS, _SINES, _VIEWS = 20, 12, 16
NODE_DEPTHS = DEPTH_SCALE * np.expm1(np.linspace(0.0, np.log1p(MOST_DEPTH / DEPTH_SCALE), _DEPTHS))
NODE_SINES = np.sin(LOWEST_RAD + (0.5 * np.pi - LOWEST_RAD) * np.linspace(0.0, 1.0, _SINES) ** 2)
NODE_VIEWS = np.sin(np.linspace(-0.5 * np.pi, 0.5 * np.pi, _VIEWS))


class TransportTables(NamedTuple):
    """The tables of plane layers.

    Attributes:
        forward_share: of scattered light, which delta-M takes for not scattered.
        sun_transmittance: (FLUX_DEPTHS, FLUX_SINES) of sunlight on the level, direct and diffuse.
        even_transmittance: (FLUX_DEPTHS,) of even light.
        source: (sines + 1, below, above, views, 4) float32: c0 to c3; at last by even light.
        log_twice: (PHASE_NODES,) log P2.
    """

    forward_share: float
    sun_transmittance: FloatArray
    even_transmittance: FloatArray
    source: NDArray[np.float32]
    log_twice: FloatArray


@lru_cache(maxsize=1)
def transport_tables() -> TransportTables:
    """The tables, read once."""
    with np.load(FILE) as data:
        return TransportTables(
            float(data["forward"]),
            data["sun_transmittance"].astype(float),
            data["even_transmittance"].astype(float),
            np.ascontiguousarray(data["source"], dtype=np.float32),
            data["log_twice"].astype(float),
        )


@lru_cache(maxsize=1)
def droplets() -> PhaseTable:
    """Phase functions of cloud droplets at 475, 550 and 625 nm, in this order."""
    with np.load(fog.FILE) as data:
        return PhaseTable.of_angles(data["angle_rad"], data["phase_per_sr"][1:4].astype(float))


@lru_cache(maxsize=1)
def _droplets_parts() -> tuple[FloatArray, FloatArray]:
    """Phase functions (PHASE_NODES, 3), red first: the wide part, and the forward peak.

    The peak holds `forward_share`. What it scatters has the sun's whole extinction behind it, or
    the forward peaks of several scatterings would count twice; the rest has the diffused one.
    """
    parts = np.empty((2, PHASE_NODES, 3))
    for channel, row in enumerate(droplets().values[::-1]):
        low, high = 0.0, float(row[0])
        for _ in range(60):
            level = 0.5 * (low + high)
            share = -2.0 * np.pi * np.trapezoid(np.maximum(row - level, 0.0), node_cosines())
            low, high = (level, high) if share > transport_tables().forward_share else (low, level)
        parts[:, :, channel] = np.minimum(row, level), np.maximum(row - level, 0.0)
    return parts[0], parts[1]


@lru_cache(maxsize=1)
def ice_crystals() -> PhaseTable:
    """Phase functions of hexagonal columns of ice at 475, 550 and 625 nm (vrut_lite_lab.ice_phase).

    Without diffraction and what passes parallel faces, 64 % of a crystal's extinction: that light
    keeps its direction, and counts as not scattered.
    """
    with np.load(_CRYSTALS) as data:
        return PhaseTable(data["phase_per_sr"])


class CloudParticles(NamedTuple):
    """Optical properties of a layer's particles.

    Attributes:
        phase: (3, PHASE_NODES, 3) in sr^-1, red first: the wide part, the forward peak, log P2.
        diffused: share of the extinction that diffuses, after delta-M.
    """

    phase: FloatArray
    diffused: float


def scatterer(particles: Particles) -> CloudParticles:
    """The particles of a layer. Ice is diffused as droplets of the same scaled depth are."""
    if particles == "ice":
        wide = ice_crystals().values[::-1].T
        parts, diffused = (wide, np.zeros_like(wide)), 1.0
    else:
        parts, diffused = _droplets_parts(), 1.0 - transport_tables().forward_share
    twice = np.repeat(transport_tables().log_twice[:, None], 3, axis=1)
    return CloudParticles(np.stack([*parts, twice]), diffused)


def layer_transmittance(optical_depth: ArrayLike, sun_sine: ArrayLike) -> FloatArray:
    """Share (...,) of the sun's irradiance of the level that passes a plane layer.

    Args:
        optical_depth: (...,) vertical, 0 or more.
        sun_sine: (...,) sine of the sun's elevation; below 0.02 as at 0.02.
    """
    tables = transport_tables()
    depth, sine = np.broadcast_arrays(
        np.asarray(optical_depth, dtype=float), np.asarray(sun_sine, dtype=float)
    )
    place = np.clip((sine - FLUX_SINES[0]) / (FLUX_SINES[1] - FLUX_SINES[0]), 0.0, None)
    low = np.minimum(place.astype(int), FLUX_SINES.size - 2)
    share = np.minimum(place - low, 1.0)
    row, part = _depth_place(depth * (1.0 - tables.forward_share))
    ratio = _hindrance(tables.sun_transmittance)
    near = ratio[row, low] * (1.0 - part) + ratio[row + 1, low] * part
    far = ratio[row, low + 1] * (1.0 - part) + ratio[row + 1, low + 1] * part
    hindered = near * (1.0 - share) + far * share
    return np.asarray(1.0 / (1.0 + hindered * depth * (1.0 - tables.forward_share)))


def layer_reflectance(optical_depth: ArrayLike, sun_sine: ArrayLike) -> FloatArray:
    """Share (...,) of the sun's irradiance of the level that a plane layer sends back."""
    return 1.0 - layer_transmittance(optical_depth, sun_sine)


def even_transmittance(optical_depth: ArrayLike) -> FloatArray:
    """Share (...,) of even light, from above or from below, that passes a plane layer."""
    tables = transport_tables()
    depth = np.asarray(optical_depth, dtype=float) * (1.0 - tables.forward_share)
    row, part = _depth_place(depth)
    ratio = _hindrance(tables.even_transmittance)
    hindered = ratio[row] * (1.0 - part) + ratio[row + 1] * part
    return np.asarray(1.0 / (1.0 + hindered * depth))


def _hindrance(transmittance: FloatArray) -> FloatArray:
    """Reflectance over transmittance, a unit of depth: smooth, and constant in thick layers."""
    depths = FLUX_DEPTHS.reshape(-1, *[1] * (transmittance.ndim - 1))
    return np.asarray((1.0 - transmittance) / (transmittance * depths))


def _depth_place(scaled: FloatArray) -> tuple[FloatArray, FloatArray]:
    """The row of `FLUX_DEPTHS` before scaled depths (...,), and the share of the next."""
    logs = np.log(FLUX_DEPTHS)
    place = (np.log(np.maximum(scaled, 1e-30)) - logs[0]) / (logs[1] - logs[0])
    row = np.clip(np.floor(place), 0, FLUX_DEPTHS.size - 2).astype(int)
    return row, np.clip(place - row, 0.0, 1.0)
