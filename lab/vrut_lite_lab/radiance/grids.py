"""Level grids of points in scenes, and the light there by our rays and by Radiance's."""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
from light_transport.hour.illumination import Illumination
from light_transport.layout.layout import lay_out
from light_transport.surfaces.surfaces import Surfaces, surfaces_of
from light_transport.tolerance import quality_for
from light_transport.transport import SceneTransport
from light_transport.view.point_light import light_at

from vrut_lite.geometry.colour import luminance
from vrut_lite.messages.scene import SceneOpened
from vrut_lite.messages.tolerance import DEFAULT_TOLERANCE
from vrut_lite.numeric_types import BoolArray, Float32Array, FloatArray
from vrut_lite_lab.path_traced.cases import light_of_state, states
from vrut_lite_lab.radiance.irradiance import RadianceEffort, irradiance_by_radiance
from vrut_lite_lab.scenes import trials

# Of the mean: points with less light by both lie inside bodies.
_LEAST_SHARE = 0.02
# Of texels: cosine of their slope, share of their rays that do not begin in bodies.
_FACES_UP, _FREE_SHARE = 0.99, 0.98
_CLEARANCE_M = 1e-3


@dataclass(frozen=True)
class MeasuredPoints:
    """Points in a scene: a file in scenes/, or the name of a trial scene.

    `corners_m`: x and z of two corners; `height_m` above the world's origin; `counts` along x, z.
    """

    scene: str
    corners_m: tuple[float, float, float, float]
    height_m: float
    counts: tuple[int, int] = (5, 5)

    @cached_property
    def file(self) -> str:
        """What is opened; trial scenes are written to their folder."""
        if Path(self.scene).suffix:
            return self.scene
        path = trials.FOLDER / f"{self.scene}.glb"
        trials.FOLDER.mkdir(parents=True, exist_ok=True)
        path.write_bytes(trials.build()[path.name])
        return str(path)

    @property
    def places_m(self) -> FloatArray:
        """The points (P, 3), world axes."""
        x0, z0, x1, z1 = self.corners_m
        x, z = np.meshgrid(np.linspace(x0, x1, self.counts[0]), np.linspace(z0, z1, self.counts[1]))
        return np.stack([x.ravel(), np.full(x.size, self.height_m), z.ravel()], axis=1)


# At desks in the rooms, at a man's chest outdoors and in halls.
GRIDS = (
    MeasuredPoints("work/indoor.glb", (-1.4, -1.7, 1.4, 1.7), 0.85),
    MeasuredPoints("large/hall.toml", (-24.0, 8.0, 24.0, 64.0), 1.5),
    MeasuredPoints("courtyard", (-4.0, -4.0, 4.0, 4.0), 1.2),
    MeasuredPoints("colour_bleeding", (-1.7, -1.7, 1.7, 1.7), 0.85),
    MeasuredPoints("street.toml", (-2.0, -12.0, 2.0, 12.0), 1.5),
    MeasuredPoints("atrium", (-5.0, -8.0, 5.0, 8.0), 1.5),
    MeasuredPoints("pavilion.gltf", (-6.0, -6.0, 6.0, 6.0), 2.5),
)


@dataclass(frozen=True, eq=False)
class ComparedIrradiance:
    """Luminance of the irradiance (P,) without the key light's own, W m^-2, by both."""

    ours: FloatArray
    radiance: FloatArray

    @property
    def free(self) -> int:
        """How many points do not lie inside bodies."""
        return int(self._free.sum())

    @property
    def mean(self) -> float:
        """How much more light is ours, as a share."""
        return float(self._error.mean())

    @property
    def rms(self) -> float:
        """Of the difference at points, as a share of the mean."""
        return float(np.sqrt(np.mean(self._error**2)))

    @property
    def most(self) -> float:
        """The largest difference."""
        return float(np.abs(self._error).max())

    @property
    def _free(self) -> BoolArray:
        return np.asarray(
            np.maximum(self.ours, self.radiance) > _LEAST_SHARE * self.radiance.mean()
        )

    @property
    def _error(self) -> FloatArray:
        expected = self.radiance[self._free]
        return np.asarray((self.ours[self._free] - expected) / expected.mean())


class Baked:
    """A scene with the light map that the product has at the default tolerance."""

    def __init__(self, scene: SceneOpened):
        quality = quality_for(DEFAULT_TOLERANCE)
        self.surfaces: Surfaces = surfaces_of(scene)
        layout = lay_out(scene, self.surfaces, None, quality.texels)
        self.transport = SceneTransport(
            self.surfaces, layout, 2, quality.patch_texels, quality.bounces_left
        )
        self.transport.add_rays(quality.rays)

    def at_points(
        self, places_m: FloatArray, hour: Illumination, effort: RadianceEffort
    ) -> ComparedIrradiance:
        """Upwards at points: by rays of their own, which end on the light map's patches."""
        up = np.tile([0.0, 1.0, 0.0], (len(places_m), 1))
        ours = light_at(
            self.transport, places_m, up, self.transport.light(hour), effort.rays
        ).irradiance_rgb
        return self._compared(ours, places_m, up, hour, effort)

    def on_texels(
        self, grid: MeasuredPoints, count: int, hour: Illumination, effort: RadianceEffort
    ) -> ComparedIrradiance:
        """Some texels below a grid that face up, not within bodies, as the frame shows them."""
        transport, surfaces = self.transport, self.surfaces
        texels = transport.texels
        normals = texels.normal.astype(float)
        places_m = texels.place * surfaces.radius_m + surfaces.centre_m + _CLEARANCE_M * normals
        x0, z0, x1, z1 = grid.corners_m
        lower, upper = np.array([x0, -np.inf, z0]), np.array([x1, grid.height_m, z1])
        below = ((places_m > lower) & (places_m < upper)).all(axis=1)
        free = transport.table.valid[: len(places_m)] > _FREE_SHARE * transport.rays
        found = np.flatnonzero(below & free & (normals[:, 1] > _FACES_UP))
        chosen = np.random.default_rng(0).choice(found, min(count, len(found)), replace=False)
        column, row = texels.pixel[chosen].T
        light = transport.light(hour).texels[row, column, :3]
        return self._compared(light, places_m[chosen], normals[chosen], hour, effort)

    def _compared(
        self,
        ours: Float32Array,
        places_m: FloatArray,
        normals: FloatArray,
        hour: Illumination,
        effort: RadianceEffort,
    ) -> ComparedIrradiance:
        theirs = irradiance_by_radiance(self.surfaces, hour, places_m, normals, effort)
        return ComparedIrradiance(
            np.asarray(luminance(ours), float), np.asarray(luminance(theirs), float)
        )


def compared_hours(
    grid: MeasuredPoints, sky: str, hours: tuple[str, ...]
) -> Iterator[tuple[str, Baked, Illumination]]:
    """The caption, the scene and the light of each hour."""
    baked: Baked | None = None
    for case, state in states(grid.file, sky, hours):
        assert state.scene is not None
        baked = baked or Baked(state.scene)
        yield case.caption, baked, light_of_state(state)
