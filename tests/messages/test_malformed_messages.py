"""A malformed message is refused in one sentence and reaches no module."""

import contextlib
import math

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from message_samples import NOON, SOUND, holes, kernel_that_posts, spoilt
from probe_messages import act, collect, faults_of

from vrut_lite.array import Array
from vrut_lite.checks import refusal_of
from vrut_lite.errors import UserError
from vrut_lite.kernel.bus import Kernel
from vrut_lite.kernel.messages import (
    Derived,
    Fault,
    Input,
    Tick,
)
from vrut_lite.kernel.module import Manifest, Module, handles
from vrut_lite.messages.gpu_texture import GpuTexture


class Odd:
    """An object whose methods raise."""

    def __repr__(self):
        raise ZeroDivisionError

    def __eq__(self, other):
        raise ZeroDivisionError

    __hash__ = None  # type: ignore[assignment]


NUMBERS = st.one_of(
    st.sampled_from(
        [math.nan, math.inf, -math.inf, 10**400, -(10**400), -1, 0, True, 1e308, -1e-9]
    ),
    st.sampled_from([np.float32("nan"), np.int64(-7), np.float16("inf"), np.bool_(True)]),
    st.integers(-(2**70), 2**70),
    st.floats(),
)
ARRAYS = st.builds(
    lambda shape, kind: Array(np.zeros(shape, kind)),
    st.lists(st.integers(0, 7), max_size=5),
    st.sampled_from(["f2", "f4", "f8", "u1", "u2", ">f4", "c8", "U3", "?"]),
)
JUNK = st.recursive(
    st.one_of(
        NUMBERS, ARRAYS, st.none(), st.text(max_size=5), st.binary(max_size=3),
        st.builds(Odd), st.builds(object), st.just(dict), st.just(NOON.replace(tzinfo=None)),
        st.builds(GpuTexture, st.just("x"), st.none(), st.just(3)),
    ),
    lambda inner: st.one_of(
        st.lists(inner, max_size=4), st.lists(inner, max_size=4).map(tuple),
        st.dictionaries(st.text(max_size=2), inner, max_size=2),
    ),
    max_leaves=6,
)  # fmt: skip


@given(st.sampled_from(SOUND), st.data())
def test_a_check_of_any_value_passes_or_raises_one_sentence(message, data):
    """Also a value of a wrong type, of no finite size, or one that raises when it is shown."""
    place = data.draw(st.sampled_from(list(holes(message))))
    odd = spoilt(message, place, data.draw(JUNK))
    try:
        odd.check()
    except UserError as error:
        sentence = str(error)
        assert len(sentence) < 500
        assert "\n" not in sentence
        assert sentence.encode()
        return
    # If `check` passes, `check_arrays` may still refuse numbers in arrays.
    with contextlib.suppress(UserError):
        odd.check_arrays()


@given(st.sampled_from([m for m in SOUND if isinstance(m, Derived)]), st.data())
def test_a_malformed_post_is_a_fault_and_reaches_no_module(message, data):
    """Consumers get only messages that pass the check; the poster gets a Fault."""
    place = data.draw(st.sampled_from(list(holes(message))))
    odd = spoilt(message, place, data.draw(JUNK))
    sound = refusal_of(odd) is None
    kernel = kernel_that_posts(odd)
    heard, faults = collect(kernel, type(odd)), collect(kernel, Fault)
    act(kernel, Tick(elapsed_s=1.0))
    assert any(one is odd for one in heard) == sound
    told = [fault for fault in faults if fault is not odd]
    assert [(fault.module, fault.where) for fault in told] == [("poster", "on_tick")] * (not sound)
    assert not any(fault.for_user for fault in told)


@given(st.sampled_from([m for m in SOUND if isinstance(m, Input)]), st.data())
def test_a_malformed_input_is_refused_and_never_heard(message, data):
    """The API takes any value: an invalid one gives the user one sentence."""
    place = data.draw(st.sampled_from(list(holes(message))))
    odd = spoilt(message, place, data.draw(JUNK))
    heard = []

    class Listener(Module):
        manifest = Manifest(name="listener", title="Listener", version="1")

        @handles(type(odd))
        def on_any(self, message):
            heard.append(message)

    kernel = Kernel()
    kernel.add_module(Listener)
    faults = faults_of(kernel)
    kernel.inject(odd)
    kernel.pump_until_idle()
    refusal = refusal_of(odd)
    if refusal is not None:
        assert not heard
        assert [fault.error for fault in faults] == [refusal]
        assert faults[0].for_user
