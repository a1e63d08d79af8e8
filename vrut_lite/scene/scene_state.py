"""The state of the scene that backends draw, as one frozen value."""

from dataclasses import dataclass, field, fields, replace
from functools import cached_property
from types import MappingProxyType
from typing import Any, Literal, Self, TypeVar

import numpy as np

from vrut_lite.geometry.colour import luminance
from vrut_lite.geometry.spherical_harmonics import evaluate_irradiance
from vrut_lite.installed_parts import PartsHeard, finishes_still, shown_by_parts
from vrut_lite.kernel.messages import Derived
from vrut_lite.messages.camera import MoveCamera, frame_bounds
from vrut_lite.messages.picture import SetExposure
from vrut_lite.messages.scene import SceneOpened
from vrut_lite.messages.section import Section
from vrut_lite.messages.sky import AmbientChanged, BackgroundChanged, SkyPolarisationChanged
from vrut_lite.messages.sky_light import SkyLightChanged
from vrut_lite.messages.sun import KeyLightChanged
from vrut_lite.messages.tolerance import DEFAULT_TOLERANCE
from vrut_lite.numeric_types import Vector
from vrut_lite.sky.ground_albedo import ground_albedo

D = TypeVar("D", bound=Derived)
NO_PARTS: PartsHeard = MappingProxyType({})
Shown = Literal["picture", "illuminance", "texels", "noise"]
# Albedo of the ground disc before the first light, from which it is derived.
_UNLIT_GROUND_ALBEDO = (0.1, 0.1, 0.1)


@dataclass(frozen=True)
class FrameSkips:
    """Work that a frame skips where True; the picture does not change.

    Attributes:
        meshes: meshes outside the view.
        sky: samples of the sky that meshes cover.
        shadow: the shadow map when the sun is down, or neither scene nor sun have changed.
        unlit: filtering a sky that reaches no visible surface, by the part that lights surfaces.
        reflection: filtering a sky without a visible change, or that no visible surface mirrors.
    """

    meshes: bool = True
    sky: bool = True
    shadow: bool = True
    unlit: bool = True
    reflection: bool = True


@dataclass(frozen=True, eq=False)
class SceneState:
    """Geometry, light, camera and all else that a backend draws.

    Parts are replaced, never changed: a backend uploads only parts that are other objects than
    before.

    Attributes:
        background, key_light, ambient: of the clear sky; None before the first message.
        sky_light: of the clear sky and its layers; what lights the scene. None before the first
            of each of these messages.
        parts: what each frame part shows that is switched on: its latest messages, by type.
        polarisation: of the clear sky; None where neither a polariser nor a surface needs it.
        polariser_deg: angle of the polariser before the camera, counter-clockwise from the
            picture's vertical; None without one.
        ground_albedo_rgb: of the ground disc, linear.
        moved_camera: where the user looks from; None for the scene's own or the framing camera.
        size_px: the picture's width and height.
        light_shafts: whether the scene shades the air.
        section: what cuts the picture, not the light; None where nothing does.
        shows: the picture, or values of surfaces in false colours.
        tolerance: share by which radiance may be off.
    """

    scene: SceneOpened | None = None
    background: BackgroundChanged | None = None
    key_light: KeyLightChanged | None = None
    ambient: AmbientChanged | None = None
    sky_light: SkyLightChanged | None = None
    polarisation: SkyPolarisationChanged | None = None
    polariser_deg: float | None = None
    parts: PartsHeard = field(default_factory=lambda: NO_PARTS)
    ground_albedo_rgb: Vector = _UNLIT_GROUND_ALBEDO
    moved_camera: MoveCamera | None = None
    size_px: tuple[int, int] = (960, 540)
    exposure: SetExposure = field(default_factory=SetExposure)
    light_shafts: bool = False
    section: Section | None = None
    shows: Shown = "picture"
    tolerance: float = DEFAULT_TOLERANCE
    skips: FrameSkips = field(default_factory=FrameSkips)

    @property
    def aspect(self) -> float:
        """Width over height of the picture."""
        return self.size_px[0] / self.size_px[1]

    @cached_property
    def camera(self) -> MoveCamera | None:
        """The present camera: the user's, the scene's own, or one that frames the scene."""
        if self.moved_camera is not None or self.scene is None:
            return self.moved_camera
        return self.scene.camera or frame_bounds(
            self.scene.lower_m, self.scene.upper_m, self.aspect
        )

    @cached_property
    def white_card(self) -> float:
        """Luminance (W m^-2 sr^-1) of white matter turned to the key light, in the open sky.

        0 before the first light.
        """
        if self.sky_light is None:
            return 0.0
        key_light, ambient = self.sky_light.key_light, self.sky_light.ambient
        sky_rgb = evaluate_irradiance(ambient.irradiance_sh_rgb.values, (0.0, 1.0, 0.0))
        return float(luminance(np.maximum(sky_rgb, 0.0) + key_light.irradiance_rgb)) / np.pi

    @property
    def shows_map(self) -> bool:
        """Whether values of a frame part's map are shown, to which no light may come."""
        return self.shows in ("texels", "noise")

    @property
    def has_finished_light(self) -> bool:
        """Whether a frame part has the light of a finished still of this view."""
        camera = self.camera
        return camera is not None and finishes_still(self.parts, camera, self.size_px)

    def shown(self, kind: type[D]) -> D | None:
        """The latest message of a type that frame parts hear, or None."""
        return shown_by_parts(self.parts, kind)

    @property
    def missing(self) -> tuple[str, ...]:
        """Names of the parts that a picture still lacks."""
        needed = ("scene", "background", "key_light", "ambient", "camera")
        return tuple(name for name in needed if getattr(self, name) is None)

    def shares_all_but(self, other: Self, *names: str) -> bool:
        """Whether all parts but these are those of another state."""
        kept = (part.name for part in fields(self) if part.name not in ("size_px", *names))
        return self.size_px == other.size_px and all(
            getattr(self, name) is getattr(other, name) for name in kept
        )

    def check_drawable(self) -> None:
        """Raise RuntimeError that names what a picture still lacks, if anything."""
        if self.missing:
            names = (name.replace("_", " ") for name in self.missing)
            raise RuntimeError(f"nothing to draw yet: no {', no '.join(names)}")

    def with_light(self, **light: Any) -> Self:
        """The state with other `background`, `key_light` or `ambient`, and the ground in it.

        Its `sky_light` is the clear sky's, until the sum with layers is known.
        """
        lit = replace(self, **light)
        if lit.background is None or lit.key_light is None or lit.ambient is None:
            return lit
        albedo = ground_albedo(lit.background, lit.key_light, lit.ambient)
        return replace(lit.under_clear_sky(), ground_albedo_rgb=albedo)

    def under_clear_sky(self) -> Self:
        """The state lit by its `background`, `key_light` and `ambient`, all of them known."""
        assert self.background is not None
        assert self.key_light is not None
        assert self.ambient is not None
        light = SkyLightChanged(
            background=self.background,
            key_light=self.key_light,
            ambient=self.ambient,
            polarisation=self.polarisation,
            source=self.background.source,
        )
        return replace(self, sky_light=light)
