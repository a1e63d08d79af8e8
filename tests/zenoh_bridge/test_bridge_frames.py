"""Frames: valid messages survive the round trip, others are refused in one clear line."""

import random

import msgspec
import numpy as np
import pytest
from bridge_samples import ARRAYS, BACKGROUND, CUBE, SAMPLES, SUN, known_array, mangled
from zenoh_bridge.array_store import ArrayStore, unpacked
from zenoh_bridge.frames import encode_frame, read_frame, remote_message
from zenoh_bridge.inputs import RemoteMessage
from zenoh_bridge.shareable import revive, types_named

from vrut_lite.array import Array
from vrut_lite.errors import UserError
from vrut_lite.message_codec import to_plain
from vrut_lite.messages.gpu_texture import GpuTexture
from vrut_lite.messages.sky import BackgroundChanged

KIB, MIB = 2**10, 2**20


def received(frame, type_name):
    """The message in a frame."""
    remote = remote_message(read_frame(frame, type_name, 64 * KIB, MIB), known_array)
    return revive(remote.type_name, remote.fields)


def refusal(frame, type_name):
    """The sentence with which a frame is refused, or None if it is accepted."""
    try:
        received(frame, type_name)
    except UserError as error:
        return str(error)
    return None


@pytest.mark.parametrize("message", SAMPLES, ids=lambda message: type(message).__name__)
def test_a_message_comes_back_as_it_was(message):
    """Messages are equal to the last bit, types included."""
    frame = encode_frame(message, 64 * KIB)
    back = received(frame, type(message).__name__)
    assert back == message
    assert type(back) is type(message)
    assert repr(back) == repr(message)


def test_500_mangled_frames_each_get_one_clear_line():
    """Each damaged frame is refused in one sentence, or is a valid message."""
    dice = random.Random(20260621)
    refused = 0
    for _ in range(500):
        message = dice.choice(SAMPLES)
        name = type(message).__name__
        sentence = refusal(mangled(encode_frame(message, 64 * KIB), dice), name)
        if sentence is not None:
            refused += 1
            assert sentence.startswith(f"a frame of {name} was refused: ")
            assert sentence.isprintable()
            assert len(sentence) < 400
    # The others differ only in a digit or a letter of a text.
    assert refused > 400


def frame_of(**changes):
    """The sample background's frame with other content."""
    content = msgspec.json.decode(encode_frame(BACKGROUND, 64 * KIB))
    content["message"].update(changes.pop("message", {}))
    return msgspec.json.encode(content | changes)


def cube_handle(**changes):
    return {"message": {"cube": to_plain(CUBE) | changes}}


@pytest.mark.parametrize(
    ("frame", "says"),
    [
        (b"", "Input data was truncated"),
        (b"[" * 60_000, "Expected `object`, got `array`"),
        (b'{"version":1,"type_name":"BackgroundChanged","message":' + b'{"a":' * 12_000, "refused"),
        (b" " * (64 * KIB + 1), "65537 bytes: raise max_message_kib"),
        (frame_of(version=2), "version 2, not 1"),
        (frame_of(type_name="SetSetting"), "holds a 'SetSetting'"),
        (frame_of(code="import os"), "unknown field `code`"),
        (frame_of(message={"exec": "rm"}), "has no field 'exec'"),
        (
            frame_of(message={"radiance_scale": {"$float": "nan"}}),
            "radiance_scale of BackgroundChanged",
        ),
        (frame_of(message={"ground_radiance_rgb": [0, 1]}), "ground_radiance_rgb"),
        (frame_of(message={"cube": {"size": 8, "format": "rgba16f", "recipe": "00"}}), "no array"),
        (frame_of(message={"cube": [to_plain(CUBE)] * 99}), "more than 4 arrays"),
        (frame_of(message={"cube": {"$opaque": "Popen"}}), "known by name only"),
        (frame_of(**cube_handle(dtype="|O")), "not a plain number"),
        (frame_of(**cube_handle(dtype="|f1")), "which there is not"),
        (frame_of(**cube_handle(shape=[6, 2**62, 2**62, 3])), "raise max_array_mib"),
        (
            frame_of(**cube_handle(shape=[6, 8, 4, 3])),
            "cube of BackgroundChanged must be an array (6, up to",
        ),
        (
            frame_of(**cube_handle(shape=[6, 0, 0, 3])),
            "cube of BackgroundChanged must be an array (6, up to",
        ),
        (
            frame_of(**cube_handle(dtype="<f8")),
            "cube of BackgroundChanged must be an array (6, up to",
        ),
        (frame_of(message={"cube": {"$array": "../../etc", "dtype": "<f2"}}), "no digest"),
    ],
)
def test_a_forged_frame_is_refused_by_name(frame, says):
    """Unknown types, wrong sizes, fields and shapes are refused."""
    sentence = refusal(frame, "BackgroundChanged")
    assert sentence is not None
    assert says in sentence


