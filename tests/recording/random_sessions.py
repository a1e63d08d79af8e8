"""Random sessions: modules that do all that modules may, three threads that bring inputs.

    python tests/recording/random_sessions.py SEED [INPUTS]

plays the session of a seed ten times, with so many inputs from each thread, and says what its
replays found: who looks for a fault takes fewer inputs as long as it is there. With a journal in
place of the seed it says how its replay was compared, and gives a digest of what it said.
"""

import hashlib
import io
import random
import sys
import tempfile
import threading
import time
from datetime import UTC, datetime
from pathlib import Path
from typing import Annotated, Any, ClassVar

import msgspec
import numpy as np

from vrut_lite.app.engine.flight_recorder import FlightRecorder
from vrut_lite.array import Array
from vrut_lite.errors import UserError
from vrut_lite.kernel.bus import Kernel
from vrut_lite.kernel.messages import (
    ChooseSlot,
    Demand,
    Derived,
    EnableModule,
    Fault,
    Input,
    JobResult,
    RestartModule,
    SetClock,
    SetClockRate,
    SetSetting,
    SettingChanged,
    SlotChanged,
    Tick,
)
from vrut_lite.kernel.module import Manifest, Module, handles
from vrut_lite.recording.journal_reader import Journal
from vrut_lite.recording.recorder import Recorder
from vrut_lite.recording.replay import rerecord

INPUTS_PER_THREAD = 8
NAMES = ("ant", "bee", "cat")
JOBS = ("dig", "fly")


class Do(Input, frozen=True, kw_only=True):
    """Let one module act: `act` is the name of one of its methods."""

    module: str
    act: str
    number: int = 0

    def key(self) -> None:
        return None


class Said(Derived, frozen=True, kw_only=True):
    """Every message of a module; listeners may change its payload."""

    module: str
    payload: Any

    def key(self) -> None:
        return None


class Shone(Derived, frozen=True, kw_only=True):
    """What only the holder of the slot may say, remembered by number."""

    slot: ClassVar[str | None] = "lamp"

    number: int
    light: Array

    def key(self) -> str:
        return str(self.number % 3)


class ActorSettings(msgspec.Struct, frozen=True):
    level: Annotated[int, msgspec.Meta(ge=0, le=9, description="How much")] = 3
    mood: str = "calm"


def quick(number):
    return {"square": number * number, "parts": [number, [number]]}


def sleeping(number):
    time.sleep(number % 4 * 0.001)
    return Array(np.exp(np.linspace(0.0, number / 9.0, 40)).reshape(8, 5)[1:])


def failing(number):
    raise (UserError if number % 2 else ValueError)(f"cannot do {number}")


def until_cancelled(control):
    """Ends only when it is cancelled."""
    while not control.cancelled():
        time.sleep(0.0005)
    return "late"


def looking_up(number, control):
    """Asks often whether it is still wanted, tells how far it is, and ends by itself."""
    done = 0
    while done < number % 5 and not control.cancelled():
        done += 1
        control.progress(done / 5)
        time.sleep(0.0005)
    return done, control.cancelled()


