"""`Message.check()`: valid messages pass, everything else is refused in one sentence."""

import contextlib
import math
from datetime import UTC, datetime

import msgspec
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from probe_messages import act, collect, faults_of

from vrut_lite.array import Array
from vrut_lite.checks import refusal_of
from vrut_lite.daylight.air import AirChanged, AirVolume
from vrut_lite.daylight.camera import MoveCamera
from vrut_lite.daylight.clouds import CloudLayer, CloudsChanged
from vrut_lite.daylight.gpu_job import GpuJob
from vrut_lite.daylight.gpu_texture import GpuTexture
from vrut_lite.daylight.ground_disc import GroundDisc
from vrut_lite.daylight.haze import SetHaze
from vrut_lite.daylight.light_map import (
    GroundChart,
    LightMapLaid,
    Mirrors,
    ProbeGrid,
    SurfaceLightChanged,
)
from vrut_lite.daylight.picture import PictureClicked, Resize, SetExposure
from vrut_lite.daylight.place import SetPlace
from vrut_lite.daylight.scene import LoadScene, SceneNeeds, SceneOpened
from vrut_lite.daylight.scene_content import SceneGeometry, SceneMaterials
from vrut_lite.daylight.sky import (
    AmbientChanged,
    BackgroundChanged,
    LookAlong,
    SkyRadianceChanged,
    SpectrumSeen,
    ViewShader,
)
from vrut_lite.daylight.sky_light import SkyLightChanged
from vrut_lite.daylight.sun import KeyLightChanged, SunMoved
from vrut_lite.daylight.tolerance import SetTolerance
from vrut_lite.daylight.vocabulary import DAYLIGHT_MESSAGES
from vrut_lite.errors import UserError
from vrut_lite.kernel.bus import Kernel
from vrut_lite.kernel.messages import (
    KERNEL_MESSAGES,
    ChooseSlot,
    ClockMoved,
    Demand,
    Derived,
    EnableModule,
    Fault,
    Input,
    JobResult,
    Message,
    ReloadModule,
    RestartModule,
    SetClock,
    SetClockRate,
    SetSetting,
    SettingChanged,
    SlotChanged,
    Tick,
)
from vrut_lite.kernel.module import Manifest, Module, handles

