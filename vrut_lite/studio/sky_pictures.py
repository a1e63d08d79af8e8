"""Pictures of the sky alone, by one kernel without GL."""

from collections.abc import Iterable
from dataclasses import dataclass
from datetime import datetime
from math import degrees, radians
from pathlib import Path
from typing import Literal

import msgspec
import numpy as np
from numpy.typing import NDArray

from vrut_lite.array import Array
from vrut_lite.daylight_kernel import FaultCollector, demand_light
from vrut_lite.errors import ModuleFailed, UserError
from vrut_lite.geometry.colour import luminance
from vrut_lite.geometry.encoding import decode_float16
from vrut_lite.geometry.frames import enu_from_world, world_from_enu
from vrut_lite.geometry.panorama import sample_sky, unfold_cube
from vrut_lite.geometry.polarisation import (
    degree_and_angle,
    map_axis,
    turned,
    vertical_axis,
)
from vrut_lite.geometry.sky_map import CubeFaces, FisheyeMap, LatLongMap, SkyMap
from vrut_lite.geometry.sun_disc import disc_radiance, points_radiance
from vrut_lite.kernel.bus import Kernel
from vrut_lite.kernel.messages import Demand, SetClock
from vrut_lite.messages.camera import MoveCamera
from vrut_lite.messages.night import MoonDiscChanged, StarsChanged
from vrut_lite.messages.sky import SkyPolarisationChanged
from vrut_lite.messages.sky_light import SkyLightChanged
from vrut_lite.messages.sun import KeyLightChanged
from vrut_lite.numeric_types import Float32Array, FloatArray
from vrut_lite.pictures.display import Bits, display_picture
from vrut_lite.pictures.image_files import (
    Metadata,
    write_exr,
    write_hdr,
    write_json,
    write_npz,
    write_png,
)
from vrut_lite.project import Project, daylight_inputs, setting_inputs
from vrut_lite.sky.moon_disc import moon_samples
from vrut_lite.studio.open_kernel import open_kernel, require_sky
from vrut_lite.studio.picture_metadata import hour_text, json_values, picture_metadata, vector_text
from vrut_lite.studio.progress import tracked
from vrut_lite.studio.time_span import at_instant, other_side

Projection = Literal["lat-long", "cube", "fisheye"]
PROJECTIONS: tuple[Projection, ...] = ("lat-long", "cube", "fisheye")
STOKES_FORMATS = (".exr", ".npz")
# Edge of the cubes of Q and U: between its texels they err by less than 0.1 % of the radiance.
_POLARISED_SIZE = 128
_CONVENTION = (
    "Q > 0 vibrates in the view's vertical plane, U > 0 at 45 degrees counter-clockwise from it as "
    "the observer sees it; dolp is the degree of Y, aolp its angle in degrees from the vertical"
)
_ROWS_AT_A_TIME, _ROWS_WORTH_A_BAR = 64, 1000


@dataclass(frozen=True)
class SkyPlan:
    """The sky of a project, and its projection onto pixels.

    Attributes:
        project: place and settings; its hour is ignored.
        size: edge of a cube's face, height of another picture, in pixels.
        height_m: of the observer above the place.
        turned_deg: the azimuth in the map's middle, clockwise of true north; of a cube, of the
            scene's -Z axis.
        sun_disc: whether the disc is in the picture.
        stars: whether stars, planets and the moon are.
        stokes: whether Q, U, degree and angle of polarisation are written.
        bits: of a PNG's channels.
        sidecar: whether a JSON file beside the picture repeats its metadata.
        bar: whether a large picture shows a progress bar.
    """

    project: Project
    projection: Projection = "lat-long"
    size: int = 512
    height_m: float = 0.0
    turned_deg: float = 0.0
    sun_disc: bool = False
    stars: bool = False
    stokes: bool = False
    bits: Bits = 8
    sidecar: bool = False
    bar: bool = False

    @property
    def axes_project(self) -> Project:
        """The project in whose world axes light is computed: a turned cube has its own."""
        if self.projection != "cube":
            return self.project
        turned = self.project.north_offset_deg + self.turned_deg
        return msgspec.structs.replace(
            self.project, north_offset_deg=(turned + 180.0) % 360.0 - 180.0
        )

    @property
    def sky_map(self) -> SkyMap:
        """The projection, in world axes."""
        if self.projection == "cube":
            return CubeFaces(self.size)
        seen_offset_rad = radians(self.project.north_offset_deg - self.turned_deg)
        kind = LatLongMap if self.projection == "lat-long" else FisheyeMap
        return kind(self.size, seen_offset_rad)

    @property
    def cube_size(self) -> int | None:
        """A cube whose texels are no wider than a pixel; None where a tolerance is named."""
        if self.projection == "cube":
            return self.size
        if self.project.tolerance is not None:
            return None
        return int(2 ** np.ceil(np.log2(max(64, self.size))))

    def open(self) -> "SkyStudio":
        """A kernel with place and settings, ready for any hour.

        Raises:
            UserError: the project has an invalid value.
        """
        kernel = open_kernel()
        faults = FaultCollector(kernel)
        place, _ = daylight_inputs(self.axes_project)
        eye = MoveCamera(eye_m=(0.0, self.height_m, 0.0), target_m=(0.0, self.height_m, -1.0))
        for message in [*setting_inputs(self.project, kernel), place, eye]:
            kernel.inject(message)
        demand_light(kernel, "sky command", self.cube_size)
        if self.stars:
            for kind in (StarsChanged, MoonDiscChanged):
                kernel.inject(Demand(consumer="sky command", message=kind.__name__))
        if self.stokes:
            name = SkyPolarisationChanged.__name__
            kernel.inject(Demand(consumer="sky command", message=name, size=_POLARISED_SIZE))
        kernel.pump_until_idle()
        faults.raise_first()
        return SkyStudio(self, kernel, faults)


