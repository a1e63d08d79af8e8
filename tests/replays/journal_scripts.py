"""The sessions behind the journals of this folder; run as a program it records them anew.

`pytest --update-journals` is enough when modules say something else to the same inputs; this
program is for a script that changed:

    python tests/replays/journal_scripts.py
"""

from datetime import UTC, datetime, timedelta
from pathlib import Path

from vrut_lite.discovery import discover
from vrut_lite.kernel.bus import Kernel
from vrut_lite.kernel.messages import (
    ChooseSlot,
    ClockMoved,
    Demand,
    JobResult,
    RestartModule,
    SetClock,
    SetClockRate,
    SetSetting,
    Tick,
)
from vrut_lite.kernel.module import Manifest, Module, handles
from vrut_lite.messages.gpu_job import GpuJob
from vrut_lite.messages.gpu_texture import GpuTexture
from vrut_lite.messages.place import SetPlace
from vrut_lite.messages.renderer import RendererTried
from vrut_lite.messages.sky import AmbientChanged, BackgroundChanged
from vrut_lite.messages.sun import KeyLightChanged, SunMoved
from vrut_lite.recording.recorder import Recorder
from vrut_lite.sky.sky_sum import SkySum
from vrut_lite.write_atomic import atomic_output

HERE = Path(__file__).parent
NOON = datetime(2026, 6, 21, 11, tzinfo=UTC)
PRAGUE = SetPlace(latitude_deg=50.0755, longitude_deg=14.4378, altitude_m=200.0)
CUBE_SIZE = 8
LIGHT = (BackgroundChanged, KeyLightChanged, AmbientChanged)
WITH_FAILING_SUN = ("module_failing", "slots_switched")
WITH_SUM = ("clouds_on_card",)


class FailingSun(Module):
    """Holds the sun and fails each afternoon; the third time suspends it."""

    manifest = Manifest(name="failing_sun", title="Failing sun", version="1", provides=("sun",))

    @handles(ClockMoved)
    def on_clock(self, message):
        if message.instant > NOON:
            raise ArithmeticError(f"no sun after noon at {message.instant:%H:%M}")
        if self.link.holds("sun"):
            self.link.post(
                SunMoved(
                    direction=(0.0, 0.6, 0.8),
                    azimuth_rad=3.141592653589793,
                    elevation_rad=0.6435011087932844,
                    apparent_elevation_rad=0.6435011087932844,
                    visible_disc_fraction=1.0,
                )
            )


def modules(script):
    """The modules of a script, in load order."""
    more = [FailingSun] if script in WITH_FAILING_SUN else []
    return [*discover()[0], *more, *([SkySum] if script in WITH_SUM else [])]


def kernel_of(script):
    kernel = Kernel()
    for module in modules(script):
        kernel.add_module(module)
    return kernel


def demands(size=CUBE_SIZE):
    return [Demand(consumer="test", message=kind.__name__, size=size) for kind in LIGHT]


def clock(hours):
    """The clock's input, so many hours after noon."""
    return SetClock(instant=NOON + timedelta(hours=hours))


def setting(name, value, module="dynamic_skylight"):
    return SetSetting(module=module, name=name, value=value)


def sky_on_gpu():
    """A session whose GPU is played by this function: jobs are answered by their recipes."""
    kernel, jobs, inputs = kernel_of("sky_on_gpu"), [], []
    kernel.tap(lambda message, _: jobs.append(message) if isinstance(message, GpuJob) else None)

    def give(*messages):
        for message in messages:
            inputs.append(message)
            kernel.inject(message)
            kernel.pump_until_idle()

    give(*START, Demand(consumer="gpu", message="GpuJob"), setting("cube_device", "gpu"))
    give(done(jobs[0]), clock(2), clock(4))
    give(done(jobs[2]), done(jobs[1]))  # The earlier one comes too late.
    give(clock(9))  # Twilight is another program.
    give(done(jobs[3]), clock(0))
    give(failed(jobs[4]), clock(1))  # From here on the CPU serves.
    give(setting("cube_device", "cpu"), setting("cube_device", "gpu"))
    give(done(jobs[5]))
    kernel.close()
    return inputs


def sky_on_card():
    """A session with a card, by the setting "auto": both skies are GPU jobs, answered here."""
    kernel, jobs, inputs = kernel_of("sky_on_card"), [], []
    kernel.tap(lambda message, _: jobs.append(message) if isinstance(message, GpuJob) else None)

    def give(*messages):
        for message in messages:
            inputs.append(message)
            kernel.inject(message)
            kernel.pump_until_idle()

    give(*START)
    give(RendererTried(renderer="a card", trial_ns=0.1), Demand(consumer="gpu", message="GpuJob"))
    give(done(jobs[0]), clock(2))
    give(done(jobs[1]), clock(9), clock(0))  # Twilight is another program.
    give(done(jobs[2]), done(jobs[3]))
    give(setting("cube_device", "cpu"), setting("cube_device", "auto"))
    give(done(jobs[4]), RendererTried(renderer="llvmpipe", trial_ns=90.0, is_software=True))
    kernel.close()
    return inputs