class Actor(Module):
    """Acts as asked, with answers that depend on all messages that it has heard."""

    manifest = Manifest(name="actor", title="Actor", version="1")
    speaks = (Said, Shone)
    settings_type = ActorSettings

    def __init__(self, link, settings):
        super().__init__(link, settings)
        self.name = self.manifest.name
        self.heard = 0
        self.last: Any = None
        self.memory = np.zeros(12)
        if settings.level == 9:
            raise ValueError("too much to begin with")
        if settings.level == 7:
            link.start_job("dig", quick, 7)
            link.post(Said(module=self.name, payload="begun"))

    def settings_changed(self, name):
        if self.settings.level in (5, 6):
            raise ValueError(f"{name} must not be {self.settings.level}")
        self.say(name)

    def say(self, payload):
        self.link.post(Said(module=self.name, payload=payload))

    @handles(Do)
    def on_do(self, message: Do) -> None:
        self.heard += 1
        if message.module == self.name:
            getattr(self, message.act)(message.number)

    def speak(self, number):
        self.say({"number": number, "list": [number], "deep": ({"set": [number] * 3},)})

    def change_own(self, number):
        """Change what was posted before it is delivered, and once more in the next act."""
        if isinstance(self.last, dict):
            self.last["list"].append(number)
        self.last = {"list": [number], "array": np.full(4, float(number))}
        self.say(self.last)
        self.last["list"].append(-1)
        self.last["array"][0] = -1.0

    def write_behind(self, number):
        """Write to memory that a message holds, through the base and through another view.

        Now and in the next act, when somebody else may just be reading it.
        """
        self.memory[:] = -3.0
        base = self.memory = np.full(12, float(number))
        other = base[6:]
        self.say(Array(base[:6]))
        self.say(Array(other.reshape(2, 3)))
        base[:] = -1.0
        other[:] = -2.0

    def shine(self, number):
        self.link.post(Shone(number=number, light=Array(np.sqrt(np.arange(float(number))))))

    def work(self, number):
        works = (quick, sleeping, failing, looking_up)
        self.link.start_job(JOBS[number % 2], works[number // 2 % 4], number)

    def work_for_ever(self, number):
        self.link.start_job(JOBS[number % 2], until_cancelled)

    def cancel(self, number):
        self.link.cancel_job(JOBS[number % 2])

    def fail(self, number):
        raise (UserError if number % 2 else KeyError)(f"as told, {number}")

    def want(self, number):
        self.link.demand(Shone, size=number % 5)

    def storm(self, number):
        for _ in range(10_001):
            self.link.post(SettingChanged(module=self.name, name="storm", value=number))

    @handles(Said)
    def on_said(self, message: Said) -> None:
        self.heard += 1
        payload = message.payload
        if isinstance(payload, dict) and "list" in payload:
            payload["list"].append(f"{self.name} {self.heard}")
            payload["by"] = self.name

    @handles(SettingChanged)
    @handles(SlotChanged)
    @handles(Fault)
    def on_any(self, message) -> None:
        self.heard += 1
        self.shine(self.heard % 7)

    @handles(Shone)
    def on_shone(self, message: Shone) -> None:
        self.heard += 1
        self.say(message.light)

    @handles(Demand)
    def on_demand(self, message: Demand) -> None:
        wish = self.link.wanted(Shone)
        self.say((message.consumer, wish and wish.size))

    @handles(JobResult)
    def on_result(self, message: JobResult) -> None:
        self.heard += 1
        value = message.value
        if isinstance(value, dict):
            value["heard"] = self.heard
        self.say([message.job, value, message.error])
        if self.heard % 4 == 0:
            self.work(self.heard)


class Ant(Actor):
    manifest = Manifest(name="ant", title="Ant", version="1", provides=("lamp",))


class Bee(Actor):
    manifest = Manifest(name="bee", title="Bee", version="1", provides=("lamp",))


class Cat(Actor):
    manifest = Manifest(name="cat", title="Cat", version="1")


MODULES = (Ant, Bee, Cat)
ACTS = ("speak", "change_own", "write_behind", "shine", "work", "work", "work_for_ever",
        "cancel", "cancel", "fail", "want")  # fmt: skip


def setting_up(dice):
    """An input that a setup holds."""
    module = dice.choice(NAMES)
    return dice.choice(
        [
            SetSetting(module=module, name="level", value=dice.randrange(11)),
            SetSetting(module=module, name="level", value=dice.randrange(10)),
            SetSetting(module=module, name="mood", value=dice.choice(["calm", "wild"])),
            EnableModule(module=module, enabled=dice.random() < 0.6),
            RestartModule(module=module),
            ChooseSlot(slot="lamp", module=module),
            Demand(consumer=dice.choice(["view", *NAMES]), message="Shone", size=dice.randrange(4)),
        ]
    )


def from_elsewhere(dice):
    """A result that no job of the kernel's brought, of a name that a job may have."""
    values = [7, None, "done", {"parts": [1.5]}, Array(np.full((2, 3), dice.random()).T)]
    return JobResult(
        module=dice.choice(NAMES),
        job=dice.choice(JOBS),
        value=dice.choice(values),
        error=dice.choice(["", "", "no shader"]),
        trace=dice.choice(["", "", "", "Traceback"]),
    )


def any_input(dice):
    """An input of a seeded dice."""
    kind = dice.random()
    if kind < 0.2:
        return setting_up(dice)
    if kind < 0.35:
        return from_elsewhere(dice)
    if kind < 0.4:
        return dice.choice(
            [Tick(elapsed_s=dice.random()), SetClockRate(rate=60.0), SetClock(instant=NOON)]
        )
    act = "storm" if dice.random() < 0.003 else dice.choice(ACTS)
    return Do(module=dice.choice(NAMES), act=act, number=dice.randrange(20))


NOON = datetime(2026, 6, 21, 12, tzinfo=UTC)


def record(seed, folder, per_thread=INPUTS_PER_THREAD):
    """Play a session; a full journal's bytes, the flight recorder's journal is beside it.

    Jobs run on threads: two sessions of a seed do the same in another order.
    """
    dice = random.Random(seed)
    kernel = Kernel()
    for module in MODULES:
        kernel.add_module(module)
        if dice.random() < 0.2:
            kernel.pump()
    for _ in range(dice.choice([0, 0, 3, 8])):
        kernel.inject(setting_up(dice))
        if dice.random() < 0.7:
            kernel.pump()
        if dice.random() < 0.3:
            kernel.pump_until_idle()
    stream = io.BytesIO()
    recorder = Recorder(kernel, stream, full=True)
    flight = FlightRecorder(kernel)
    threads = [
        threading.Thread(target=_bring, args=(kernel, random.Random(f"{seed} {i}"), per_thread))
        for i in range(3)
    ]
    for thread in threads:
        thread.start()
    while any(thread.is_alive() for thread in threads):
        kernel.pump()
    if dice.random() < 0.8:
        for name in NAMES:
            kernel.inject(Do(module=name, act="cancel", number=0))
            kernel.inject(Do(module=name, act="cancel", number=1))
        kernel.pump()
        kernel.pump_until_idle()
    else:
        kernel.pump()
    recorder.close()
    kernel.close()
    flight.save(folder / "flight.mcap").result()
    flight.close()
    return stream.getvalue()


def _bring(kernel, dice, count):
    for _ in range(count):
        kernel.inject(any_input(dice))
        if dice.random() < 0.3:
            time.sleep(dice.random() * 0.002)


def fault_of(seed, folder, per_thread=INPUTS_PER_THREAD):
    """What is wrong with a session's replay, empty if nothing is; and its types and senders.

    The journal of one that is wrong stays in the folder.
    """
    live = record(seed, folder, per_thread)
    path = folder / f"session_{seed}.mcap"
    path.write_bytes(live)
    entries = list(Journal(path).entries())
    if entries != list(Journal(folder / "flight.mcap").entries()):
        return "the flight recorder's journal is another", set()
    again, outcome = replayed(path)
    if outcome.difference is not None:
        return outcome.difference, set()
    if again != live:
        return "the replay's journal has other bytes", set()
    path.unlink()
    return "", {(entry.type_name, entry.sender) for entry in entries}


def replayed(path):
    """The bytes of a journal's replay, recorded anew, and the outcome."""
    again = io.BytesIO()
    outcome = rerecord(Journal(path), again, MODULES)
    return again.getvalue(), outcome


if __name__ == "__main__":
    subject = sys.argv[1]
    if subject.isdigit():
        inputs = int(sys.argv[2]) if len(sys.argv) > 2 else INPUTS_PER_THREAD
        with tempfile.TemporaryDirectory() as place:
            for _ in range(10):
                print(fault_of(int(subject), Path(place), inputs)[0] or "equal")
    else:
        data, result = replayed(Path(subject))
        print(hashlib.sha256(data).hexdigest())
        print(f"compared by {'value' if result.by_value else 'digest'}: {result.difference}")
