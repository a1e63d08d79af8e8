"""The clouds of a project's instant, frozen."""

from typing import NamedTuple

from vrut_lite.messages.clouds import CloudsChanged
from vrut_lite.messages.sky_light import SkyLightChanged
from vrut_lite.messages.sun import KeyLightChanged
from vrut_lite.numeric_types import FloatArray
from vrut_lite.sky.sky_layer import SkyLayer, Viewpoint


class FrozenClouds(NamedTuple):
    """A layer before the sky with its message, the scene's place under it, and a key light whose
    haze is the air's."""

    layer: SkyLayer
    message: CloudsChanged
    view: Viewpoint
    key_light: KeyLightChanged

    def light_under(self, clear: SkyLightChanged, size: int) -> SkyLightChanged:
        """The light of a clear sky behind the clouds, in cube maps of about `size` texels."""
        return self.layer.light_under(self.message, clear, self.view, size, "share")

    def transmittance(self, direction: FloatArray) -> FloatArray:
        """T (n,) in unit directions (n, 3)."""
        found = self.layer.transmittance(self.message, direction, self.view.middle_m)
        assert found is not None
        return found
