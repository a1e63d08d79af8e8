"""Settings of light transport that are off unless a test says otherwise."""

from typing import Annotated

from light_transport.settings import LightTransportSettings

from vrut_lite.kernel.settings import setting


class OpenSkySettings(LightTransportSettings, frozen=True):
    """The module's own settings, switched off."""

    on: Annotated[bool, setting("Whether things hide the sky and send light to each other")] = False
