"""Demand: merged over consumers, and gone while a consumer is."""

import pytest
from hypothesis import given
from hypothesis import strategies as st
from probe_messages import Sun, act, collect

from vrut_lite.kernel.bus import Kernel
from vrut_lite.kernel.demands import Demands
from vrut_lite.kernel.messages import Demand, EnableModule, Fault
from vrut_lite.kernel.module import Manifest, Module, handles

EXACTNESS = ["", "u8", "float16", "float32"]


class Viewer(Module):
    manifest = Manifest(name="viewer", title="Viewer", version="1")


class Producer(Module):
    manifest = Manifest(name="producer", title="Producer", version="1")

    def __init__(self, link, settings):
        super().__init__(link, settings)
        self.wishes = []

    @handles(Demand)
    def on_demand(self, message: Demand) -> None:
        wanted = self.link.wanted(Sun)
        self.wishes.append(wanted and wanted.size)


def demand(consumer, size=None, encoding=""):
    return Demand(consumer=consumer, message="Sun", size=size, encoding=encoding)


@given(
    st.lists(
        st.tuples(
            st.sampled_from("abc"), st.none() | st.integers(0, 9), st.sampled_from(EXACTNESS)
        ),
        min_size=1,
    )
)
def test_the_merged_demand_serves_every_consumer(wishes):
    """The largest named size and the most exact encoding of all present demands."""
    kernel = Kernel()
    present = {}
    for consumer, size, encoding in wishes:
        act(kernel, demand(consumer, size, encoding))
        present[consumer] = (size, encoding)
    present = [wish for wish in present.values() if wish[0] != 0]
    merged = kernel.wanted(Sun)
    if not present:
        assert merged is None
    else:
        named = [size for size, _ in present if size is not None]
        assert merged.size == (max(named) if named else None)
        assert merged.encoding == max((e for _, e in present), key=EXACTNESS.index)


def test_many_consumers_of_one_message_are_merged_one_by_one():
    """A thousand demands check the running modules a thousand times, not half a million times."""
    asked = []
    demands = Demands(lambda name: bool(asked.append(name)))
    for number in range(1000):
        demands.note(demand(f"consumer {number}", size=number % 70 + 1))
    assert demands.merged["Sun"].size == 70
    assert demands.merged["Sun"].consumer.count(", ") == 999
    assert len(asked) <= 2000


def test_a_disabled_consumer_wants_nothing_until_it_is_back():
    """No sky is computed for a disabled view, and its return is posted."""
    kernel = Kernel()
    kernel.add_module(Producer)
    kernel.add_module(Viewer)
    act(kernel, demand("viewer", 512), demand("other", 64))
    act(kernel, EnableModule(module="viewer", enabled=False))
    assert kernel.wanted(Sun).size == 64
    act(kernel, EnableModule(module="viewer"))
    assert kernel.wanted(Sun).size == 512
    assert kernel.seats["producer"].module.wishes == [512, 512, 512]


@pytest.mark.parametrize("encoding", ["float64", "U8"])
def test_an_unknown_encoding_is_refused(encoding):
    """A misspelt encoding would otherwise be served as the coarsest."""
    kernel = Kernel()
    faults = collect(kernel, Fault)
    act(kernel, demand("a", encoding=encoding))
    assert faults[0].error == (f"a wants Sun as '{encoding}': it can be u8, float16, float32")
    assert kernel.wanted(Sun) is None
