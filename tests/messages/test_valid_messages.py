"""`Message.check()` passes valid messages and refuses others in a sentence with field and value."""

import msgspec
import numpy as np
import pytest
from message_samples import NEVER_POSTED, NOON, SOUND, kernel_that_posts, named
from probe_messages import act, collect, faults_of

from vrut_lite.array import Array
from vrut_lite.errors import UserError
from vrut_lite.kernel.bus import Kernel
from vrut_lite.kernel.messages import (
    KERNEL_MESSAGES,
    ClockMoved,
    Demand,
    Derived,
    Message,
    SetClock,
    SetClockRate,
    Tick,
)
from vrut_lite.messages.camera import MoveCamera
from vrut_lite.messages.gpu_job import GpuJob
from vrut_lite.messages.ground import SetGround
from vrut_lite.messages.haze import SetHaze
from vrut_lite.messages.light_map import (
    LightMapLaid,
    SurfaceLightChanged,
)
from vrut_lite.messages.picture import Resize, SetExposure
from vrut_lite.messages.place import SetPlace
from vrut_lite.messages.sky import (
    BackgroundChanged,
    LookAround,
    SpectrumSeen,
)
from vrut_lite.messages.sun import KeyLightChanged, SunMoved
from vrut_lite.messages.vocabulary import DAYLIGHT_MESSAGES


def test_every_type_has_a_sample():
    """Every type of message has a sample for these tests."""
    said = {*KERNEL_MESSAGES, *DAYLIGHT_MESSAGES}
    assert said == {type(message) for message in SOUND} | set(NEVER_POSTED)
    for kind in said - set(NEVER_POSTED):
        assert kind.check is not Message.check, kind


@pytest.mark.parametrize("message", SOUND, ids=named)
def test_valid_messages_are_delivered(message):
    """Valid inputs are admitted, valid derived messages posted."""
    message.check()
    message.check_arrays()
    if isinstance(message, Derived):
        kernel = kernel_that_posts(message)
        heard, faults = collect(kernel, type(message)), faults_of(kernel)
        act(kernel, Tick(elapsed_s=1.0))
        assert heard == [message]
        assert not [fault for fault in faults if fault is not message]


@pytest.mark.parametrize(
    ("message", "changes", "says"),
    [
        (SetPlace, {"latitude_deg": True}, "latitude_deg of a place must lie from -90 to 90, not"),
        (SetPlace, {"latitude_deg": "50"}, "from -90 to 90, not '50'"),
        (SetHaze, {"optical_depth_550": 1.0}, "optical_depth_550 of haze must lie from 0 to 0.9"),
        (SetGround, {"albedo": 1.5}, "albedo of ground must lie from 0 to 1, not 1.5"),
        (SetGround, {"ground": "moss"}, "ground of the scene must be one of scene, grey"),
        (SetHaze, {"aerosol": "suburban"}, "aerosol of haze must be one of continental"),
        (SetClockRate, {"rate": np.float16("inf")}, "rate must be a finite number, not inf"),
        (KeyLightChanged, {"irradiance_rgb": (np.float16("inf"),) * 3}, "three finite numbers"),
        (SetPlace, {"altitude_m": 10**5000}, "not a int"),
        (MoveCamera, {"eye_m": (1.0, 2.0)}, "eye_m of a camera must be three finite numbers"),
        (MoveCamera, {"eye_m": np.zeros(3)}, "eye_m of a camera must be three finite numbers"),
        (Resize, {"width_px": 10**9}, "width_px of Resize must be a whole number from 1 to 16384"),
        (Resize, {"width_px": 64.0}, "whole number from 1 to 16384, not 64.0"),
        (Demand, {"size": 5000}, "size of Demand must be a whole number from 0 to 4096, not 5000"),
        (SetExposure, {"ev100": 1e6}, "ev100 of SetExposure must lie from -100 to 100"),
        (SetExposure, {"tone_map": "x"}, "must be one of agx, exponential, none, not 'x'"),
        (SunMoved, {"direction": (0.0, 3.0, 0.0)}, "direction of SunMoved must be a unit vector"),
        (KeyLightChanged, {"limb_darkening_rgb": ((1.0,) * 7,) * 3}, "3 polynomials of 1 to 6"),
        (KeyLightChanged, {"limb_darkening_rgb": ((),) * 3}, "3 polynomials of 1 to 6"),
        (KeyLightChanged, {"irradiance_rgb": (-1.0, 0.0, 0.0)}, "three numbers from 0 to 1e+10"),
        (KeyLightChanged, {"angular_radius_rad": 0.0}, "must lie from 1e-06 to 1.5708, not 0.0"),
        (BackgroundChanged, {"cube": Array(np.ones((6, 4, 5, 3), "f2"))}, "cube of BackgroundCh"),
        (BackgroundChanged, {"radiance_scale": 0.0}, "radiance_scale of BackgroundChanged must"),
        (LookAround, {"size": 3}, "size of LookAround must be even"),
        (LookAround, {"wavelength_nm": (500.0, 400.0)}, "wavelength_nm of LookAround must rise"),
        (LookAround, {"wavelength_nm": (300.0, 400.0)}, "wavelength_nm of LookAround must rise"),
        (SpectrumSeen, {"radiance": (1.0,)}, "radiance of SpectrumSeen must be two finite numbers"),
        (GpuJob, {"size": 2**20}, "size of GpuJob must be a whole number from 1 to 16384"),
        (LightMapLaid, {"size_px": (8,)}, "size_px of LightMapLaid must be 2 whole numbers from 1"),
        (LightMapLaid, {"size_px": (8, 5)}, "ground of LightMapLaid must lie within (8, 5) texels"),
        (LightMapLaid, {"uv": Array(np.ones((4, 2), "f4"))}, "must be <f4 of shape ('V', 2)"),
        (SurfaceLightChanged, {"mirrors": Array(np.ones((1, 6, 4, 5, 4), "f2"))}, "mirrors of S"),
        (SurfaceLightChanged, {"visible_sky": Array(np.ones((6, 7, 4), "f2"))}, "visible_sky of S"),
        (SurfaceLightChanged, {"texels": Array(np.ones((0, 8, 4), "f2"))}, "edges of 1 to 16384"),
        (GpuJob, {"buffers": ((1, Array(np.zeros(3))),)}, "a binding and an array of float32"),
    ],
)  # fmt: skip
def test_a_sentence_names_field_and_value(message, changes, says):
    """The sentence names the field, its value and the allowed range."""
    sample = next(one for one in SOUND if type(one) is message)
    with pytest.raises(UserError) as told:
        msgspec.structs.replace(sample, **changes).check()
    assert says in str(told.value)


def test_numbers_of_numpy_are_numbers():
    """The kernel's clock can compute with numpy's numbers that pass the check."""
    kernel = Kernel()
    faults = faults_of(kernel)
    act(kernel, SetClock(instant=NOON), SetClockRate(rate=np.float32(60.0)))
    act(kernel, Tick(elapsed_s=np.float16(0.5)), Tick(elapsed_s=np.int8(2)), Tick(elapsed_s=1))
    assert not faults
    assert (kernel.last(ClockMoved).instant - NOON).total_seconds() == 60.0 * 3.5
