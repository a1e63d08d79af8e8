"""An input that fails wherever the kernel asks it is refused and spoils no other."""

from hostile_modules import Good, Panic
from hypothesis import given
from hypothesis import strategies as st
from probe_messages import Heard, Poke, collect, faults_of

from vrut_lite.errors import UserError
from vrut_lite.kernel.bus import Kernel
from vrut_lite.kernel.messages import Input, Tick


class OddInput(Input, frozen=True, kw_only=True):
    """A module's own input, which fails wherever it is asked."""

    what: str

    def key(self):
        if self.what == "key":
            raise Panic("no key")
        return [] if self.what == "unhashable key" else "one"

    def check(self):
        if self.what == "check":
            raise Panic("no check")
        if self.what == "user":
            raise UserError("mend it")


@given(st.lists(st.sampled_from(["key", "unhashable key", "check", "user", "good"]), max_size=6))
def test_an_input_that_raises_is_refused_alone(whats):
    """An input whose key or check fails is refused in one sentence and merges with no other."""
    kernel = Kernel()
    kernel.add_module(Good)
    faults, heard = faults_of(kernel), collect(kernel, Heard)
    for what in whats:
        kernel.inject(OddInput(what=what))
    kernel.inject(Poke(value=3))
    kernel.pump()
    assert len(faults) == sum(what != "good" for what in whats)
    assert all(fault.for_user for fault in faults)
    assert [message.value for message in heard] == [3]


def test_invalid_ticks_do_not_spoil_waiting_ones():
    """Ticks that wait are added up: one that is refused must not take others with it."""
    kernel = Kernel()
    ticks, faults = collect(kernel, Tick), faults_of(kernel)
    for elapsed in (1.0, float("nan"), 2.0, "x", None, 4.0, -1.0, 8.0):
        kernel.inject(Tick(elapsed_s=elapsed))
    kernel.pump()
    assert len(faults) == 4
    assert kernel.last(Tick) is not None
    sound = [tick.elapsed_s for tick in ticks if isinstance(tick.elapsed_s, float)]
    assert sum(elapsed for elapsed in sound if elapsed > 0) == 15.0