UP, NOON = (0.0, 1.0, 0.0), datetime(2026, 6, 21, 12, tzinfo=UTC)
AIR = AirVolume(
    light=Array(np.ones((3, 2, 4, 2, 3), np.float16)),
    extinction=Array(np.full((2, 4, 3), 1e-5, np.float32)),
    columns=2, radiance_scale=0.25, aerosol_phase=(0.8, 0.1, 1.0), rows_above=2, rows_below=2,
    reach_m=1e5, observer_altitude_m=2.0, ground_radius_m=6.36e6, top_altitude_m=6e4,
    sun_direction=UP,
)  # fmt: skip
CLOUDS = CloudLayer(
    base_m=1000.0, thickness_m=800.0, extinction_per_m=0.05, coverage=0.5, threshold=0.4,
    column_density=0.2, drift_m=(0.0, 10.0), phase=(0.8, -0.2, 0.7),
    weather=Array(np.zeros((4, 4), np.uint16)), shape=Array(np.zeros((4, 4, 4), np.uint8)),
    detail=Array(np.zeros((2, 2, 2), np.uint8)),
)  # fmt: skip
SCENE = SceneOpened(
    path="a.glb", lower_m=UP, upper_m=UP, triangles=1,
    geometry=SceneGeometry(
        positions_m=Array(np.eye(3)), normals=Array(np.eye(3)), uv=Array(np.zeros((0, 2))),
        colours_rgba=Array(np.zeros((0, 4), np.float32)),
        triangles=Array(np.array([[0, 1, 2]], np.int32)),
        meshes=Array(np.array([[0, 3, 0, 1, -1, -1, -1, 0]], np.int64)),
        part_mesh=Array(np.zeros(1, np.int32)), world_from_part=Array(np.eye(4)[None].copy()),
    ),
    materials=SceneMaterials(
        names=Array(np.frombuffer(b"grey", np.uint8)), base_colour_rgba=Array(np.ones((1, 4))),
        metallic=Array(np.zeros(1)), roughness=Array(np.ones(1)),
        emission_rgb=Array(np.zeros((1, 3))), alpha_mode=Array(np.zeros(1, np.uint8)),
        alpha_cutoff=Array(np.ones(1)), double_sided=Array(np.zeros(1, bool)),
        normal_scale=Array(np.ones(1)), occlusion_strength=Array(np.ones(1)),
        map_image=Array(np.full((1, 5), -1, np.int32)),
        map_uv_layer=Array(np.zeros((1, 5), np.uint8)),
        images=Array(np.zeros((0, 4), np.int64)), texels=Array(np.zeros(0, np.uint8)),
    ),
    ground=GroundDisc((0.0, 0.0), 0.0, 10.0), camera=MoveCamera(eye_m=UP, target_m=(0.0,) * 3),
)  # fmt: skip
VIEW = ViewShader(source="void main() {}", uniforms={"a": 1.0, "b": (1, 2.0)})
NESTED = (
    AirVolume
    | CloudLayer
    | ViewShader
    | SceneGeometry
    | SceneMaterials
    | GroundChart
    | ProbeGrid
    | Mirrors
)
LAID = LightMapLaid(
    content_key="c", layout_key="l", size_px=(8, 6),
    shapes=Array(np.array([[0, 0, 3, 0, 1]], np.int64)),
    source_vertex=Array(np.arange(3, dtype=np.int32)), uv=Array(np.ones((3, 2), np.float32)),
    triangles=Array(np.array([[0, 1, 2]], np.int32)),
    part_shape=Array(np.array([0, -1], np.int32)),
    part_corner_px=Array(np.zeros((2, 2), np.int32)),
    ground=GroundChart(corner_px=(4, 2), edge_px=4, half_width_m=40.0, warp=3.0),
    probes=ProbeGrid(lower_m=UP, step_m=(1.0, 2.0, 1.0), counts=(3, 2, 4)), source="s",
    mirrors=Mirrors(
        part=Array(np.array([1], np.int32)), centre_m=Array(np.zeros((1, 3))),
        nearness=Array(np.ones((1, 6, 4, 4), np.float32)),
    ),
)  # fmt: skip
SURFACE_LIGHT = SurfaceLightChanged(
    layout_key="l", texels=Array(np.ones((6, 8, 4), np.float16)),
    probes=Array(np.ones((4, 2, 3, 6, 4), np.float16)), radiance_scale=2.0, rays=64, source="s",
    mirrors=Array(np.ones((1, 6, 4, 4, 4), np.float16)),
    visible_sky=Array(np.zeros((6, 8, 4), np.float16)),
)  # fmt: skip
CUBE = Array(np.ones((6, 4, 4, 3), np.float16))
SOUND = [
    SetSetting(module="m", name="n", value=1.0),
    EnableModule(module="m"),
    RestartModule(module="m"),
    ReloadModule(module="m"),
    ChooseSlot(slot="s", module="m"),
    Demand(consumer="c", message="SunMoved", size=7, encoding="u8"),
    JobResult(module="m", job="j", value=object()),
    Fault(module="m", where="w", error="e"),
    ClockMoved(instant=NOON),
    SetClock(instant=NOON),
    SetClockRate(rate=-60.0),
    Tick(elapsed_s=0.5),
    SetPlace(latitude_deg=50.0, longitude_deg=14.0, altitude_m=200.0, north_offset_rad=0.1),
    LoadScene(path="a.glb"),
    MoveCamera(eye_m=UP, target_m=(0.0, 0.0, 0.0)),
    Resize(width_px=64, height_px=32),
    PictureClicked(
        position_m=(1.0, 0.0, -2.0), normal=UP, material="brick", radiance_rgb=(9.0, 8.0, 7.0)
    ),
    SetExposure(),
    LookAlong(direction=UP),
    SetTolerance(tolerance=0.1),
    SetHaze(optical_depth_550=0.3, aerosol="one-lobe"),
    SCENE,
    SceneNeeds(sky_in_view=True, visible_faces=(0, 5), receives_light=True),
    SunMoved(
        direction=UP, azimuth_rad=3.0, elevation_rad=1.5, apparent_elevation_rad=1.5,
        visible_disc_fraction=1.0,
    ),
    BackgroundChanged(
        cube=CUBE, radiance_scale=0.5, ground_radiance_rgb=(1.0, 1.0, 0.0), source="s", view=VIEW,
        seen_sun_irradiance_rgb=(1.0, 1.0, 1.0),
    ),
    KeyLightChanged(
        direction=UP, irradiance_rgb=(1.0, 1.0, 1.0), angular_radius_rad=0.005,
        limb_darkening_rgb=((1.0,), (0.5, 0.5), (1.0,)), source="s",
    ),
    SpectrumSeen(direction=UP, wavelength_nm=(400.0, 500.0), radiance=(1.0, 2.0), source="s"),
    AirChanged(volume=AIR, source="s"),
    CloudsChanged(layer=CLOUDS, source="s"),
    AmbientChanged(irradiance_sh_rgb=Array(np.ones((25, 3), np.float32)), source="s"),
    SkyRadianceChanged(
        cube=CUBE, radiance_scale=0.5, ground_radiance_rgb=(1.0, 1.0, 0.0), source="s"
    ),
    GpuJob(module="m", job="j", compute_shader="", uniforms={"a": 1}, output="2d", size=4),
    LAID,
    SURFACE_LIGHT,
    SkyLightChanged(
        background=BackgroundChanged(
            cube=CUBE, radiance_scale=0.5, ground_radiance_rgb=(1.0, 1.0, 0.0), source="s"
        ),
        key_light=KeyLightChanged(
            direction=UP, irradiance_rgb=(1.0, 1.0, 1.0), angular_radius_rad=0.005,
            limb_darkening_rgb=((1.0,), (0.5, 0.5), (1.0,)), source="s",
        ),
        ambient=AmbientChanged(irradiance_sh_rgb=Array(np.ones((25, 3), np.float32)), source="s"),
        layers=("clouds",),
        source="s",
    ),
]  # fmt: skip
# Only the kernel posts these.
NEVER_POSTED = (SlotChanged, SettingChanged)


