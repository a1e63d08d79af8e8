"""The light that reaches the scene: the clear sky's and what layers before it make of it."""

from vrut_lite import checks
from vrut_lite.daylight.sky import AmbientChanged, BackgroundChanged, SkyRadianceChanged
from vrut_lite.daylight.sun import KeyLightChanged
from vrut_lite.kernel.messages import Derived

# The parts of the clear sky's light.
LIGHT = (BackgroundChanged, KeyLightChanged, AmbientChanged)


class SkyLightChanged(Derived, frozen=True, kw_only=True):
    """The sum of all that shines from the sky: who lights with the sky hears this.

    The holder of the slot `sky` says the clear sky; layers (clouds) take from its light and add
    their own; `layers` names them. Without any the parts are the very messages of the clear sky,
    and `radiance` is left to who demands `SkyRadianceChanged`. With layers they are

    * `radiance`: what lights the scene, seen from the ground in its middle;
    * `background`: the same from the eye's height, for who shows it. The cube is an array; there is
      no `view`. `seen_sun_irradiance_rgb` is what passes the layers to the eye;
    * `key_light`: its irradiance is what passes the layers, in the mean over the scene;
    * `ambient`: irradiance by sky, layers and ground, at the ground.
    """

    background: BackgroundChanged
    key_light: KeyLightChanged
    ambient: AmbientChanged
    radiance: SkyRadianceChanged | None = None
    layers: tuple[str, ...] = ()
    source: str

    def check(self) -> None:
        """What the parts say of themselves."""
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
