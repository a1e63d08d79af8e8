"""Light transport that is off unless a test says otherwise, for tests that show no pictures."""

from typing import Annotated

import pytest
from light_transport.module import LightTransport
from light_transport.settings import LightTransportSettings

from vrut_lite.kernel.settings import setting


class OpenSkySettings(LightTransportSettings, frozen=True):
    """The module's own settings, switched off."""

    on: Annotated[bool, setting("Whether things hide the sky and send light to each other")] = False


@pytest.fixture(autouse=True, scope="module")
def lit_by_the_open_sky(request):
    """A light map takes seconds: scenes go without it, but for those of pictures in the window.

    A module's own fixtures that open a window or a host come after this one.
    """
    if request.path.parent.name == "view":
        yield
        return
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(LightTransport, "settings_type", OpenSkySettings)
        yield
