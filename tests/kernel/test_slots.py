"""Slots: one speaker at a time, and never a mixture of two."""

from probe_messages import Halo, Poke, Sun, act, collect, faults_of

from vrut_lite.kernel.bus import FAULTS_UNTIL_SUSPENSION, Kernel
from vrut_lite.kernel.memory import Memory
from vrut_lite.kernel.messages import ChooseSlot, EnableModule, Fault, SlotChanged
from vrut_lite.kernel.module import Manifest, Module, handles


def provider(name, stand_in=True):
    """A module class that says sun and halo on a poke, and after a switch the sun alone."""

    class Provider(Module):
        manifest = Manifest(
            name=name, title=name, version="1", provides=("sun",), stand_in=stand_in
        )

        @handles(Poke)
        def on_poke(self, message: Poke) -> None:
            self.link.post(Sun(source=name))
            if name in message.fails:
                raise ValueError("as told")
            self.link.post(Halo(source=name))

        @handles(SlotChanged)
        def on_slot(self, message: SlotChanged) -> None:
            self.link.post(Sun(source=name))

    return Provider


def kernel_with(*names):
    kernel = Kernel()
    for name in names:
        kernel.add_module(provider(name))
    kernel.pump()
    return kernel


def sources(kernel):
    """Senders of the last sun and the last halo."""
    return [last and last.source for last in (kernel.last(Sun), kernel.last(Halo))]


def test_a_switch_never_shows_a_sun_of_one_with_the_halo_of_another():
    """At every single delivery, what `last` tells of a slot comes from one holder."""
    kernel = kernel_with("a", "b", "c")
    mixtures = []

    def look(message, sender):
        said = {source for source in sources(kernel) if source}
        if len(said) > 1:
            mixtures.append((message, said))

    kernel.tap(look)
    act(kernel, Poke())
    assert sources(kernel) == ["a", "a"]
    act(kernel, ChooseSlot(slot="sun", module="b"))
    assert sources(kernel) == ["b", None]
    act(kernel, Poke())
    assert sources(kernel) == ["b", "b"]
    # In one transaction b is suspended and hands to a, who is suspended and hands to c.
    act(kernel, *[Poke(fails=("a", "b"))] * FAULTS_UNTIL_SUSPENSION)
    assert kernel.slots.holder("sun") == "c"
    assert sources(kernel)[0] == "c"
    assert mixtures == []


def test_queued_messages_of_a_former_holder_are_dropped():
    """A message posted before its maker lost the slot would arrive after the new holder's."""
    kernel = kernel_with("a", "b")
    suns = collect(kernel, Sun)
    act(kernel, *[Poke(fails=("a",))] * FAULTS_UNTIL_SUSPENSION)
    # Of the third poke, only what the new holder said of it is heard.
    assert [sun.source for sun in suns] == ["a"] * (FAULTS_UNTIL_SUSPENSION - 1) + ["b"]


def test_without_another_the_last_sun_stays():
    """The last sun must stay when no module can move it."""
    kernel = kernel_with("a")
    act(kernel, Poke(), EnableModule(module="a", enabled=False))
    assert kernel.slots.holder("sun") == ""
    assert sources(kernel) == ["a", "a"]


def test_a_stopped_module_cannot_be_chosen():
    """A choice without effect is a Fault for the user."""
    kernel = kernel_with("a", "b")
    faults = faults_of(kernel)
    act(kernel, EnableModule(module="b", enabled=False), ChooseSlot(slot="sun", module="b"))
    assert kernel.slots.holder("sun") == "a"
    assert "module b is disabled" in faults[0].error


def test_a_module_without_stand_in_holds_a_slot_only_when_chosen():
    """A bridge holds the sun when it is chosen, never as a replacement."""
    kernel = Kernel()
    kernel.add_module(provider("bridge", stand_in=False))
    kernel.pump()
    assert kernel.slots.holder("sun") == ""
    kernel.add_module(provider("a"))
    kernel.pump()
    assert kernel.slots.holder("sun") == "a"
    act(kernel, EnableModule(module="a", enabled=False))
    assert kernel.slots.holder("sun") == ""
    act(kernel, ChooseSlot(slot="sun", module="bridge"))
    act(kernel, EnableModule(module="a"))
    assert kernel.slots.holder("sun") == "bridge"
    act(kernel, EnableModule(module="bridge", enabled=False))
    assert kernel.slots.holder("sun") == "a"


def test_a_switch_looks_once_through_all_that_is_remembered(monkeypatch):
    """However many keys the former holder has said: nine thousand took seconds."""
    memory, looks = Memory(), []
    for number in range(3000):
        kind = (Sun, Halo)[number % 2]
        memory.keep((kind, "ab"[number % 3 == 0], str(number)), number, kind(source=str(number)))
    memory.keep((Fault, "c", ""), 3000, Fault(module="c", where="", error=""))
    recall = memory.recall
    monkeypatch.setattr(memory, "recall", lambda types: looks.append(1) or recall(types))
    memory.keep_only("sun", "b")
    assert len(looks) == 1
    assert memory.latest[Sun].source == "2994"
    assert memory.latest[Halo].source == "2997"
    assert memory.latest[Fault].module == "c"
    memory.keep_only("sun", "nobody")
    assert set(memory.latest) == {Fault}


def needing(name, provides, requires):
    """A module class that holds a slot where others hold those that it requires."""
    manifest = Manifest(name=name, title=name, version="1", provides=provides, requires=requires)
    return type(name, (Module,), {"manifest": manifest})


def test_a_module_holds_no_slot_before_those_that_it_requires_are_filled():
    """A module gets no slot before each slot that it requires has had a holder."""
    kernel = Kernel()
    kernel.add_module(needing("sky", ("sky",), ("sun",)))
    kernel.add_module(needing("stars", ("night",), ("sky",)))
    kernel.pump()
    faults = faults_of(kernel)
    act(kernel, ChooseSlot(slot="sky", module="sky"))
    assert [fault.error for fault in faults] == [
        "module sky needs the slot 'sun', which no running module can fill"
    ]
    assert [kernel.slots.holder(slot) for slot in ("sun", "sky", "night")] == ["", "", ""]
    kernel.add_module(provider("a"))
    kernel.pump()
    assert [kernel.slots.holder(slot) for slot in ("sun", "sky", "night")] == ["a", "sky", "stars"]
    act(kernel, EnableModule(module="a", enabled=False))
    assert [kernel.slots.holder(slot) for slot in ("sun", "sky", "night")] == ["", "sky", "stars"]


def test_a_module_that_requires_nothing_is_preferred_by_standing_in_earlier():
    """Load order decides among modules that can hold it; a module that still waits is passed
    over."""
    kernel = Kernel()
    for module in (needing("sky", ("sky",), ("sun",)), needing("both", ("sun", "sky"), ())):
        kernel.add_module(module)
    kernel.pump()
    assert [kernel.slots.holder(slot) for slot in ("sun", "sky")] == ["both", "both"]
