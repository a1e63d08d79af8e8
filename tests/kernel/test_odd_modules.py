"""Modules with faulty settings, handlers or constructors: each gets a Fault and is isolated."""

import msgspec
import pytest
from hostile_modules import Good, Panic
from probe_messages import Heard, Poke, act, collect, faults_of

from vrut_lite.kernel.bus import Kernel
from vrut_lite.kernel.messages import Fault, ReloadModule, SetSetting
from vrut_lite.kernel.module import Manifest, Module, handles


def test_a_module_s_settings_may_refuse_each_other():
    """A rule over several settings, which raises, is a refusal in a sentence."""

    class Pair(msgspec.Struct, frozen=True):
        low: float = 0.0
        high: float = 1.0

        def __post_init__(self):
            if self.low > self.high:
                raise Panic("low lies above high")

    class Paired(Module):
        manifest = Manifest(name="paired", title="Paired", version="1")
        settings_type = Pair

    kernel = Kernel()
    kernel.add_module(Paired)
    faults = faults_of(kernel)
    act(kernel, SetSetting(module="paired", name="low", value=2.0))
    assert faults[0].for_user
    assert "low of paired cannot be 2.0: Panic: low lies above high" in faults[0].error
    assert kernel.seats["paired"].settings == Pair()
    act(kernel, SetSetting(module="paired", name="high", value=3.0))
    act(kernel, SetSetting(module="paired", name="low", value=2.0))
    assert kernel.seats["paired"].settings == Pair(2.0, 3.0)


def test_a_module_that_refuses_its_settings_is_a_fault():
    """Setting an attribute runs the module's code too."""

    class One(msgspec.Struct, frozen=True):
        one: float = 0.0

    class Closed(Module):
        manifest = Manifest(name="closed", title="Closed", version="1")
        settings_type = One

        def __setattr__(self, name, value):
            if name == "settings" and hasattr(self, "settings"):
                raise Panic("closed")
            super().__setattr__(name, value)

    kernel = Kernel()
    kernel.add_module(Closed)
    faults = faults_of(kernel)
    act(kernel, SetSetting(module="closed", name="one", value=1.0))
    assert [fault.module for fault in faults] == ["closed"]


@pytest.mark.parametrize("handler", ["gone", "none", "raises"])
def test_a_handler_that_is_gone_is_a_fault(handler):
    """Methods are looked up on the instance, which may have changed them."""

    class Shifty(Module):
        manifest = Manifest(name="shifty", title="Shifty", version="1")

        def __init__(self, link, settings):
            super().__init__(link, settings)
            if handler == "none":
                self.on_poke = None

        @handles(Poke)
        def on_poke(self, message):
            """Never reached."""

        def __getattribute__(self, name):
            if name == "on_poke" and handler != "none":
                raise AttributeError(name) if handler == "gone" else Panic(name)
            return super().__getattribute__(name)

    kernel = Kernel()
    faults, heard = faults_of(kernel), collect(kernel, Heard)
    kernel.add_module(Shifty)
    kernel.add_module(Good)
    act(kernel, Poke(value=1))
    assert {fault.module for fault in faults} <= {"shifty"}
    assert len(heard) == 1
    assert all(isinstance(fault, Fault) for fault in faults)


def test_a_constructor_without_super_is_a_fault():
    """Its counters is asked for by commands and panels long after."""

    class Forgetful(Module):
        manifest = Manifest(name="forgetful", title="Forgetful", version="1")

        def __init__(self, link, settings):
            pass

    kernel = Kernel()
    faults = faults_of(kernel)
    kernel.add_module(Forgetful)
    kernel.pump()
    assert "super().__init__(link, settings)" in faults[0].error
    assert kernel.seats["forgetful"].counters.done == {}
    act(kernel, ReloadModule(module="forgetful"))
