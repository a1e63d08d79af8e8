"""Air between two processes: two arrays in a structure, and refusals."""

import msgspec
import numpy as np
import pytest
from air_phases import lobe
from bridge_samples import BACKGROUND
from light_messages import second_light, small_air
from zenoh_bridge.frames import encode_frame, read_frame, remote_message
from zenoh_bridge.shareable import revive

from vrut_lite.array import Array
from vrut_lite.errors import UserError
from vrut_lite.message_codec import arrays_of, to_plain
from vrut_lite.messages.air import AirChanged
from vrut_lite.messages.gpu_texture import GpuTexture
from vrut_lite.messages.sky import ViewShader

LIGHT = np.linspace(0, 9, 3 * 3 * 4 * 2 * 3).astype(np.float16).reshape(3, 3, 4, 2, 3)
AIR = small_air(LIGHT.copy(), sun_direction=(0.0, 0.6, -0.8))
AIR_OF_TWO = small_air(LIGHT.copy(), second=second_light(LIGHT.copy()))
NO_AIR = AirChanged(volume=None, source="sample")


def fetched(message):
    """A message's arrays as a fetch would return them."""
    arrays = {array.digest: array for array in arrays_of(message)}
    return lambda handle: arrays[handle["$array"]]


@pytest.mark.parametrize("message", [AIR, AIR_OF_TWO, NO_AIR])
def test_air_crosses(message):
    """Air arrives as it was sent, its arrays fetched by digest."""
    frame = read_frame(encode_frame(message, 2**16), "AirChanged", 2**16, 2**20)
    fields = remote_message(frame, fetched(message)).fields
    assert revive("AirChanged", fields) == message


def test_air_that_stays_on_the_gpu_does_not_cross():
    """GPU textures are not part of the message: the other side would have nothing to draw."""
    texture = GpuTexture(size=(2, 4, 9), format="rgba32f", recipe="00")
    volume = msgspec.structs.replace(AIR.volume, light=texture)
    with pytest.raises(UserError, match="stays on the GPU"):
        encode_frame(msgspec.structs.replace(AIR, volume=volume), 2**16)


def test_a_stranger_s_shader_does_not_cross():
    """The cube map of a sky seen from aloft arrives; its shader does not."""
    view = ViewShader(
        source="vec3 background_radiance(vec3 d) { return d; }",
        uniforms={"background_shape": (1, 2, 3)},
        buffers=((1, Array(np.zeros((4, 8), np.float32))),),
    )
    aloft = msgspec.structs.replace(BACKGROUND, view=view, ground_through_air=True)
    frame = read_frame(encode_frame(aloft, 2**16), "BackgroundChanged", 2**16, 2**20)
    fields = remote_message(frame, fetched(aloft)).fields
    assert revive("BackgroundChanged", fields) == msgspec.structs.replace(aloft, view=None)


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"reach_m": float("nan")}, "reach_m of AirVolume must lie from 0.001 to 1e.10, not nan"),
        ({"sun_direction": (0.0, float("inf"), 0.0)}, "sun_direction of AirVolume must be three"),
        ({"sun_direction": (0.0, 0.6, 0.0)}, "sun_direction of AirVolume must be a unit vector"),
        ({"reach_m": 0.0}, "reach_m of AirVolume"),
        ({"observer_altitude_m": -1000.0}, "observer_altitude_m of AirVolume"),
        ({"aerosol_phase": lobe(angles=1)}, "aerosol_phase of AirVolume must have two angles"),
        ({"rows_above": 1, "rows_below": 3}, "rows_above of AirVolume must be a whole number"),
        ({"rows_above": 3}, r"extinction of AirVolume must be an array \(up to 682, 5, 3\)"),
        ({"columns": 3}, r"light of AirVolume must be an array \(3, 3, 4, 3, 3\) of float16"),
        ({"light": Array(LIGHT[:, :2].copy())}, "light of AirVolume"),
        ({"light": Array(LIGHT[..., 0].copy())}, "light of AirVolume"),
        ({"light": Array(LIGHT.astype(np.float32))}, "light of AirVolume"),
        ({"light": GpuTexture(size=(2, 4, 9), format="rgba16f", recipe="")}, "no array"),
        ({"extinction": Array(np.ones((4, 3, 3), np.float32))}, "extinction of AirVolume"),
    ],
)
def test_forged_air_is_refused(changes, said):
    """Tables of inconsistent shapes are refused: a renderer would read past their ends."""
    forged = msgspec.structs.replace(AIR, volume=msgspec.structs.replace(AIR.volume, **changes))
    with pytest.raises(UserError, match=said):
        revive("AirChanged", to_plain(forged), fetched(forged))
