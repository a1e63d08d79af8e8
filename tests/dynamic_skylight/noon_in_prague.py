"""DynamicSkyLight on a kernel, with its own sun: a summer noon in Prague."""

from datetime import UTC, datetime, timedelta

from dynamic_skylight.module import DynamicSkyLight

from vrut_lite.kernel.messages import ChooseSlot, SetClock
from vrut_lite.messages.place import SetPlace
from vrut_lite.testing.sky_on_bus import SkyOnBus

NOON = datetime(2026, 6, 21, 11, 0, tzinfo=UTC)
PRAGUE = SetPlace(latitude_deg=50.0755, longitude_deg=14.4378, altitude_m=235.0)


def clock(seconds=0.0):
    """The clock so many seconds after noon."""
    return SetClock(instant=NOON + timedelta(seconds=seconds))


def sky_with_its_sun(**settings):
    """The module, which holds both slots, before it knows hour and place."""
    sky = SkyOnBus(DynamicSkyLight, **settings)
    sky.tell(ChooseSlot(slot="sun", module="dynamic_skylight"))
    return sky
