"""A message that holds a structure with arrays: recorded, told apart by digest, and read back."""

import msgspec
import numpy as np
import pytest
from light_messages import second_light, small_air

from vrut_lite.errors import UserError
from vrut_lite.message_codec import arrays_of, decode, digest_of, to_plain
from vrut_lite.messages.air import AirChanged
from vrut_lite.recording.earlier_names import in_todays_words


def air(first=1.0, second=None):
    """A small volume of air; with so much light of a second body."""
    values = np.full((3, 3, 4, 2, 3), 0.5, np.float16)
    values[0, 0, 0, 0, 0] = first
    other = None if second is None else second_light(np.full_like(values, second))
    return small_air(values, observer_altitude_m=0.0, second=other)


@pytest.mark.parametrize("message", [air(), air(second=2.0), AirChanged(volume=None, source="s")])
def test_air_comes_back_as_it_went(message):
    """Through JSON and back the message must be equal, with its arrays by their digests:
    whole numbers in fields of floats would make it another."""
    arrays = {array.digest: array for array in arrays_of(message)}
    assert len(arrays) == (0 if not message.volume else 3 + (message.volume.second is not None))
    plain = msgspec.json.decode(msgspec.json.encode(to_plain(message)))
    back = decode(AirChanged, plain, lambda handle: arrays[handle["$array"]])
    assert back == message
    assert digest_of("AirChanged", plain) == digest_of("AirChanged", to_plain(back))


def test_arrays_inside_count():
    """One other value in an array must make another digest, however deep the array lies."""
    sorts = [air(), air(1.5), air(second=1.0), air(second=1.5)]
    assert len({digest_of("AirChanged", to_plain(message)) for message in sorts}) == len(sorts)


def test_air_of_earlier_journals_has_one_body():
    """A journal from before air had a second body must be read as air that one body lights."""
    plain = to_plain(air())
    earlier = {**plain, "volume": {k: v for k, v in plain["volume"].items() if k != "second"}}
    assert in_todays_words("AirChanged", earlier) == ("AirChanged", plain)


def test_unknown_fields_inside_are_refused():
    """A field that the structure lacks is no less unknown than one of the message."""
    message = air()
    arrays = {array.digest: array for array in arrays_of(message)}
    plain = to_plain(message)
    plain["volume"]["weight"] = 1.0
    with pytest.raises(UserError, match="weight"):
        decode(AirChanged, plain, lambda handle: arrays[handle["$array"]])
