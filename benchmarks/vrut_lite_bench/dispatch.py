"""Messages a second through the kernel, and through signal libraries, in the same run.

    python -m vrut_lite_bench.dispatch

Everyone passes one message object, made beforehand, to handlers that count it. The kernel
does so with isolation and trace on, either as posts after one input or as an input each.
The contestants take turns; each figure is the least CPU time of all rounds, which is the one
that other work on the machine disturbed least.
"""

import importlib
import time
from collections.abc import Callable, Iterator
from importlib.metadata import version
from typing import Any, NamedTuple

from vrut_lite.kernel.bus import Kernel
from vrut_lite.kernel.messages import Derived, Input
from vrut_lite.kernel.module import Link, Manifest, Module, handles

MESSAGES = 10_000
ROUNDS = 40


class Burst(Input, frozen=True, kw_only=True):
    """Asks for so many posts."""

    count: int


class Single(Input, frozen=True, kw_only=True):
    """An input of its own, never coalesced."""

    elevation_rad: float

    def key(self) -> None:
        """Every one counts."""


class Moved(Derived, frozen=True, kw_only=True):
    """What is posted, never coalesced."""

    elevation_rad: float

    def key(self) -> None:
        """Every one counts."""


class Counter:
    """A subscriber that counts."""

    def __init__(self) -> None:
        self.count = 0

    def on_moved(self, message: Any) -> None:
        """Count it."""
        self.count += 1


class Contestant(NamedTuple):
    """A way to pass messages: `run()` passes `MESSAGES`, `counters` are who hears them."""

    name: str
    run: Callable[[], None]
    counters: list[Counter]


class _Poster(Module):
    manifest = Manifest(name="poster", title="Poster", version="1")

    @handles(Burst)
    def on_burst(self, message: Burst) -> None:
        post, moved = self.link.post, Moved(elevation_rad=0.5)
        for _ in range(message.count):
            post(moved)


def _kernel(subscribers: int) -> tuple[Kernel, list[Counter]]:
    kernel = Kernel()
    kernel.add_module(_Poster)
    counters: list[Counter] = []
    for number in range(subscribers):

        class Subscriber(Module, Counter):
            manifest = Manifest(name=f"subscriber {number}", title="Subscriber", version="1")

            def __init__(self, link: Link, settings: Any):
                super().__init__(link, settings)
                self.count = 0

            @handles(Moved)
            @handles(Single)
            def on_moved(self, message: Moved | Single) -> None:
                self.count += 1

        kernel.add_module(Subscriber)
        counters.append(kernel.seats[Subscriber.manifest.name].module)  # type: ignore[arg-type]
    kernel.pump()
    return kernel, counters


def kernel_posts(subscribers: int) -> Contestant:
    """The kernel: one input, whose handler posts."""
    kernel, counters = _kernel(subscribers)

    def run() -> None:
        kernel.inject(Burst(count=MESSAGES))
        kernel.pump()

    return Contestant("vrut_lite, posts after one input", run, counters)


def kernel_inputs(subscribers: int) -> Contestant:
    """The kernel: an input each, pumped at once."""
    kernel, counters = _kernel(subscribers)
    single = Single(elevation_rad=0.5)

    def run() -> None:
        inject, pump = kernel.inject, kernel.pump
        for _ in range(MESSAGES):
            inject(single)
            pump()

    return Contestant("vrut_lite, an input each", run, counters)


def _repeat(send: Callable[[Moved], Any]) -> Callable[[], None]:
    def run() -> None:
        moved = Moved(elevation_rad=0.5)
        for _ in range(MESSAGES):
            send(moved)

    return run


def psygnal_signal(subscribers: int) -> Contestant:
    """A psygnal Signal on an object."""
    psygnal = importlib.import_module("psygnal")
    counters = [Counter() for _ in range(subscribers)]
    owner = type("Owner", (), {"moved": psygnal.Signal(object)})()
    for counter in counters:
        owner.moved.connect(counter.on_moved)
    return Contestant(f"psygnal {version('psygnal')}", _repeat(owner.moved.emit), counters)


