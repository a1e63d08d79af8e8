"""A model of the kernel, and random sequences of everything that a user can do to it."""

import shutil
import sys
import tempfile
from pathlib import Path
from textwrap import dedent

from hypothesis import settings
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, invariant, rule
from probe_messages import Heard, Poke, Slide, Sun

from vrut_lite.discovery import discover
from vrut_lite.kernel.bus import FAULTS_UNTIL_SUSPENSION, Kernel
from vrut_lite.kernel.messages import (
    ChooseSlot,
    EnableModule,
    Fault,
    ReloadModule,
    RestartModule,
    SlotChanged,
)

SOURCE = """
    from probe_messages import Heard, Poke, Slide, Sun
    from vrut_lite.kernel.module import Manifest, Module, handles

    class Probe(Module):
        manifest = Manifest(name="{name}", title="Probe", version="1", provides=("sun",))

        @handles(Poke)
        def on_poke(self, message: Poke) -> None:
            if "{name}" in message.fails:
                raise ValueError("as told")
            self.hear(message.value)
            self.link.post(Sun(source="{name}", value=message.value))

        @handles(Slide)
        def on_slide(self, message: Slide) -> None:
            self.hear(message.value)

        def hear(self, value):
            self.link.post(Heard(module="{name}", value=value, version={version}))
"""
BROKEN = -1


class ModelSeat:
    """What the model knows of a module."""

    def __init__(self):
        self.state = "running"
        self.faults = 0
        self.version = self.version_on_disk = 1

    def start(self):
        self.state, self.faults = "running", 0


class Model:
    """The kernel's promises, written down without queues, threads or classes on a disk."""

    def __init__(self, names):
        self.seats = {name: ModelSeat() for name in names}
        self.inbox = []
        self.holder = names[0]
        self.last_slide = None
        self.last_sun = None
        self.told = []

    def inject(self, message):
        if message.key() is not None:
            same = [m for m in self.inbox if (type(m), m.key()) == (type(message), message.key())]
            self.inbox = [m for m in self.inbox if m not in same]
        self.inbox.append(message)

    def pump(self):
        """All that shall be delivered, in order."""
        told = []
        for message in self.inbox:
            self.told = []
            getattr(self, type(message).__name__)(message)
            told += self.told
        self.inbox = []
        return told

    def running(self):
        return [name for name, seat in self.seats.items() if seat.state == "running"]

    def Poke(self, message):
        for name in self.running():
            if name in message.fails:
                self.fail(name)
                continue
            self.told.append(("Heard", name, message.value, self.seats[name].version))
            if name == self.holder:
                self.told.append(("Sun", name, message.value))
                self.last_sun = name

    def fail(self, name):
        seat = self.seats[name]
        seat.faults += 1
        suspended = seat.faults == FAULTS_UNTIL_SUSPENSION
        if suspended:
            seat.state = "suspended"
            self.fill()
        self.told.append(("Fault", name, "on_poke", suspended))

    def Slide(self, message):
        self.last_slide = message.value
        for name in self.running():
            self.told.append(("Heard", name, message.value, self.seats[name].version))

    def EnableModule(self, message):
        seat = self.seats[message.module]
        if message.enabled and seat.state != "running":
            self.start(message.module)
        elif not message.enabled and seat.state == "running":
            seat.state = "disabled"
            self.fill()

    def RestartModule(self, message):
        self.start(message.module)

    def ReloadModule(self, message):
        seat = self.seats[message.module]
        if seat.version_on_disk == BROKEN:
            self.told.append(("Fault", message.module, "reload", False))
            return
        seat.version = seat.version_on_disk
        if seat.state != "disabled":
            self.start(message.module)

    def ChooseSlot(self, message):
        if self.seats[message.module].state == "running":
            self.hand_to(message.module)
        else:
            self.told.append(("Fault", message.module, "slots", False))

    def start(self, name):
        self.seats[name].start()
        self.fill()
        if self.last_slide is not None:
            self.told.append(("Heard", name, self.last_slide, self.seats[name].version))

    def fill(self):
        able = self.running()
        if self.holder not in able:
            self.hand_to(able[0] if able else "")

    def hand_to(self, name):
        if name == self.holder:
            return
        self.holder = name
        if name not in ("", self.last_sun):
            self.last_sun = None
        # Within one transaction only the latest change of a slot is delivered, at its own place.
        self.told = [entry for entry in self.told if entry[0] != "SlotChanged"]
        self.told.append(("SlotChanged", name))


