"""A sample of each message type that crosses, and ways to damage its frame."""

import msgspec
import numpy as np
from zenoh_bridge.array_store import unpacked

from vrut_lite.array import Array
from vrut_lite.errors import UserError
from vrut_lite.messages.scene import SceneNeeds
from vrut_lite.messages.sky import AmbientChanged, BackgroundChanged
from vrut_lite.messages.sun import KeyLightChanged, SunMoved

CUBE = Array(np.linspace(0, 9, 6 * 8 * 8 * 3).astype(np.float16).reshape(6, 8, 8, 3))
HARMONICS = Array(np.linspace(-1, 1, 75).astype(np.float32).reshape(25, 3))
SUN = SunMoved(
    direction=(0.0, 0.6, -0.8),
    azimuth_rad=3.141592653589793,
    elevation_rad=0.6435,
    apparent_elevation_rad=0.644,
    visible_disc_fraction=1.0,
)
BACKGROUND = BackgroundChanged(
    cube=CUBE, radiance_scale=0.25, ground_radiance_rgb=(1.0, 2.0, 1e-300), source="sample"
)
SUN_LIGHT = KeyLightChanged(
    direction=(0.0, 0.6, -0.8),
    irradiance_rgb=(500.0, 480.0, 400.0),
    angular_radius_rad=0.00465,
    limb_darkening_rgb=((0.3, 0.9), (0.4, 0.8), (0.5, 0.7)),
    source="sample",
)
AMBIENT = AmbientChanged(irradiance_sh_rgb=HARMONICS, source="sample")
NEEDS = SceneNeeds(sky_in_view=True, visible_faces=(0, 2), receives_light=False)
SAMPLES = [SUN, BACKGROUND, SUN_LIGHT, AMBIENT, NEEDS]
ARRAYS = {array.digest: array for array in (CUBE, HARMONICS)}

_ODD = [None, True, -1, 2**63, 10**30, 1e308, "", "parrot", "\ud7ff" * 100, [], [[[]]], {}]
_TAGS = [{"$array": "00"}, {"$array": []}, {"$float": "nan"}, {"$float": 3}, {"$opaque": 1}]


def known_array(handle):
    """The array that a fetch would return."""
    array = ARRAYS.get(handle["$array"])
    if array is None:
        raise UserError("nobody had it")
    return unpacked(array.values.tobytes(), handle, 2**20)


def mangled(frame, dice):
    """A frame with bytes flipped or cut, or its JSON changed; nearly always different."""
    return dice.choice([_flipped, _cut, _rewritten, _rewritten])(frame, dice)


def _flipped(frame, dice):
    spoilt = bytearray(frame)
    for _ in range(dice.choice([1, 1, 2, 8])):
        spoilt[dice.randrange(len(spoilt))] ^= 1 << dice.randrange(8)
    return bytes(spoilt)


def _cut(frame, dice):
    start = dice.randrange(len(frame))
    return frame[:start] + frame[start + dice.randrange(1, 40) :]


def _rewritten(frame, dice):
    content = msgspec.json.decode(frame)
    places = [content, content["message"], content["message"]]
    places += [value for value in content["message"].values() if isinstance(value, dict)]
    place = dice.choice(places)
    name = dice.choice(list(place))
    if dice.random() < 0.3:
        place[dice.choice([name + "x", "__class__", "$array"])] = place.pop(name)
    else:
        place[name] = dice.choice(_ODD + _TAGS)
    return msgspec.json.encode(content)
