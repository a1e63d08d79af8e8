"""The recorded session: `python tests/session.py` records it again after a change of its script."""

from pathlib import Path

from vrut_lite.kernel.bus import Kernel
from vrut_lite.kernel.messages import ChooseSlot, Demand, SetSetting
from vrut_lite.messages.place import SetPlace
from vrut_lite.recording.recorder import Recorder
from vrut_lite.recording.replay_runner import ReplayRunner
from vrut_lite.sky.sky_module import PRODUCTS
from vrut_lite.testing.sky_on_bus import SunAndEye

from new_sky.module import NewSky

JOURNAL = Path(__file__).parent / "session.mcap"
# The sky and a sun that is placed by hand: updates of other modules leave the journal alone.
MODULES = (SunAndEye, NewSky)


def record(path: Path = JOURNAL) -> None:
    """A morning, and brighter clouds."""
    kernel = Kernel(runner=ReplayRunner())
    for module in MODULES:
        kernel.add_module(module)
    script = [
        ChooseSlot(slot="sky", module="new_sky"),
        *(Demand(consumer="test", message=kind.__name__, size=8) for kind in PRODUCTS),
        # SunAndEye: the latitude is the sun's elevation, the longitude its azimuth.
        *(SetPlace(latitude_deg=float(e), longitude_deg=90.0) for e in (-8, -2, 5, 30)),
        SetSetting(module="new_sky", name="cloud_light", value=2.0),
    ]
    with path.open("wb") as stream:
        recorder = Recorder(kernel, stream)
        for message in script:
            kernel.inject(message)
            kernel.pump_until_idle()
        recorder.close()
    kernel.close()


if __name__ == "__main__":
    record()
