"""Arrays of messages: their shapes fit each other, their values and references are checked."""

import math

import msgspec
import numpy as np
import pytest
from light_messages import second_light, small_air
from message_samples import AIR, AIR_LIGHT, LAID, SOUND, SURFACE_LIGHT, named, spoilt

from vrut_lite.array import Array
from vrut_lite.errors import UserError
from vrut_lite.messages.air import AirChanged
from vrut_lite.messages.sky import (
    AmbientChanged,
)


@pytest.mark.parametrize(
    ("slices", "bodies", "fits"),
    [
        (2, 1, True), (682, 1, True), (683, 1, False), (2000, 1, False), (1, 1, False),
        (2, 2, True), (341, 2, True), (342, 2, False), (1, 2, False),
    ],
)  # fmt: skip
def test_air_fits_a_3d_texture(slices, bodies, fits):
    """The three kinds of light share one 3-D texture of at most 2048 layers; with those of a second
    body there is room for half as many slices."""
    light = Array(np.ones((3, slices, 4, 2, 3), np.float16))
    extinction = Array(np.ones((slices, 4, 3), np.float32))
    second = second_light(light.values.copy()) if bodies == 2 else None
    volume = msgspec.structs.replace(AIR, light=light, extinction=extinction, second=second)
    message = AirChanged(volume=volume, source="s")
    if fits:
        message.check()
        return
    with pytest.raises(UserError, match="extinction of AirVolume must"):
        message.check()


@pytest.mark.parametrize("odd", [math.nan, math.inf, -math.inf, 6e4])
@pytest.mark.parametrize("name", ["cube", "light", "second", "extinction", "irradiance_sh_rgb"])
def test_values_of_arrays_are_checked_on_request(name, odd):
    """`check_arrays` finds a single invalid value in an array."""
    sample = {
        "cube": SOUND[[named(m) for m in SOUND].index("BackgroundChanged")],
        "light": AirChanged(volume=AIR, source="s"),
        "second": small_air(AIR_LIGHT, second=second_light(AIR_LIGHT)),
        "extinction": AirChanged(volume=AIR, source="s"),
        "irradiance_sh_rgb": AmbientChanged(
            irradiance_sh_rgb=Array(np.ones((25, 3), np.float64)), source="s"
        ),
    }[name]
    place = ("volume", name) if isinstance(sample, AirChanged) else (name,)
    carrier = sample.volume if len(place) == 2 else sample
    if name == "second":
        place, carrier, name = (*place, "light"), carrier.second, "light"
    values = getattr(carrier, name).values.copy()
    values.ravel()[values.size // 2] = odd * (1e30 if name == "irradiance_sh_rgb" else 1.0)
    changed = spoilt(sample, place, Array(values))
    if odd == 6e4 and name in ("cube", "light"):
        # Large numbers, but times this scale within the limit of light.
        changed.check_arrays()
        changed = spoilt(changed, (*place[:-1], "radiance_scale"), 1e9)
    changed.check()
    with pytest.raises(UserError, match=f"{name} of .* must hold numbers from"):
        changed.check_arrays()


@pytest.mark.parametrize(
    ("changes", "says"),
    [
        ({"part": np.array([2], np.int32)}, "mirrors of a LightMapLaid must name parts"),
        ({"centre_m": np.full((1, 3), np.nan)}, "centre_m of ReflectionProbes must hold numbers"),
        (
            {"nearness": np.full((1, 6, 4, 4), -1.0, np.float32)},
            "nearness of ReflectionProbes must hold",
        ),
    ],
)
def test_mirrors_of_a_light_map_name_its_parts(changes, says):
    """A cube is of a part of the scene, from a finite place, and nothing is nearer than that."""
    odd = msgspec.structs.replace(
        LAID.mirrors, **{name: Array(values) for name, values in changes.items()}
    )
    odd.check()
    with pytest.raises(UserError, match=says):
        msgspec.structs.replace(LAID, mirrors=odd).check_arrays()


def test_light_fits_a_layout_with_as_many_mirrors():
    """Light belongs to that one of two layouts of a name whose cubes have its sizes."""
    assert SURFACE_LIGHT.fits(LAID)
    assert not msgspec.structs.replace(SURFACE_LIGHT, mirrors=None).fits(LAID)
    assert not SURFACE_LIGHT.fits(msgspec.structs.replace(LAID, mirrors=None))


@pytest.mark.parametrize(
    ("changes", "says"),
    [
        ({"shapes": np.array([[0, 1, 3, 0, 1]])}, "shapes of a LightMapLaid reach beyond"),
        ({"triangles": np.array([[0, 1, 3]], np.int32)}, "triangles of a LightMapLaid reach"),
        ({"part_shape": np.array([0, 1], np.int32)}, "names a shape that is not there"),
        ({"source_vertex": np.array([0, -1, 2], np.int32)}, "names what no mesh has"),
        ({"uv": np.full((3, 2), np.nan, np.float32)}, "uv of a LightMapLaid must hold finite"),
    ],
)
def test_arrays_of_a_light_map_refer_to_each_other(changes, says):
    """Shapes and parts must name existing rows: the frame never reads beyond the arrays."""
    odd = msgspec.structs.replace(LAID, **{name: Array(v) for name, v in changes.items()})
    odd.check()
    with pytest.raises(UserError, match=says):
        odd.check_arrays()


@pytest.mark.parametrize(
    "changes",
    [
        {"layout_key": "m"},
        {"texels": Array(np.ones((6, 7, 4), np.float16))},
        {"probes": None},
        {"probes": Array(np.ones((3, 2, 4, 6, 4), np.float16))},
    ],
)
def test_light_of_another_layout_does_not_fit(changes):
    """Light whose name or size differs from the layout's does not fit it."""
    assert SURFACE_LIGHT.fits(LAID)
    assert not msgspec.structs.replace(SURFACE_LIGHT, **changes).fits(LAID)
