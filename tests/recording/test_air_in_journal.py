"""A message that holds a structure with arrays: recorded, told apart by digest, and read back."""

import msgspec
import numpy as np
import pytest
from light_messages import small_air

from vrut_lite.daylight.air import AirChanged
from vrut_lite.errors import UserError
from vrut_lite.recording.codec import arrays_of, decode, digest_of, to_plain


def air(first=1.0):
    """A small volume of air."""
    values = np.full((3, 3, 4, 2, 3), 0.5, np.float16)
    values[0, 0, 0, 0, 0] = first
    return small_air(values, observer_altitude_m=0.0)


@pytest.mark.parametrize("message", [air(), AirChanged(volume=None, source="sample")])
def test_air_comes_back_as_it_went(message):
    """Through JSON and back the message must be equal, with its arrays by their digests:
    whole numbers in fields of floats would make it another."""
    arrays = {array.digest: array for array in arrays_of(message)}
    assert len(arrays) == (3 if message.volume else 0)
    plain = msgspec.json.decode(msgspec.json.encode(to_plain(message)))
    back = decode(AirChanged, plain, lambda handle: arrays[handle["$array"]])
    assert back == message
    assert digest_of("AirChanged", plain) == digest_of("AirChanged", to_plain(back))


def test_arrays_inside_count():
    """One other value in an array of the structure must make another digest."""
    one, other = (digest_of("AirChanged", to_plain(air(first))) for first in (1.0, 1.5))
    assert one != other


def test_unknown_fields_inside_are_refused():
    """A field that the structure lacks is no less unknown than one of the message."""
    message = air()
    arrays = {array.digest: array for array in arrays_of(message)}
    plain = to_plain(message)
    plain["volume"]["weight"] = 1.0
    with pytest.raises(UserError, match="weight"):
        decode(AirChanged, plain, lambda handle: arrays[handle["$array"]])
