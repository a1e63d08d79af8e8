"""The cells that Haber's air is cut into: a polar grid about the viewer, in a layered sphere.

Zenith angles and azimuths go by 5 degrees, shells about the viewer grow so that cells are about
as deep as wide. Cells of one zenith angle and shell make a ring; the sun's vertical plane halves
all rings, and the half on one side is kept.
"""

from dataclasses import dataclass

import numpy as np

from vrut_lite.numeric_types import FloatArray, IntArray
from vrut_lite_lab.study.framework.atmosphere import StudyAtmosphere

AZIMUTHS = 72
HALF = AZIMUTHS // 2
STEP_RAD = 2.0 * np.pi / AZIMUTHS
# Light scattered often is computed in every fourth shell.
ACTIVE_EACH = 4
_LAYERS, _TOP_M = 50, 35_000.0
_FIRST_SHELL_M = 10.0
_SHELL_RATIO = (1.0 + np.pi / AZIMUTHS) / (1.0 - np.pi / AZIMUTHS)


@dataclass(frozen=True, eq=False)
class HaberLayers:
    """Radii (51,) in m of the bounds of layers, densities (2, 50) of molecules and aerosol.

    Each holds an equal share of the molecules below 35 km, and the density of its middle.
    """

    bounds_m: FloatArray
    density: FloatArray


@dataclass(frozen=True, eq=False)
class RingCells:
    """The rings above the ground, by zenith angle and then outwards.

    Attributes:
        layers: of the air.
        zenith: number (n,) of the zenith angle.
        shell: number (n,) of the shell.
        across_m, up_m: radius (n,) about the viewer's vertical, height (n,) above the centre.
        volume_m3, depth_m: of each of a ring's cells, (n,).
        density: relative ones (2, n) of molecules and aerosol.
    """

    layers: HaberLayers
    zenith: IntArray
    shell: IntArray
    across_m: FloatArray
    up_m: FloatArray
    volume_m3: FloatArray
    depth_m: FloatArray
    density: FloatArray

    @property
    def centres(self) -> FloatArray:
        """Middle (n, 36, 3) of every cell in m from the planet's centre, x toward the sun."""
        azimuth = cell_azimuths()
        x, y = (self.across_m[:, None] * turn(azimuth) for turn in (np.cos, np.sin))
        return np.stack([x, y, np.broadcast_to(self.up_m[:, None], x.shape)], axis=-1)

    @property
    def active(self) -> IntArray:
        """The rings in which light scattered often is computed."""
        return np.flatnonzero(self.shell % ACTIVE_EACH == 0)


def cell_azimuths() -> FloatArray:
    """Azimuth (36,) of cells from the sun's."""
    return np.asarray((np.arange(HALF) + 0.5) * STEP_RAD)


def zenith_angles(air: StudyAtmosphere) -> FloatArray:
    """Zenith angle (20,) of cells: as far as air below 35 km can be seen, and beyond."""
    half_chord = np.arcsin(0.5 * _horizon_m(air) / air.ground_radius_m)
    count = np.ceil((np.pi / 2 + 2.0 * half_chord) / STEP_RAD)
    return np.asarray((np.arange(count) + 0.5) * STEP_RAD, dtype=float)


def make_cells(air: StudyAtmosphere) -> RingCells:
    """The rings of an atmosphere."""
    layers = _layers(air)
    shells = np.ceil(np.log(_horizon_m(air) / _FIRST_SHELL_M) / np.log(_SHELL_RATIO))
    bound = _FIRST_SHELL_M * _SHELL_RATIO ** np.arange(shells + 1)
    middle = 0.5 * (bound[:-1] + bound[1:])
    angle = zenith_angles(air)
    across = np.multiply.outer(np.sin(angle), middle)
    up = np.multiply.outer(np.cos(angle), middle) + air.ground_radius_m
    altitude = np.hypot(across, up) - air.ground_radius_m
    zenith, shell = np.nonzero((altitude > 0.0) & (altitude < _TOP_M))
    wedge = STEP_RAD * 2.0 * np.sin(angle) * np.sin(0.5 * STEP_RAD)
    found = zenith, shell
    layer = np.searchsorted(layers.bounds_m, altitude[found] + air.ground_radius_m) - 1
    return RingCells(
        layers=layers,
        zenith=zenith,
        shell=shell,
        across_m=across[found],
        up_m=up[found],
        volume_m3=wedge[zenith] * np.diff(bound**3)[shell] / 3.0,
        depth_m=np.diff(bound)[shell],
        density=layers.density[:, layer],
    )


def _layers(air: StudyAtmosphere) -> HaberLayers:
    height = air.rayleigh_scale_height_m
    share = -np.expm1(-_TOP_M / height) * np.arange(_LAYERS + 1) / _LAYERS
    altitude = -height * np.log1p(-share)
    middle = 0.5 * (altitude[:-1] + altitude[1:])
    heights = np.array([height, air.mie_scale_height_m])
    return HaberLayers(air.ground_radius_m + altitude, np.exp(-middle / heights[:, None]))


def _horizon_m(air: StudyAtmosphere) -> float:
    """How far the top of the layers is at the horizon."""
    return float(np.sqrt(_TOP_M * (_TOP_M + 2.0 * air.ground_radius_m)))
