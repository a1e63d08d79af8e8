"""The complete light of the sky: the clear sky's, changed by the layers before it."""

from vrut_lite import checks
from vrut_lite.array import Array
from vrut_lite.kernel.messages import Derived
from vrut_lite.messages.limits import MOST_LIGHT
from vrut_lite.messages.sky import (
    AmbientChanged,
    BackgroundChanged,
    SkyPolarisationChanged,
    SkyRadianceChanged,
)
from vrut_lite.messages.sun import KeyLightChanged

# The parts of the clear sky's light.
LIGHT = (BackgroundChanged, KeyLightChanged, AmbientChanged)


class SkyGlowAdded(Derived, frozen=True, kw_only=True):
    """Light that a module adds to the clear sky, above its clouds.

    Attributes:
        glow_rgb: radiance (rows, columns, 3) float32 of the upper hemisphere, laid out as
            `NightLightChanged.glow_rgb`; None to add no more.
        of_slot: a slot that the module holds; the glow is dropped when the slot has no holder.
        source: the module.
    """

    glow_rgb: Array | None
    of_slot: str
    source: str

    def key(self) -> str:
        """Glows of several modules wait side by side."""
        return self.source

    def check(self) -> None:
        """A map of the hemisphere."""
        if self.glow_rgb is not None:
            checks.arrays(self, {"glow_rgb": ("<f4", ("rows", "columns", 3))})
        checks.text(self, "of_slot", "source")

    def check_arrays(self) -> None:
        """Radiance, which is finite."""
        if self.glow_rgb is not None:
            checks.contents(self, "glow_rgb", 0.0, MOST_LIGHT)


class SkyLightChanged(Derived, frozen=True, kw_only=True):
    """All light of the sky: the one message for consumers that light with it.

    The holder of the slot `sky` posts the clear sky; layers (glows, clouds) absorb and add light;
    `layers` names them. Without layers the parts are the clear sky's own messages.

    Attributes:
        background: the sky from the eye's height, for display. With layers it has no `view`,
            `seen_sun_irradiance_rgb` is the sun's irradiance at the eye behind the layers, and the
            cube is an array where a demand names its encoding; else it may be a card's texture of
            the sky as seen from the ground.
        key_light: its irradiance behind the layers, the mean over the scene.
        ambient: irradiance by sky, layers and ground, at the ground.
        radiance: of the sky that lights the scene, seen from the ground in its middle. Without
            layers it is None unless a consumer demands `SkyRadianceChanged`.
        polarisation: of the background, behind the layers; glows and layers add unpolarised light.
            None unless a consumer demands `SkyPolarisationChanged`.
        layers: names of the layers.
        source: the module that posts it.
    """

    background: BackgroundChanged
    key_light: KeyLightChanged
    ambient: AmbientChanged
    radiance: SkyRadianceChanged | None = None
    polarisation: SkyPolarisationChanged | None = None
    layers: tuple[str, ...] = ()
    source: str

    @property
    def lighting(self) -> BackgroundChanged | SkyRadianceChanged:
        """The sky that lights the scene: `radiance`, or else the background."""
        return self.background if self.radiance is None else self.radiance

    def check(self) -> None:
        """Check the parts."""
        parts = (
            ("background", BackgroundChanged),
            ("key_light", KeyLightChanged),
            ("ambient", AmbientChanged),
        )
        for name, kind in parts:
            checks.instance(self, name, kind)
            getattr(self, name).check()
        checks.instance(self, "radiance", (SkyRadianceChanged, type(None)))
        checks.instance(self, "polarisation", (SkyPolarisationChanged, type(None)))
        for part in (self.radiance, self.polarisation):
            if part is not None:
                part.check()
        checks.instance(self, "layers", tuple)
        checks.text(self, "source")

    def check_arrays(self) -> None:
        """Light, which is finite."""
        self.background.check_arrays()
        self.ambient.check_arrays()
        for part in (self.radiance, self.polarisation):
            if part is not None:
                part.check_arrays()
