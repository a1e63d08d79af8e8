"""A thousand messages through the kernel, and through libraries of signals, in the same run.

All pass one message object, made beforehand, to handlers that count it. The kernel does so with
isolation and trace on, either as posts after one input or as an input each.
"""

import importlib
from collections.abc import Callable
from functools import partial
from importlib.util import find_spec
from typing import Any

from vrut_lite.kernel.bus import Kernel
from vrut_lite.kernel.messages import Derived, Input
from vrut_lite.kernel.module import Link, Manifest, Module, handles
from vrut_lite_lab.bench.bench_path import BenchPath, Errors, Group

MESSAGES, THOUSANDS = 10_000, 10


class Burst(Input, frozen=True, kw_only=True):
    """Asks for a number of posts."""

    count: int


class Single(Input, frozen=True, kw_only=True):
    """An input of its own, never coalesced."""

    elevation_rad: float

    def key(self) -> None:
        """Every one counts."""


class Moved(Derived, frozen=True, kw_only=True):
    """The message that is posted, never coalesced."""

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


# Passes `MESSAGES` messages and returns the subscribers: it keeps them alive, since some libraries
# hold subscribers by weak reference.
Run = Callable[[], list[Counter]]


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


def kernel_posts(subscribers: int) -> Run:
    """The kernel: one input, whose handler posts."""
    kernel, counters = _kernel(subscribers)

    def run() -> list[Counter]:
        kernel.inject(Burst(count=MESSAGES))
        kernel.pump()
        return counters

    return run


def kernel_inputs(subscribers: int) -> Run:
    """The kernel: an input each, pumped at once."""
    kernel, counters = _kernel(subscribers)
    single = Single(elevation_rad=0.5)

    def run() -> list[Counter]:
        inject, pump = kernel.inject, kernel.pump
        for _ in range(MESSAGES):
            inject(single)
            pump()
        return counters

    return run


def pluggy_hook(subscribers: int) -> Run:
    """A pluggy hook with a plugin for each subscriber."""
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

    def run() -> list[Counter]:
        hook, moved = manager.hook.on_moved, Moved(elevation_rad=0.5)
        for _ in range(MESSAGES):
            hook(message=moved)
        return counters

    return run


def pyside_signal(subscribers: int) -> Run:
    """A PySide6 signal, connected directly."""
    core: Any = importlib.import_module("PySide6.QtCore")
    counters = [Counter() for _ in range(subscribers)]

    class Owner(core.QObject):
        moved = core.Signal(object)

    owner = Owner()
    for counter in counters:
        owner.moved.connect(counter.on_moved)

    def run() -> list[Counter]:
        emit, moved = owner.moved.emit, Moved(elevation_rad=0.5)
        for _ in range(MESSAGES):
            emit(moved)
        return counters

    return run


CONTESTANTS: dict[str, tuple[str, Callable[[int], Run]]] = {
    "vrut_lite, posts after one input": ("vrut_lite", kernel_posts),
    "vrut_lite, an input each": ("vrut_lite", kernel_inputs),
    "pluggy": ("pluggy", pluggy_hook),
    "PySide6": ("PySide6", pyside_signal),
}


def groups(_quick: bool) -> list[Group]:
    """To one subscriber and to four."""
    left_out = {
        name: f"{package} is not installed"
        for name, (package, _) in CONTESTANTS.items()
        if find_spec(package) is None
    }
    return [
        Group(
            name=f"dispatch-{count}",
            title=f"Messages to {count} subscriber{'s' if count > 1 else ''}",
            unit="a thousand messages",
            norm="none: every message arrives",
            truth="none",
            paths=tuple(_path(name, count) for name in CONTESTANTS if name not in left_out),
            left_out=left_out,
        )
        for count in (1, 4)
    ]


def _path(name: str, subscribers: int) -> BenchPath:
    return BenchPath(
        name=name,
        family=name,
        parameters={"subscribers": subscribers},
        prepare=partial(CONTESTANTS[name][1], subscribers),
        error=_check,
        units=THOUSANDS,
    )


def _check(counters: list[Counter]) -> dict[str, Errors]:
    """No errors: a lost or doubled message is a fault of the benchmark.

    Raises:
        RuntimeError: a subscriber missed a message of the first call, or heard one twice.
    """
    if any(counter.count != MESSAGES for counter in counters):
        raise RuntimeError("messages were lost or doubled")
    return {}
