"""Small modules for the tests of recording."""

import io
from typing import Annotated

import msgspec
import numpy as np
from probe_messages import sun_at

from vrut_lite.array import Array
from vrut_lite.kernel.bus import Kernel
from vrut_lite.kernel.messages import Derived, Input, JobResult, SlotChanged
from vrut_lite.kernel.module import Manifest, Module, handles
from vrut_lite.recording.recorder import Recorder
from vrut_lite.recording.replay_runner import ReplayRunner


class Poke(Input, frozen=True, kw_only=True):
    value: float

    def key(self) -> None:
        return None


class Echo(Derived, frozen=True, kw_only=True):
    value: float
    wave: Array


class LoudSettings(msgspec.Struct, frozen=True):
    volume: Annotated[float, msgspec.Meta(ge=0, le=11, description="How loud")] = 3.0
    tone: str = "low"


def heavy_work(value):
    """The work of a job; it fails for some values."""
    if value > 0.9:
        raise ValueError(f"{value} is too much")
    return np.exp(np.linspace(0.0, value, 64))


class Parrot(Module):
    """Echoes a poke with an array, works on some in the background, and fails at others."""

    manifest = Manifest(name="parrot", title="Parrot", version="1", provides=("sun",))
    speaks = (Echo,)
    settings_type = LoudSettings

    @handles(Poke)
    def on_poke(self, message):
        if message.value < 0.15:
            raise ValueError(f"cannot say {message.value}")
        wave = np.exp(message.value * np.linspace(0.0, self.settings.volume, 100))
        self.link.post(Echo(value=message.value, wave=Array(wave.astype(np.float32))))
        if message.value > 0.6:
            self.link.start_job("think", heavy_work, message.value)

    @handles(JobResult)
    def on_result(self, message):
        if not message.error:
            self.link.post(Echo(value=-1.0, wave=Array(message.value.astype(np.float16))))

    @handles(SlotChanged)
    def on_slot(self, message):
        self.link.post(sun_at(0.1 * self.settings.volume))


class OtherSun(Parrot):
    manifest = Manifest(name="other_sun", title="Other sun", version="1", provides=("sun",))


class NumberedEcho(Module):
    """Says how many echoes it has heard."""

    manifest = Manifest(name="counter", title="Counter", version="2")
    speaks = (Echo,)

    def __init__(self, link, settings):
        super().__init__(link, settings)
        self.heard = 0

    @handles(Echo)
    def on_echo(self, message):
        self.heard += 1
        self.link.post(sun_at(1e-3 * self.heard))


TOYS = (Parrot, NumberedEcho, OtherSun)


def toy_kernel(runner=None):
    kernel = Kernel() if runner is None else Kernel(runner=runner)
    for module in TOYS:
        kernel.add_module(module)
    kernel.pump()
    return kernel


def record_inputs(inputs, full=False):
    """A journal's bytes of these inputs, each admitted alone; jobs finish after each."""
    stream = io.BytesIO()
    runner = ReplayRunner()
    kernel = toy_kernel(runner)
    recorder = Recorder(kernel, stream, full)
    for message in inputs:
        kernel.inject(message)
        kernel.pump()
        runner.wait()
        kernel.pump()
    recorder.close()
    return stream.getvalue()