NAMES = st.integers(0, 2)


class KernelMachine(RuleBasedStateMachine):
    """The kernel beside its model."""

    def __init__(self):
        super().__init__()
        self.folder = Path(tempfile.mkdtemp())
        self.names = ["model_probe_a", "model_probe_b", "model_probe_c"]
        for name in self.names:
            self.write(name, 1)
        modules, _ = discover([self.folder])
        self.kernel = Kernel()
        for module in modules:
            if module.manifest.name in self.names:
                self.kernel.add_module(module)
        self.kernel.pump()
        self.told = []
        self.kernel.tap(self.note)
        self.model = Model(self.names)
        self.value = 0

    def teardown(self):
        self.kernel.close()
        sys.path.remove(str(self.folder.resolve()))
        for name in self.names:
            sys.modules.pop(name, None)
        shutil.rmtree(self.folder)

    def write(self, name, version):
        text = dedent(SOURCE).format(name=name, version=version)
        # A compiled file is known by size and whole seconds: each version gets its own size.
        padding = "#" * (version + 1)
        (self.folder / f"{name}.py").write_text(f"{text if version != BROKEN else '('}\n{padding}")

    def note(self, message, sender):
        match message:
            case Heard():
                self.told.append(("Heard", message.module, message.value, message.version))
            case Sun():
                self.told.append(("Sun", message.source, message.value))
            case SlotChanged():
                self.told.append(("SlotChanged", message.holder))
            case Fault():
                self.told.append(("Fault", message.module, message.where, message.suspended))

    def inject(self, message):
        self.kernel.inject(message)
        self.model.inject(message)

    @rule(fails=st.frozensets(NAMES))
    def poke(self, fails):
        self.value += 1
        names = tuple(self.names[index] for index in sorted(fails))
        self.inject(Poke(value=self.value, fails=names))

    @rule()
    def slide(self):
        self.value += 1
        self.inject(Slide(value=self.value))

    @rule(index=NAMES, enabled=st.booleans())
    def enable(self, index, enabled):
        self.inject(EnableModule(module=self.names[index], enabled=enabled))

    @rule(index=NAMES)
    def restart(self, index):
        self.inject(RestartModule(module=self.names[index]))

    @rule(index=NAMES)
    def switch(self, index):
        self.inject(ChooseSlot(slot="sun", module=self.names[index]))

    @rule(index=NAMES, broken=st.booleans())
    def edit_and_reload(self, index, broken):
        # The reload takes the files as they are when it is admitted.
        self.pump()
        self.value += 1
        version = BROKEN if broken else self.value
        self.write(self.names[index], version)
        self.model.seats[self.names[index]].version_on_disk = version
        self.inject(ReloadModule(module=self.names[index]))

    @rule()
    def pump(self):
        self.told.clear()
        expected = self.model.pump()
        self.kernel.pump()
        assert self.told == expected

    @invariant()
    def after_pumping_the_states_agree(self):
        if self.model.inbox:
            return
        states = {name: self.kernel.seats[name].state for name in self.names}
        assert states == {name: seat.state for name, seat in self.model.seats.items()}
        assert self.kernel.slots.holder("sun") == self.model.holder
        last = self.kernel.last(Sun)
        assert (last.source if last else None) == self.model.last_sun


KernelMachine.TestCase.settings = settings(stateful_step_count=40)


class TestKernel(KernelMachine.TestCase):
    """No message is lost, doubled or reordered under any sequence of user actions."""
