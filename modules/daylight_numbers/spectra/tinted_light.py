"""Light through coloured glass at some wavelengths, seen by sensors and on patches.

Light transport passes glass by its mean luminance. Rays of sensors are therefore traced through
coloured glass at each wavelength, and 256 rays of each patch. Light of the sky on a patch is scaled
by the ratio of its rays' light behind coloured glass to that behind grey glass; to light of patches
beyond glass the difference of both is added, and bounces are solved a second time.
"""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from light_transport.public import NODES, SceneTransport
from scipy.sparse import csr_matrix

from daylight_numbers.glazing.glass import Glass
from daylight_numbers.matrix.operator import Operator, operator_of
from daylight_numbers.matrix.sensor_rays import OPEN_GROUND, SKY, around, ends_of, glazed
from daylight_numbers.sky_cells import on_disc
from daylight_numbers.spectra.spectral_surfaces import Bands, SpectralSurfaces
from daylight_numbers.work import RAYS_SHARE, DaylightWork
from vrut_lite.geometry.colour import luminance
from vrut_lite.numeric_types import BoolArray, Float32Array, FloatArray, IntArray

# Rays of a patch, along each edge of a square of cells.
_EDGE = 16
_RAYS = _EDGE * _EDGE
# By which numbers are spread evenly from 0 to 1.
_GOLDEN = 0.5 * (np.sqrt(5.0) - 1.0)
# Solutions after the first: light that has passed glass twice is negligible.
_AGAIN = 1
_OFF = 1e-5
_LEAST = 1e-12


class PatchTint(NamedTuple):
    """Change of the light of patches from grey glass to coloured glass, at three wavelengths:
    `of_sky` (M, 3) ratios of their first light, `beyond` (M, M) differences of light by others."""

    of_sky: FloatArray
    beyond: tuple[csr_matrix, csr_matrix, csr_matrix]


class LightAt(NamedTuple):
    """Three wavelengths, the glass and the matrix of sensors at them, and the tint of patches."""

    bands: Bands
    glass: Glass
    operator: Operator
    transport: SceneTransport
    tint: PatchTint | None = None

    @property
    def threads(self) -> int:
        """The number that solve at once."""
        return self.transport.threads

    def radiosity(
        self, direct: Float32Array, emitted: Float32Array, reflectance: Float32Array
    ) -> Float32Array:
        """Radiosity (M, 3) of patches by first light behind grey glass; all (M, 3)."""
        if self.tint is None:
            return self.transport.radiosity(direct, emitted, reflectance)
        first = (direct * self.tint.of_sky).astype(np.float32)
        found = self.transport.radiosity(first, emitted, reflectance)
        for _ in range(_AGAIN):
            more = [matrix @ found[:, k] for k, matrix in enumerate(self.tint.beyond)]
            light = (first + np.stack(more, axis=1)).astype(np.float32)
            found = self.transport.radiosity(light, emitted, reflectance)
        return found


def through_glass(
    work: DaylightWork, surfaces: SpectralSurfaces, tolerance: float, wanted: Iterator[Bands]
) -> Iterator[LightAt]:
    """Light at some wavelengths; without coloured glass the work's own matrix serves all.

    `tolerance` is as of the work.
    """
    transport = work.transport
    if not surfaces.glass_is_own:
        for at in wanted:
            yield LightAt(at, work.glass, work.operator, transport)
        return
    rays = _PatchRays(transport, work.glass)
    for at in wanted:
        glass = surfaces.glass(work.glass, at)
        operator = operator_of(
            transport, glass, work.sensors, RAYS_SHARE * tolerance, transport.threads
        )
        yield LightAt(at, glass, operator, transport, rays.tint(glass))


class _PatchRays:
    """Rays of patches, the same for each wavelength, and what grey glass leaves of them."""

    def __init__(self, transport: SceneTransport, grey: Glass):
        assert transport.patches is not None
        patches, texels = transport.patches, transport.receivers.texels
        # A ray in each cell of the hemisphere, each from another of the patch's texels.
        places = np.diff(patches.start)[:, None] * (_GOLDEN * np.arange(_RAYS) % 1.0)
        row = patches.member[patches.start[:-1, None] + places.astype(np.int64)].astype(np.int64)
        # Groups of triangles without texels keep the light of grey glass.
        self._patch: IntArray = np.flatnonzero((row < len(texels.pixel)).all(axis=1))
        self._count, self._transport = len(row), transport
        row = row[self._patch].ravel()
        normal = texels.normal[row].astype(float)
        cells = np.indices((_EDGE, _EDGE)).reshape(2, -1)
        at = on_disc(*((cells + 0.5) * (2.0 / _EDGE) - 1.0))
        self._direction = around(normal, *(np.tile(v, len(self._patch)) for v in at))
        self._place = texels.place[row].astype(float) + _OFF * normal
        target, share = ends_of(glazed(transport, grey), self._place, self._direction)
        self._grey = luminance(share[:, 0])
        self._outside: BoolArray = (target[:, 0] == SKY) | (target[:, 0] == OPEN_GROUND)
        met = target[:, 0]
        column = patches.column_of[NODES + np.maximum(met, 0)] - NODES
        is_patch = (met >= 0) & (column < self._count) & (share[:, 0].min(axis=1) < 1.0)
        self._beyond: IntArray = np.flatnonzero(is_patch)
        self._column = column[self._beyond]

    def tint(self, glass: Glass) -> PatchTint:
        """The tint of glass of three wavelengths."""
        _, share = ends_of(glazed(self._transport, glass), self._place, self._direction)
        passed = np.asarray(share[:, 0], float)
        means = self._means(self._grey[:, None])
        known = means > _LEAST
        ratio = np.where(known, self._means(passed) / np.where(known, means, 1.0), 1.0)
        receiver = np.repeat(self._patch, _RAYS)[self._beyond]
        more = (passed - self._grey[:, None])[self._beyond] / _RAYS
        shape = (self._count, self._count)
        one, two, three = (
            csr_matrix((more[:, k], (receiver, self._column)), shape) for k in range(3)
        )
        return PatchTint(ratio, (one, two, three))

    def _means(self, passed: FloatArray) -> FloatArray:
        """Mean (M, C) of the rays (R, C) that end outside."""
        found = np.zeros((self._count, passed.shape[1]))
        outside = passed * self._outside[:, None]
        found[self._patch] = outside.reshape(-1, _RAYS, passed.shape[1]).mean(axis=1)
        return found
