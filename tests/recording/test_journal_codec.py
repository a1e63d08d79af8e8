"""Messages as JSON values and back: nothing lost, nothing foreign let in."""

import math
import threading
from datetime import UTC, datetime, timedelta, timezone
from zoneinfo import ZoneInfo

import msgspec
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from journal_toys import Echo, Parrot, Poke, sun_at

from vrut_lite.array import Array
from vrut_lite.errors import UserError
from vrut_lite.kernel.messages import Fault, Input, JobResult, SetClock, SetSetting
from vrut_lite.kernel.module import Manifest, Module, handles
from vrut_lite.message_codec import arrays_of, decode, digest_of, to_plain
from vrut_lite.messages.camera import MoveCamera
from vrut_lite.messages.place import SetPlace
from vrut_lite.messages.sun import KeyLightChanged
from vrut_lite.recording.registry import Registry

SUN_LIGHT = KeyLightChanged(
    direction=(0.0, 0.6, -0.8),
    irradiance_rgb=(1e-300, 0.1, 1000.0),
    angular_radius_rad=0.00465,
    limb_darkening_rgb=((0.3, 0.9), (0.4, 0.8), (0.5, 0.7)),
    source="test",
)


def through_json(message):
    """The message after a journal: encoded as JSON bytes, decoded, converted."""
    plain = msgspec.json.decode(msgspec.json.encode(to_plain(message)))
    arrays = {array.digest: array for array in arrays_of(message)}
    return decode(type(message), plain, lambda handle: arrays[handle["$array"]])


floats = st.floats(allow_nan=False)


@given(st.builds(SetPlace, latitude_deg=floats, longitude_deg=floats, altitude_m=floats))
def test_every_float_survives_to_the_last_bit(place):
    """A replay that gets a rounded latitude computes another sun; -0.0 and infinity count."""
    back = through_json(place)
    assert back == place
    assert math.copysign(1, back.latitude_deg) == math.copysign(1, place.latitude_deg)


def test_a_nan_survives():
    """JSON has no NaN, yet a module must be shown again what it was shown."""
    assert math.isnan(through_json(SetPlace(latitude_deg=math.nan, longitude_deg=0)).latitude_deg)


@given(st.datetimes(timezones=st.sampled_from([UTC, timezone(timedelta(hours=-9, minutes=-30))])))
def test_a_time_is_its_instant(when):
    """An instant survives to the microsecond; the zone in which it was said does not count."""
    try:
        in_utc = when.astimezone(UTC)
    except OverflowError:  # Hours of the year 10000 in UTC: kept in the zone they came in.
        in_utc = when
    assert through_json(SetClock(instant=when)).instant == in_utc
    assert to_plain(SetClock(instant=when)) == to_plain(SetClock(instant=in_utc))


def test_a_zone_of_odd_seconds_keeps_the_instant():
    """Prague before 1891 was 57 min 44 s ahead: an offset that ISO forms often cut short."""
    when = datetime(1850, 1, 1, 12, tzinfo=ZoneInfo("Europe/Prague"))
    assert through_json(SetClock(instant=when)).instant == when.astimezone(UTC)


def test_tuples_and_arrays_come_back_as_they_were():
    """Nested tuples, and an array by its content's digest."""
    echo = Echo(value=0.25, wave=Array(np.arange(72, dtype=np.float16).reshape(6, 2, 2, 3)))
    assert through_json(echo) == echo
    assert through_json(SUN_LIGHT) == SUN_LIGHT


def test_a_field_of_floats_holds_floats():
    """A whole number there becomes 1.0, also in a tuple; elsewhere it stays as it is."""
    plain = to_plain(sun_at(1))
    assert repr(plain["elevation_rad"]) == "1.0"
    assert repr(to_plain(MoveCamera(eye_m=(1, 2, 3), target_m=(0, 0, 0)))["eye_m"][0]) == "1.0"
    assert repr(to_plain(SetSetting(module="m", name="n", value=1))["value"]) == "1"