class SkyStudio:
    """A `Studio` for one sky."""

    def __init__(self, plan: SkyPlan, kernel: Kernel, faults: FaultCollector):
        self._plan, self._kernel, self._faults = plan, kernel, faults
        self._used = False

    def shoot(self, instant: datetime) -> "SkyShot":
        """The sky of an instant."""
        if self._used:
            # Small moves of the sun are skipped as invisible, so that it moves far away first.
            self._move_clock(other_side(instant))
        self._used = True
        self._move_clock(instant)
        require_sky(self._kernel)
        light = self._kernel.last(SkyLightChanged)
        if light is None:
            raise ModuleFailed("no module makes sunlight: see `vrut-lite modules`")
        background, sun = light.background, light.key_light
        # Without GL no GPU job runs, so the cube is an array.
        assert isinstance(background.cube, Array)
        cube = decode_float16(background.cube.values, background.radiance_scale)
        plan = self._plan
        directions, solid_angle = plan.sky_map.directions(), plan.sky_map.solid_angles()
        if plan.projection == "cube":
            radiance = cube
        else:
            # Black outside a fisheye's circle.
            radiance = _sampled(cube, directions, plan.bar) * (solid_angle > 0.0)[..., None]
        level = solid_angle * np.maximum(directions[..., 1], 0.0)
        facts = {
            **picture_metadata(at_instant(plan.axes_project, instant), self._kernel),
            **_map_metadata(plan, sun),
            "skyHorizontalIrradianceRgb": vector_text(np.tensordot(level, radiance, level.ndim)),
        }
        seen_rgb = background.seen_sun_irradiance_rgb or sun.irradiance_rgb
        facts["sunIrradianceRgb"] = vector_text(seen_rgb)
        moon = self._kernel.last(MoonDiscChanged) if plan.stars else None
        if plan.sun_disc and not (moon is not None and sun.body == "moon"):
            radiance = radiance + disc_radiance(
                plan.sky_map, sun.direction, seen_rgb, sun.angular_radius_rad,
                sun.limb_darkening_rgb,
            )  # fmt: skip
        if plan.stars:
            radiance = radiance + self._points()
        if not plan.stokes:
            return SkyShot(radiance, facts, plan)
        q, u = self._q_and_u(light, directions, radiance)
        facts["polarisation"] = _CONVENTION
        return SkyShot(radiance, facts, plan, (q, u))

    def _q_and_u(
        self, light: SkyLightChanged, directions: FloatArray, radiance: Float32Array
    ) -> tuple[Float32Array, Float32Array]:
        """Q and U (..., 3) by the vertical planes of the views, together at most the radiance.

        Raises:
            UserError: the sky knows no polarisation.
        """
        found = light.polarisation
        if found is None or found.cube is None:
            name = light.background.source
            raise UserError(
                f"{name} knows no polarisation here: --stokes needs a sky that knows it (--sky), "
                "and a height of 20 km at most"
            )
        cubes = decode_float16(found.cube.values, found.radiance_scale)
        of_q, of_u = (sample_sky(cube, directions) for cube in cubes)
        axes = map_axis(directions), vertical_axis(directions)
        q, u = turned(of_q, of_u, directions, *axes)
        length = np.hypot(q, u)
        most = np.minimum(length, np.maximum(radiance, 0.0))
        share = np.divide(most, length, out=np.zeros_like(length), where=length > 0.0)
        return (share * q).astype(np.float32), (share * u).astype(np.float32)

    def _points(self) -> NDArray[np.float32]:
        """Radiance of stars, planets and the moon; black where no module posts them."""
        sky_map = self._plan.sky_map
        stars, moon = self._kernel.last(StarsChanged), self._kernel.last(MoonDiscChanged)
        nothing = np.zeros((0, 3))
        found = [(nothing, nothing)]
        if stars is not None:
            found.append((stars.direction.values, stars.irradiance_rgb.values))
        if moon is not None:
            found.append(moon_samples(moon))
        directions, energy = (np.concatenate(parts) for parts in zip(*found, strict=True))
        return points_radiance(sky_map, directions, energy)

    def close(self) -> None:
        """End background jobs."""
        self._kernel.close()

    def _move_clock(self, instant: datetime) -> None:
        self._kernel.inject(SetClock(instant=instant))
        self._kernel.pump_until_idle()
        self._faults.raise_first()


