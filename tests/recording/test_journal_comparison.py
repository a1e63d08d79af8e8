"""What counts as equal: to the bit on one machine, within stated tolerances elsewhere."""

import numpy as np
import pytest
from journal_toys import Echo, sun_at

from vrut_lite.array import Array
from vrut_lite.kernel.messages import SetClockRate, SlotChanged
from vrut_lite.message_codec import digest_of, to_plain
from vrut_lite.recording.comparison import entry_difference
from vrut_lite.recording.entry import Entry

WAVE = np.linspace(1.0, 2.0, 320)


def entry(message, sender="parrot", kind="derived", **changes):
    name, plain = type(message).__name__, to_plain(message) | changes
    return Entry(
        kind=kind, type_name=name, sender=sender, digest=digest_of(name, plain), message=plain
    )


def echo(wave, value=1.0):
    return entry(Echo(value=value, wave=Array(np.array(wave))))


@pytest.mark.parametrize("by_value", [False, True])
def test_equal_messages_do_not_differ(by_value):
    """The same content from the same sender."""
    assert entry_difference(echo(WAVE), echo(WAVE), by_value) is None


def test_the_last_bit_differs_by_digest_and_not_by_value():
    """exp and pow differ in the last bit between AVX-512 and AVX2 (notes on bit identity)."""
    there, here = echo(WAVE, 1.0), echo(np.nextafter(WAVE, 9), np.nextafter(1.0, 2.0))
    assert entry_difference(there, here, by_value=True) is None
    said = entry_difference(there, here, by_value=False)
    assert "value is 1.0000000000000002 here and 1.0 in the journal" in said


def test_arrays_say_how_far_apart_they_are():
    """Which field, how many of the samples, by how much."""
    said = entry_difference(echo(WAVE), echo(WAVE * 1.01), by_value=False)
    assert said == "wave: its content differs, 32 of 32 sampled values do, by up to 0.0099 relative"
    said = entry_difference(echo(WAVE), echo(WAVE * 1.01), by_value=True)
    assert said == "wave: sampled values differ by up to 0.0099 relative, over 0.001"


@pytest.mark.parametrize(("factor", "equal"), [(1.0009, True), (1.0011, False)])
def test_sampled_values_may_differ_by_a_thousandth(factor, equal):
    """The design's tolerance for what another machine computed."""
    difference = entry_difference(echo(WAVE), echo(WAVE * factor), by_value=True)
    assert (difference is None) == equal


@pytest.mark.parametrize("size", [1e-4, 3.0, -2e6])
@pytest.mark.parametrize(("factor", "equal"), [(1 + 0.9e-5, True), (1 + 1.1e-5, False)])
def test_scalars_may_differ_by_the_fifth_decimal(factor, equal, size):
    """Also those that are small: the light of a night must not pass for any other."""
    there, here = entry(sun_at(size)), entry(sun_at(size * factor))
    assert (entry_difference(there, here, by_value=True) is None) == equal


def test_the_last_bit_of_float32_is_no_difference_by_value():
    """Values that went through float32 differ by so much between processors."""
    for value in np.exp(np.linspace(-20.0, 20.0, 50)).astype(np.float32):
        after = float(np.nextafter(value, np.float32(np.inf)))
        there, here = entry(sun_at(float(value))), entry(sun_at(after))
        assert entry_difference(there, here, by_value=True) is None


def test_the_rounding_of_the_largest_sample_is_no_difference_by_value():
    """A sum that nearly cancels is known to the last bit of its terms, not of its own."""
    wave = WAVE.copy()
    wave[0] = 1e-7
    there, here = echo(wave), echo(wave + np.where(wave < 1.0, np.finfo(np.float32).eps / 2, 0.0))
    assert entry_difference(there, here, by_value=True) is None
    here = echo(wave + np.where(wave < 1.0, 1e-6, 0.0))
    assert "sampled values differ" in entry_difference(there, here, by_value=True)


def test_a_nan_where_a_value_was_is_told():
    """A comparison with NaN is always false: it must not pass for equal."""
    broken = WAVE.copy()
    broken[0] = np.nan
    assert "inf relative" in entry_difference(echo(WAVE), echo(broken), by_value=True)
    assert entry_difference(echo(broken), echo(broken * 1.0000001), by_value=True) is None


def test_a_sample_that_is_no_number_is_no_crash():
    """A stranger's journal may claim any sample: whole numbers beyond all floats, texts."""
    there = echo(WAVE)
    forged = to_plain(Array(WAVE + 1)) | {"sample": [10**400, "one", *[1.0] * 30]}
    here = entry(Echo(value=1.0, wave=Array(WAVE + 1)), wave=forged)
    assert "inf relative" in entry_difference(there, here, by_value=True)


def test_another_shape_or_type_of_array_is_told():
    """A cube of another size is another message, on any machine."""
    said = entry_difference(echo(WAVE), echo(WAVE[:100]), by_value=True)
    assert said == "wave has shape [100] here and [320] in the journal"
    said = entry_difference(echo(WAVE), echo(WAVE.astype("f4")), by_value=True)
    assert said == "wave has dtype <f4 here and <f8 in the journal"


def test_a_changed_field_is_named():
    """A journal of an older version shows which field came or went."""
    slot = SlotChanged(name="sun", holder="parrot")
    older = entry(slot, since="noon")
    assert "journal's field 'since' is unknown" in entry_difference(older, entry(slot), False)
    assert "knows no field 'since'" in entry_difference(entry(slot), older, True)


def test_another_type_or_sender_is_told():
    """Order and origin of messages bind on every machine."""
    said = entry_difference(entry(sun_at(1.0)), entry(sun_at(1.0), sender="owl"), by_value=True)
    assert said == "it is a SunMoved from owl here and a SunMoved from parrot in the journal"


def test_one_is_not_true():
    """1 == True in Python; a setting that became a truth value is another setting."""
    there, here = entry(SetClockRate(rate=1.0)), entry(SetClockRate(rate=1.0), rate=True)
    assert entry_difference(there, here, by_value=True) is not None