@pytest.mark.parametrize("dtype", ["?", "u1", "<i8", "<f2", "<f4", ">f8"])
def test_a_sample_spans_the_array(dtype):
    """32 values evenly spaced from the first to the last, whatever their type."""
    values = np.arange(100).astype(dtype)
    plain = to_plain(Echo(value=0.0, wave=Array(values)))["wave"]
    assert len(plain["sample"]) == 32
    assert plain["sample"][0] == values[0]
    assert plain["sample"][-1] == values[-1]
    assert plain["shape"] == [100]


def test_small_and_empty_arrays_are_sampled_whole():
    """Fewer than 32 values are all taken; none is no error."""
    assert to_plain(Array(np.array(3.5)))["sample"] == [3.5]
    assert to_plain(Array(np.zeros((0, 3))))["sample"] == []


def test_the_digest_counts_content_and_type_and_not_samples():
    """Equal content, equal digest; a sample of another length is no other message."""
    plain = to_plain(Echo(value=1.0, wave=Array(np.arange(9.0))))
    assert digest_of("Echo", plain) == digest_of("Echo", plain | {"wave": plain["wave"]})
    shorter = plain | {"wave": plain["wave"] | {"sample": []}}
    assert digest_of("Echo", plain) == digest_of("Echo", shorter)
    assert digest_of("Echo", plain) != digest_of("Ohce", plain)
    assert digest_of("Echo", plain) != digest_of("Echo", plain | {"value": 2.0})


def test_a_traceback_is_not_recorded():
    """It names the files of one checkout: a fault must replay equal in another."""
    fault = Fault(module="m", where="w", error="e", trace="File /somewhere, line 3")
    assert "trace" not in to_plain(fault)


def test_a_value_without_plain_form_is_named_and_never_made_again():
    """A job may return any object; a journal remembers its type alone, and runs no code of it."""
    plain = to_plain(JobResult(module="m", job="j", value=threading.Lock()))
    assert plain["value"] == {"$opaque": "lock"}
    with pytest.raises(UserError, match="type lock is known by name only"):
        decode(JobResult, plain)


@pytest.mark.parametrize(
    ("kind", "plain", "says"),
    [
        (SetPlace, {"latitude_deg": 1.0}, "SetPlace: .*missing required field `longitude_deg`"),
        (SetPlace, {"latitude_deg": "N", "longitude_deg": 0}, r"SetPlace: .*\$.latitude_deg"),
        (SetPlace, {"latitude": 1.0}, "SetPlace has no field 'latitude'"),
        (SetPlace, [1, 2], "SetPlace: Expected `object`"),
        (SetClock, {"instant": "noon"}, "SetClock: Invalid RFC3339"),
        (SetSetting, {"module": "m", "name": "n", "value": 10**400}, "more than 64 bits"),
        (Poke, {"value": {"$array": "00"}}, "lacks the array 00"),
    ],
)
def test_a_message_that_does_not_fit_names_its_type_and_field(kind, plain, says):
    """One sentence that says which message and which field, for journals of other versions."""
    with pytest.raises(UserError, match=says):
        decode(kind, plain)


def test_the_registry_knows_the_kernels_types_and_those_of_modules():
    """A journal names types; only those of the kernel and of its modules are found."""
    registry = Registry([Parrot])
    assert registry.find("SetClock") is SetClock
    assert registry.find("Echo") is Echo
    assert registry.find_input("Poke") is Poke
    with pytest.raises(UserError, match="'Popen' is unknown"):
        registry.find("Popen")
    with pytest.raises(UserError, match="Echo is no input"):
        registry.find_input("Echo")


def test_two_types_of_one_name_are_refused():
    """A journal could mean either."""

    class SetClock(Input, frozen=True, kw_only=True):
        hour: int

    class Clockwork(Module):
        manifest = Manifest(name="clockwork", title="Clockwork", version="1")

        @handles(SetClock)
        def on_clock(self, message):
            pass

    with pytest.raises(UserError, match="two message types are called SetClock"):
        Registry([Clockwork])