@dataclass(frozen=True)
class SkyShot:
    """Radiance in the plan's projection, (h, w, 3) or a cube's (6, n, n, 3); Q and U likewise."""

    radiance: NDArray[np.float32]
    metadata: Metadata
    plan: SkyPlan
    q_and_u: tuple[Float32Array, Float32Array] | None = None

    @property
    def caption(self) -> str:
        """The hour and the sun."""
        return hour_text(self.metadata)

    @property
    def notices(self) -> tuple[str, ...]:
        """A sky is whole."""
        return ()

    def write(self, path: Path) -> None:
        """Write the picture, and its sidecar if asked for."""
        suffix, radiance = path.suffix.lower(), self.radiance
        if suffix == ".npz":
            name = "cube" if radiance.ndim == 4 else "radiance"
            write_npz(path, {name: radiance, **self._polarised()}, self.metadata)
        else:
            flat = unfold_cube(radiance) if radiance.ndim == 4 else radiance
            if suffix == ".exr":
                write_exr(path, flat, self.metadata, self._channels())
            elif suffix == ".hdr":
                write_hdr(path, flat, self.metadata)
            else:
                display = display_picture(flat, bits=self.plan.bits, inside=self._inside())
                write_png(path, display, self.metadata)
        if self.plan.sidecar:
            write_json(sidecar_of(path), json_values(self.metadata))

    def _polarised(self) -> dict[str, NDArray]:
        """Q and U as the radiance, degree and angle (degrees) of their luminance without the last
        axis, by name; empty without them."""
        if self.q_and_u is None:
            return {}
        q, u = self.q_and_u
        degree, angle = degree_and_angle(*map(luminance, (self.radiance, q, u)))
        return {
            "q": q,
            "u": u,
            "dolp": degree.astype(np.float32),
            "aolp": np.degrees(angle).astype(np.float32),
        }

    def _channels(self) -> dict[str, NDArray]:
        """The same, flat, as channels (h, w) of an EXR."""
        channels = {}
        for name, values in self._polarised().items():
            letters = "RGB" if name in ("q", "u") else ""
            parts = values if letters else values[..., None]
            flat = unfold_cube(parts) if self.radiance.ndim == 4 else parts
            for number, letter in enumerate(letters or " "):
                channels[f"{name.upper()}.{letter}" if letters else name] = flat[..., number]
        return channels

    def _inside(self) -> NDArray[np.bool_]:
        """Which pixels (h, w) of the flat picture show a direction: space is black too."""
        angles = self.plan.sky_map.solid_angles()
        flat: NDArray[np.floating] = angles
        if angles.ndim == 3:
            flat = unfold_cube(angles[..., None])[..., 0]
        return flat > 0.0


def sidecar_of(picture: Path) -> Path:
    """The JSON file with a picture's metadata."""
    return picture.with_name(picture.name + ".json")


def _sampled(
    cube: NDArray[np.float32], directions: NDArray[np.float64], bar: bool
) -> NDArray[np.float32]:
    """The cube map at directions (h, w, 3), some rows at a time to save memory."""
    picture = np.empty(directions.shape, np.float32)
    starts: Iterable[int] = range(0, len(directions), _ROWS_AT_A_TIME)
    if bar and len(directions) >= _ROWS_WORTH_A_BAR:
        starts = tracked(starts, "drawing")
    for start in starts:
        rows = slice(start, start + _ROWS_AT_A_TIME)
        picture[rows] = sample_sky(cube, directions[rows])
    return picture


def _map_metadata(plan: SkyPlan, sun: KeyLightChanged) -> dict[str, str | float]:
    """Orientation of the map and position of its sun, for programs that light with it."""
    facts: dict[str, str | float] = {
        "projection": plan.projection,
        "observerHeightM": plan.height_m,
        "sunDisc": "in the picture" if plan.sun_disc else "not in the picture",
        "sunAngularRadiusDeg": degrees(sun.angular_radius_rad),
    }
    sky_map = plan.sky_map
    if isinstance(sky_map, LatLongMap | FisheyeMap):
        direction = np.asarray(sun.direction)
        true = enu_from_world(direction, radians(plan.project.north_offset_deg))
        row, column = sky_map.position(direction)
        facts["middleAzimuthDeg"] = plan.turned_deg
        facts["sunDirectionInMap"] = vector_text(world_from_enu(true, radians(plan.turned_deg)))
        facts["sunPixel"] = vector_text([float(column) + 0.5, float(row) + 0.5])
    return facts
