"""The complete light of the sky: the clear sky's, changed by the layers before it."""

from vrut_lite import checks
from vrut_lite.daylight.sky import AmbientChanged, BackgroundChanged, SkyRadianceChanged
from vrut_lite.daylight.sun import KeyLightChanged
from vrut_lite.kernel.messages import Derived

# The parts of the clear sky's light.
LIGHT = (BackgroundChanged, KeyLightChanged, AmbientChanged)


class SkyLightChanged(Derived, frozen=True, kw_only=True):
    """All light of the sky: the one message for consumers that light with it.

    The holder of the slot `sky` posts the clear sky; layers (clouds) absorb and add light; `layers`
    names them. Without layers the parts are the clear sky's own messages.

    Attributes:
        background: the sky from the eye's height, for display. With layers its cube is an array,
            it has no `view`, and `seen_sun_irradiance_rgb` is the sun's irradiance at the eye
            behind the layers.
        key_light: its irradiance behind the layers, the mean over the scene.
        ambient: irradiance by sky, layers and ground, at the ground.
        radiance: of the sky that lights the scene, seen from the ground in its middle. Without
            layers it is None unless a consumer demands `SkyRadianceChanged`.
        layers: names of the layers.
        source: the module that posts it.
    """

    background: BackgroundChanged
    key_light: KeyLightChanged
    ambient: AmbientChanged
    radiance: SkyRadianceChanged | None = None
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
        if self.radiance is not None:
            self.radiance.check()
        checks.instance(self, "layers", tuple)
        checks.text(self, "source")

    def check_arrays(self) -> None:
        """Light, which is finite."""
        self.background.check_arrays()
        self.ambient.check_arrays()
        if self.radiance is not None:
            self.radiance.check_arrays()
