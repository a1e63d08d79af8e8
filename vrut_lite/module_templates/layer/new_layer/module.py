"""The module: posts the rainbow of the sun that the sky shows."""

from typing import Annotated

import msgspec
from vrut_lite.kernel.messages import SlotChanged
from vrut_lite.kernel.module import Link, Manifest, Module, handles
from vrut_lite.kernel.settings import setting
from vrut_lite.messages.sun import KeyLightChanged
from vrut_lite.numeric_types import vector

from new_layer.bow import SLOT, RainbowShown


class NewLayerSettings(msgspec.Struct, frozen=True):
    """Options of the command line and rows of the panel; each field has a default."""

    rain: Annotated[float, setting("Cross-section of the drops on a line of sight", 0, 2)] = 0.0


class NewLayer(Module):
    """Posts `RainbowShown` for the frame part."""

    manifest = Manifest(
        name="new_layer",
        title="New layer",
        version="0.1.0",
        provides=(SLOT,),
    )
    speaks = (RainbowShown,)
    settings_type = NewLayerSettings
    settings: NewLayerSettings

    def __init__(self, link: Link, settings: NewLayerSettings):
        super().__init__(link, settings)
        self._shown: RainbowShown | None = None

    @handles(KeyLightChanged, SlotChanged)
    def light_changed(self, _message: KeyLightChanged | SlotChanged) -> None:
        """Another sun; or the slot came or went."""
        self._update()

    def settings_changed(self, name: str) -> None:
        """More rain, or less."""
        self._update()

    def _update(self) -> None:
        # The light is demanded only while it rains.
        self.link.demand(KeyLightChanged, None if self.settings.rain > 0.0 else 0)
        if not self.link.holds(SLOT):
            # The scene has dropped the rainbow: it is posted again with the slot.
            self._shown = None
            return
        light = self.link.last(KeyLightChanged)
        if light is None:
            return
        shines = light.direction[1] > 0.0
        amount = self.settings.rain if shines else 0.0
        x, y, z = light.direction
        shown = RainbowShown(
            antisolar=(-x, -y, -z),
            light_rgb=vector([amount * channel for channel in light.irradiance_rgb]),
        )
        if shown != self._shown:
            self._shown = shown
            self.link.post(shown)
