"""Modules that raise, and the strangest things that can be raised or handed over."""

import asyncio

from probe_messages import Heard, Poke

from vrut_lite.kernel.module import Manifest, Module, handles


class Panic(BaseException):
    """As the exceptions of libraries that are written in Rust: no Exception."""


class Mute(Exception):
    """Cannot say what it is."""

    def __str__(self):
        raise Panic("no words")

    __repr__ = __str__


class NoText(Exception):
    def __str__(self):
        return 5  # type: ignore[return-value]


class Surrogate(str):
    """A str subclass that raises when it is formatted or measured."""

    def __format__(self, spec):
        raise Panic(spec)

    def __len__(self):
        raise Panic("len")


class OddText(Exception):
    def __str__(self):
        return Surrogate("lone \ud800 and \x00 and \x1b[2J")


class OddName(type):
    @property
    def __name__(cls):
        raise Panic("no name")


Nameless = OddName("Nameless", (Exception,), {})


class OddNotes(Exception):
    __notes__ = 7


def cyclic():
    first, second = ValueError("first"), ValueError("second")
    first.__cause__, second.__cause__ = second, first
    return first


def chained():
    error = ValueError("the last")
    for number in range(3000):
        outer = ValueError(number)
        outer.__cause__, error = error, outer
    return error


RAISED = {
    "exception": lambda: ValueError("plain"),
    "panic": lambda: Panic("a library panicked"),
    "cancelled": lambda: asyncio.CancelledError(),
    "generator exit": lambda: GeneratorExit(),
    "exit": lambda: SystemExit(3),
    "group": lambda: BaseExceptionGroup("all", [Panic("one"), KeyboardInterrupt()]),
    "mute": Mute,
    "no text": NoText,
    "odd text": OddText,
    "odd name": Nameless,
    "odd notes": OddNotes,
    "huge": lambda: ValueError("x" * 10**6),
    "huge number": lambda: ValueError(10**6000),
    "cycle": cyclic,
    "chain": chained,
    "stop": lambda: StopIteration(1),
    "recursion": lambda: RecursionError("deep"),
    "memory": lambda: MemoryError(),
}


def bad_module(where, make):
    """A module that raises `make()` at that place, once it is armed."""

    class Bad(Module):
        manifest = Manifest(name="bad", title="Bad", version="1")
        armed = where == "start"

        def __init__(self, link, settings):
            super().__init__(link, settings)
            self._raise("start")

        def _raise(self, here):
            if where == here and type(self).armed:
                raise make()

        @handles(Poke)
        def on_poke(self, message):
            self._raise("on_poke")
            if where == "job":
                self.link.start_job("work", self._raise, "job")

        def settings_changed(self, name):
            self._raise("settings_changed")

        def snapshot(self):
            self._raise("snapshot")
            return {"kept": 1}

        def restore(self, state):
            self._raise("restore")

    return Bad


class Good(Module):
    """Listens after the bad module, and posts `Heard`."""

    manifest = Manifest(name="good", title="Good", version="1")

    @handles(Poke)
    def on_poke(self, message):
        self.link.post(Heard(module="good", value=message.value))


class Odd:
    """An object that raises at every question."""

    def __getattribute__(self, name):
        raise Panic(name)


class Hostile(Module):
    """Does one of many things at a poke."""

    manifest = Manifest(name="hostile", title="Hostile", version="1")
    deed = staticmethod(lambda module: None)

    @handles(Poke)
    def on_poke(self, message):
        return type(self).deed(self)