def clouds_on_card():
    """Clouds over an evening's sky, both by a card, which then fails."""
    kernel, jobs, inputs = kernel_of("clouds_on_card"), [], []
    kernel.tap(lambda message, _: jobs.append(message) if isinstance(message, GpuJob) else None)

    def give(*messages):
        for message in messages:
            inputs.append(message)
            kernel.inject(message)
            kernel.pump_until_idle()

    give(*START, Demand(consumer="test", message="SkyLightChanged", size=CUBE_SIZE))
    give(RendererTried(renderer="a card", trial_ns=0.1), Demand(consumer="gpu", message="GpuJob"))
    give(clock(8.5), done(jobs[-1]))
    give(setting("coverage", 0.5, module="clouds"))
    give(done(jobs[-1]), setting("coverage", 0.6, module="clouds"))
    give(failed(jobs[-1]))
    kernel.close()
    return inputs


def done(job):
    """The answer of the runner of GPU jobs."""
    texture = GpuTexture(size=job.size, format=job.format, recipe=job.recipe)
    return JobResult(module=job.module, job=job.job, value=texture)


def failed(job):
    return JobResult(module=job.module, job=job.job, error="out of memory")


START = [
    ChooseSlot(slot="sun", module="dynamic_skylight"),
    ChooseSlot(slot="sky", module="dynamic_skylight"),
    *demands(),
    PRAGUE,
    clock(0),
]
SCRIPTS = {
    "day_passing": [*START, *(clock(h) for h in range(-10, 11, 2)), SetClockRate(rate=3600.0),
                    Tick(elapsed_s=0.5), Tick(elapsed_s=0.25)],
    "place_changing": [
        *START,
        SetPlace(latitude_deg=-33.87, longitude_deg=151.21),
        SetPlace(latitude_deg=78.22, longitude_deg=15.65, altitude_m=5.0, north_offset_rad=0.5),
        SetPlace(latitude_deg=27.99, longitude_deg=86.93, altitude_m=8849.0),
    ],
    "module_failing": [
        *START,
        ChooseSlot(slot="sun", module="failing_sun"),
        clock(-1),
        clock(1),
        clock(2),
        clock(3),
        clock(4),
        RestartModule(module="failing_sun"),
        ChooseSlot(slot="sun", module="failing_sun"),
        clock(-2),
    ],
    "settings_dragged": [
        *START,
        *(setting("turbidity", 2.0 + 0.5 * i) for i in range(5)),
        *(setting("albedo", 0.1 * i) for i in range(4)),
        *(setting("sky_level", level) for level in ("equal-haze", "published")),
        setting("turbidity", 99),
        setting("haze", 1),
    ],
    "sun_coloured": [
        *START,
        *(setting("sun_colour", colour) for colour in ("white", "air", "sky_formula")),
        clock(7),
        setting("sun_colour", "disc"),
        clock(8.25),
        *(setting("sun_colour", colour) for colour in ("sky_formula", "white")),
        clock(9),
        setting("sun_colour", "disc"),
        setting("sun_colour", "green"),
    ],
    "sun_followed": [
        *START,
        *(clock(seconds / 3600) for seconds in range(1, 5)),
        *demands(size=2 * CUBE_SIZE),
        setting("sun_method", "preetham"),
        clock(4),
        setting("sun_method", "ephemeris"),
        *demands(),
    ],
    "sky_on_gpu": sky_on_gpu(),
    "sky_on_card": sky_on_card(),
    "clouds_on_card": clouds_on_card(),
    "slots_switched": [
        *START,
        ChooseSlot(slot="sky", module="bruneton_sky"),
        clock(2),
        ChooseSlot(slot="sky", module="dynamic_skylight"),
        ChooseSlot(slot="sky", module="failing_sun"),
        ChooseSlot(slot="sun", module="failing_sun"),
        ChooseSlot(slot="sun", module="dynamic_skylight"),
        ChooseSlot(slot="sky", module="bruneton_sky"),
        clock(9),
    ],
}  # fmt: skip


def record_script(name, stream):
    """Play a script on a fresh kernel, input by input, and record it."""
    kernel = kernel_of(name)
    recorder = Recorder(kernel, stream)
    for message in SCRIPTS[name]:
        kernel.inject(message)
        kernel.pump_until_idle()
    recorder.close()
    kernel.close()


def journal_path(name):
    return HERE / f"{name}.mcap"


if __name__ == "__main__":
    for script in SCRIPTS:
        with atomic_output(journal_path(script)) as beside, beside.open("wb") as output:
            record_script(script, output)
        print(journal_path(script))