class Odd:
    """An object whose methods raise."""

    def __repr__(self):
        raise ZeroDivisionError

    def __eq__(self, other):
        raise ZeroDivisionError

    __hash__ = None  # type: ignore[assignment]


def named(message):
    return type(message).__name__


class Poster(Module):
    """Posts the message it is given."""

    manifest = Manifest(name="poster", title="Poster", version="1", provides=("sun", "sky"))
    given = None

    @handles(Tick)
    def on_tick(self, message):
        self.link.post(type(self).given)


def kernel_that_posts(message):
    kernel = Kernel()
    poster = type("Given", (Poster,), {"given": message})
    kernel.add_module(poster)
    kernel.pump()
    return kernel


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


def holes(message):
    """All fields of a message and of the structures in it, which tests replace by junk."""
    for name in message.__struct_fields__:
        yield (name,)
        if isinstance(part := getattr(message, name), NESTED):
            yield from ((name, *rest) for rest in holes(part))


def spoilt(message, place, junk):
    name, *rest = place
    if rest:
        junk = spoilt(getattr(message, name), rest, junk)
    return msgspec.structs.replace(message, **{name: junk})


@given(st.sampled_from(SOUND), st.data())
def test_whatever_a_field_holds_a_check_passes_or_says_one_sentence(message, data):
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
def test_a_malformed_post_is_the_poster_s_fault_and_reaches_nobody(message, data):
    """Consumers hear what passes the check and nothing else, and who posted it is told."""
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
    """The API takes any value: what is none of a type's is one sentence for its user."""
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


@pytest.mark.parametrize(
    ("message", "changes", "says"),
    [
        (SetPlace, {"latitude_deg": True}, "latitude_deg of a place must lie from -90 to 90, not"),
        (SetPlace, {"latitude_deg": "50"}, "from -90 to 90, not '50'"),
        (SetHaze, {"optical_depth_550": 1.0}, "optical_depth_550 of haze must lie from 0 to 0.9"),
        (SetHaze, {"aerosol": "urban"}, "aerosol of SetHaze must be one of one-lobe, not 'urban'"),
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
    """The sentence says what is wrong, where, and what is allowed."""
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


@pytest.mark.parametrize(
    ("slices", "fits"), [(2, True), (682, True), (683, False), (2000, False), (1, False)]
)
def test_air_fits_a_3d_texture(slices, fits):
    """The three kinds of light share one 3-D texture of at most 2048 layers."""
    volume = msgspec.structs.replace(
        AIR,
        light=Array(np.ones((3, slices, 4, 2, 3), np.float16)),
        extinction=Array(np.ones((slices, 4, 3), np.float32)),
    )
    message = AirChanged(volume=volume, source="s")
    if fits:
        message.check()
        return
    with pytest.raises(UserError, match="extinction of AirVolume must"):
        message.check()


@pytest.mark.parametrize("odd", [math.nan, math.inf, -math.inf, 6e4])
@pytest.mark.parametrize("name", ["cube", "light", "extinction", "irradiance_sh_rgb"])
def test_values_of_arrays_are_checked_on_request(name, odd):
    """`check_arrays` finds a single invalid value in an array."""
    sample = {
        "cube": SOUND[[named(m) for m in SOUND].index("BackgroundChanged")],
        "light": AirChanged(volume=AIR, source="s"),
        "extinction": AirChanged(volume=AIR, source="s"),
        "irradiance_sh_rgb": AmbientChanged(
            irradiance_sh_rgb=Array(np.ones((25, 3), np.float64)), source="s"
        ),
    }[name]
    place = ("volume", name) if isinstance(sample, AirChanged) else (name,)
    carrier = sample.volume if len(place) == 2 else sample
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
        ({"centre_m": np.full((1, 3), np.nan)}, "centre_m of Mirrors must hold numbers"),
        ({"nearness": np.full((1, 6, 4, 4), -1.0, np.float32)}, "nearness of Mirrors must hold"),
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
    """Of two layouts of one name the light is of the one whose cubes have its sizes."""
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
    """What a shape or a part names must be there: the frame looks nothing up beyond."""
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
    """By its name or its size light tells that a layout is not its own."""
    assert SURFACE_LIGHT.fits(LAID)
    assert not msgspec.structs.replace(SURFACE_LIGHT, **changes).fits(LAID)
