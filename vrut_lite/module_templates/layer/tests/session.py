"""The recorded session: `python tests/session.py` records it again after a change of its script."""

from collections.abc import Iterable
from pathlib import Path

from vrut_lite.kernel.bus import Kernel
from vrut_lite.kernel.messages import Input, SetSetting
from vrut_lite.kernel.module import Manifest, Module, handles
from vrut_lite.messages.haze import haze_of
from vrut_lite.messages.place import SetPlace
from vrut_lite.messages.sun import KeyLightChanged, SunMoved
from vrut_lite.numeric_types import vector
from vrut_lite.recording.recorder import Recorder
from vrut_lite.recording.replay_runner import ReplayRunner
from vrut_lite.sky.clear_sun import sun_irradiance_rgb
from vrut_lite.testing.sky_on_bus import SunAndEye

from new_layer.module import NewLayer

JOURNAL = Path(__file__).parent / "session.mcap"


class SunInClearAir(Module):
    """The key light of a clear sky, and nothing else of it."""

    manifest = Manifest(
        name="sun_in_clear_air",
        title="Sun in clear air",
        version="1",
        provides=("sky",),
        requires=("sun",),
    )

    @handles(SunMoved)
    def sun_moved(self, sun: SunMoved) -> None:
        rgb = sun_irradiance_rgb(haze_of(self.link), sun.apparent_elevation_rad)
        self.link.post(
            KeyLightChanged(
                direction=sun.direction,
                irradiance_rgb=vector(rgb.clip(0.0) * sun.visible_disc_fraction),
                angular_radius_rad=0.004675,
                limb_darkening_rgb=((1.0,),) * 3,
                source="sun_in_clear_air",
            )
        )


# The layer, and a sun that is placed by hand: updates of other modules leave the journal alone.
MODULES = (SunAndEye, SunInClearAir, NewLayer)


def open_kernel() -> Kernel:
    """A kernel with these modules."""
    kernel = Kernel(runner=ReplayRunner())
    for module in MODULES:
        kernel.add_module(module)
    return kernel


def play(kernel: Kernel, script: Iterable[Input]) -> None:
    """One input after another."""
    for message in script:
        kernel.inject(message)
        kernel.pump_until_idle()


def sun_at(elevation_deg: float) -> Input:
    """SunAndEye: the latitude is the sun's elevation, the longitude its azimuth."""
    return SetPlace(latitude_deg=elevation_deg, longitude_deg=90.0)


def rain(amount: float) -> Input:
    """The module's setting."""
    return SetSetting(module="new_layer", name="rain", value=amount)


def record(path: Path = JOURNAL) -> None:
    """A shower in the morning."""
    kernel = open_kernel()
    with path.open("wb") as stream:
        recorder = Recorder(kernel, stream)
        play(kernel, [sun_at(10.0), rain(0.5), sun_at(20.0), rain(0.1), sun_at(-5.0), rain(0.0)])
        recorder.close()
    kernel.close()


if __name__ == "__main__":
    record()