@pytest.mark.parametrize("name", ["Fault", "SetSetting", "GpuJob", "JobResult", "Popen"])
def test_no_other_type_can_cross(name):
    """Types that control this process are refused."""
    with pytest.raises(UserError, match="cannot cross"):
        revive(name, {})
    with pytest.raises(UserError, match=f"'{name}', which cannot cross: choose from SunMoved"):
        types_named(f"SunMoved, {name}", "share")


def test_gpu_textures_do_not_cross():
    """GPU textures are not part of the message: the other side would show nothing."""
    texture = GpuTexture(size=8, format="rgba16f", recipe="00")
    background = msgspec.structs.replace(BACKGROUND, cube=texture)
    with pytest.raises(UserError, match="stays on the GPU"):
        encode_frame(background, 64 * KIB)


def test_a_message_that_is_too_large_is_not_sent():
    """The sender refuses what the receiver would refuse."""
    with pytest.raises(UserError, match=r"SunMoved takes .* bytes: raise max_message_kib"):
        encode_frame(SUN, 100)


def test_bytes_that_do_not_match_the_digest_are_refused():
    """Bytes that are too few, too many or different are refused, by size, then by digest."""
    handle, data = to_plain(CUBE), CUBE.values.tobytes()
    assert unpacked(data, handle, MIB) == CUBE
    dice = random.Random(3)
    for spoilt in (data[:-1], data + b"\0", b"", *(_flip(data, dice) for _ in range(100))):
        with pytest.raises(UserError, match="came with"):
            unpacked(spoilt, handle, MIB)
    with pytest.raises(UserError, match="larger than 100 bytes"):
        unpacked(data, handle, 100)


def _flip(data, dice):
    place = dice.randrange(len(data))
    return data[:place] + bytes([data[place] ^ 1]) + data[place + 1 :]


def test_the_store_holds_the_last_arrays_within_its_bounds():
    """Memory is bounded; the least recently used arrays are dropped first."""
    arrays = [Array(np.full(1000, n, np.uint8)) for n in range(40)]
    store = ArrayStore(max_bytes=3000)
    for array in arrays[:3]:
        store.keep(array)
    assert store.find(arrays[0].digest) is arrays[0]
    store.keep(arrays[3])
    assert store.find(arrays[1].digest) is None
    assert store.find(arrays[0].digest) is arrays[0]
    roomy = ArrayStore(max_bytes=MIB)
    for array in arrays:
        roomy.keep(array)
    assert len(roomy) == 32


def test_an_array_larger_than_the_store_is_kept_alone():
    """The last array can be fetched, whatever its size."""
    store = ArrayStore(max_bytes=10)
    large = Array(np.zeros(1000, np.uint8))
    store.keep(CUBE)
    store.keep(large)
    assert store.find(large.digest) is large
    assert len(store) == 1


def test_the_input_is_one_per_type():
    """Only the latest of the waiting messages of a type is delivered, from any sender."""
    assert RemoteMessage(type_name="SunMoved", fields={}).key() == "SunMoved"
    assert set(ARRAYS) == {CUBE.digest, SAMPLES[3].irradiance_sh_rgb.digest}
    assert BackgroundChanged.slot == "sky"