def pluggy_hook(subscribers: int) -> Contestant:
    """A pluggy hook, whose plugins all hear it."""
    pluggy = importlib.import_module("pluggy")
    specify, implement = pluggy.HookspecMarker("bench"), pluggy.HookimplMarker("bench")

    class Specification:
        @specify
        def on_moved(self, message: Any) -> None:
            """A message."""

    class Plugin(Counter):
        on_moved = implement(Counter.on_moved)

    manager = pluggy.PluginManager("bench")
    manager.add_hookspecs(Specification)
    counters: list[Counter] = [Plugin() for _ in range(subscribers)]
    for counter in counters:
        manager.register(counter)

    def run() -> None:
        hook, moved = manager.hook.on_moved, Moved(elevation_rad=0.5)
        for _ in range(MESSAGES):
            hook(message=moved)

    return Contestant(f"pluggy {version('pluggy')}", run, counters)


def blinker_signal(subscribers: int) -> Contestant:
    """A blinker Signal; the message is its sender argument, the cheapest way to pass one."""
    blinker = importlib.import_module("blinker")
    counters = [Counter() for _ in range(subscribers)]
    signal = blinker.Signal()
    for counter in counters:
        signal.connect(counter.on_moved)
    return Contestant(f"blinker {version('blinker')}", _repeat(signal.send), counters)


def pyside_signal(subscribers: int) -> Contestant:
    """A PySide6 signal, connected directly."""
    core: Any = importlib.import_module("PySide6.QtCore")
    counters = [Counter() for _ in range(subscribers)]

    class Owner(core.QObject):
        moved = core.Signal(object)

    owner = Owner()
    for counter in counters:
        owner.moved.connect(counter.on_moved)

    def run() -> None:
        emit, moved = owner.moved.emit, Moved(elevation_rad=0.5)
        for _ in range(MESSAGES):
            emit(moved)

    return Contestant(f"PySide6 signal {core.__version__}", run, counters)


CONTESTANTS = (
    kernel_posts,
    kernel_inputs,
    psygnal_signal,
    pluggy_hook,
    blinker_signal,
    pyside_signal,
)


def measure(subscribers: int, rounds: int = ROUNDS) -> tuple[dict[str, float], list[str]]:
    """CPU time per message in seconds by contestant, and the names of what is not installed.

    Raises:
        RuntimeError: a subscriber missed a message.
    """
    contestants, missing = [], []
    for make in CONTESTANTS:
        try:
            contestants.append(make(subscribers))
        except ModuleNotFoundError as error:
            missing.append(str(error.name).partition(".")[0])
    least_s = {contestant.name: float("inf") for contestant in contestants}
    for _ in range(rounds):
        for contestant in contestants:
            start_s = time.process_time()
            contestant.run()
            spent_s = time.process_time() - start_s
            least_s[contestant.name] = min(least_s[contestant.name], spent_s / MESSAGES)
    for contestant in contestants:
        if any(counter.count != rounds * MESSAGES for counter in contestant.counters):
            raise RuntimeError(f"{contestant.name} lost or doubled messages")
    return least_s, missing


def report(rounds: int = ROUNDS) -> Iterator[str]:
    """The figures as lines of text: microseconds, million messages a second, and the ratio."""
    for subscribers in (1, 4):
        least_s, missing = measure(subscribers, rounds)
        ours_s = next(iter(least_s.values()))
        yield f"{subscribers} subscriber{'s' if subscribers > 1 else ''}"
        for name, spent_s in least_s.items():
            speed = f"{spent_s * 1e6:6.2f} us  {1e-6 / spent_s:5.2f} M/s"
            yield f"  {name:34s} {speed}  {spent_s / ours_s:5.2f} x"
        if missing:
            yield f"  not installed, not compared: {', '.join(missing)}"


if __name__ == "__main__":
    for line in report():
        print(line)
