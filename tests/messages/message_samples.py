"""A valid sample of every type of message, and ways to spoil it."""

from datetime import UTC, datetime

import msgspec
import numpy as np
from grey_materials import grey_materials
from light_messages import second_light, small_air

from vrut_lite.array import Array
from vrut_lite.atmosphere.aerosols.own import OwnAerosol
from vrut_lite.kernel.bus import Kernel
from vrut_lite.kernel.messages import (
    ChooseSlot,
    ClockMoved,
    Demand,
    EnableModule,
    Fault,
    JobResult,
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
from vrut_lite.messages.air import AirChanged, AirVolume, SecondLight
from vrut_lite.messages.camera import MoveCamera
from vrut_lite.messages.cloudiness import CloudinessChanged
from vrut_lite.messages.clouds import CloudForm, CloudLayer, CloudsChanged
from vrut_lite.messages.glazing import Glazing
from vrut_lite.messages.gpu_job import GpuJob
from vrut_lite.messages.ground import SetGround
from vrut_lite.messages.ground_disc import GroundDisc
from vrut_lite.messages.haze import SetHaze
from vrut_lite.messages.lamps import ALL_AROUND, NONE, TABLE_SHAPE, SceneLamps
from vrut_lite.messages.light_map import (
    GroundChart,
    LightMapLaid,
    ProbeGrid,
    ReflectionProbes,
    SurfaceLightChanged,
)
from vrut_lite.messages.moon_path import MoonPathChanged
from vrut_lite.messages.night import (
    EarthShadow,
    MoonDiscChanged,
    MoonLight,
    NightLightChanged,
    StarsChanged,
)
from vrut_lite.messages.picture import PictureClicked, Resize, SetExposure
from vrut_lite.messages.place import SetPlace
from vrut_lite.messages.placement import PlacedFile, Placement
from vrut_lite.messages.points_and_lines import PointsAndLines
from vrut_lite.messages.renderer import RendererTried
from vrut_lite.messages.scene import LoadScene, SceneNeeds, SceneOpened
from vrut_lite.messages.scene_content import SceneGeometry, SceneMaterials
from vrut_lite.messages.section import SectionChanged
from vrut_lite.messages.sky import (
    AmbientChanged,
    BackgroundChanged,
    LookAlong,
    LookAround,
    SkyPolarisationChanged,
    SkyRadianceChanged,
    SkySpectraSeen,
    SpectrumSeen,
    ViewShader,
)
from vrut_lite.messages.sky_light import SkyGlowAdded, SkyLightChanged
from vrut_lite.messages.sun import KeyLightChanged, SunMoved
from vrut_lite.messages.tolerance import SetTolerance
from vrut_lite.messages.view_light import StillAsked, ViewLightChanged
from vrut_lite.messages.weather import SetWeather

UP, NOON = (0.0, 1.0, 0.0), datetime(2026, 6, 21, 12, tzinfo=UTC)
AIR_LIGHT = np.ones((3, 2, 4, 2, 3), np.float16)
AIR = small_air(AIR_LIGHT).volume
CLOUDS = CloudLayer(
    base_m=1000.0, thickness_m=800.0, extinction_per_m=0.05, coverage=0.5, threshold=0.4,
    column_density=0.2, drift_m=(0.0, 10.0),
    weather=Array(np.zeros((4, 4), np.uint16)), shape=Array(np.zeros((4, 4, 4), np.uint8)),
    detail=Array(np.zeros((2, 2, 2), np.uint8)),
)  # fmt: skip
LAMPS = SceneLamps(
    names=Array(np.frombuffer(b"bulb", np.uint8)), position_m=Array(np.zeros((1, 3))),
    axes=Array(np.eye(3)[None].copy()), intensity_rgb=Array(np.ones((1, 3))),
    cone_cos=Array(np.array([ALL_AROUND])), table=Array(np.full(1, NONE, np.int32)),
    tables=Array(np.zeros((0, *TABLE_SHAPE), np.float32)),
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
    materials=grey_materials(),
    ground=GroundDisc((0.0, 0.0), 0.0, 10.0), camera=MoveCamera(eye_m=UP, target_m=(0.0,) * 3),
    lamps=LAMPS, notices=("directional light: not drawn",),
    opened=LoadScene(path="a.glb"), cameras=("gate",), variants=("red",),
    points_and_lines=PointsAndLines(
        points_m=Array(np.zeros((1, 3))), point_rgba=Array(np.ones((1, 4), np.float32)),
        lines_m=Array(np.ones((2, 2, 3))), line_rgba=Array(np.ones((2, 2, 4), np.float32)),
    ),
)  # fmt: skip
VIEW = ViewShader(source="void main() {}", uniforms={"a": 1.0, "b": (1, 2.0)})
NESTED = (
    AirVolume
    | SecondLight
    | CloudForm
    | CloudLayer
    | ViewShader
    | SceneGeometry
    | SceneMaterials
    | PointsAndLines
    | GroundChart
    | ProbeGrid
    | ReflectionProbes
    | MoonLight
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
    mirrors=ReflectionProbes(
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
VIEW_LIGHT = ViewLightChanged(
    layout_key="l", camera=MoveCamera(eye_m=(0.0, 1.0, 2.0), target_m=(0.0, 1.0, 0.0)),
    size_px=(16, 9), edge_px=2, light=Array(np.ones((5, 8, 4), np.float16)),
    plane=Array(np.ones((5, 8, 4), np.float32)),
    mirrored=Array(np.ones((2, 5, 8, 4), np.float16)), radiance_scale=2.0, rays=64, source="s",
)  # fmt: skip
MOON = MoonLight(
    place=SunMoved(
        direction=UP, azimuth_rad=3.0, elevation_rad=1.5, apparent_elevation_rad=1.5,
        visible_disc_fraction=1.0,
    ),
    irradiance_rgb=(5e-4, 4e-4, 3e-4), of_sunlight_rgb=(3e-6, 2e-6, 2e-6),
    angular_radius_rad=0.0045, lit_fraction=0.5, waxes=True,
)  # fmt: skip
CUBE = Array(np.ones((6, 4, 4, 3), np.float16))
WEATHER = SetWeather(
    path="prague.epw", name="Prague", latitude_deg=50.1, longitude_deg=14.3,
    altitude_m=364.0, utc_offset_h=1.0,
    direct_normal_w_m2=(500.0,) * 8760, diffuse_horizontal_w_m2=(100.0,) * 8760,
    dew_point_c=(5.0,) * 8760, cloud_cover=(0.3,) * 8760, lacks=("no snow",),
)  # fmt: skip
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
    LoadScene(
        path="a.glb",
        beside=(PlacedFile(scene="b.glb", placement=Placement(up="z")),),
        luminaires=(("bulb", "a.ies"),),
        variant="red",
        glazing=(("pane", Glazing(0.7)),),
    ),
    MoveCamera(eye_m=UP, target_m=(0.0, 0.0, 0.0)),
    Resize(width_px=64, height_px=32),
    PictureClicked(
        position_m=(1.0, 0.0, -2.0), normal=UP, material="brick", radiance_rgb=(9.0, 8.0, 7.0)
    ),
    RendererTried(renderer="a card", trial_ns=0.2),
    SetExposure(),
    LookAlong(direction=UP),
    LookAround(wavelength_nm=(400.0, 500.0), size=4),
    SetTolerance(tolerance=0.1),
    SetHaze(optical_depth_550=0.3, aerosol="one-lobe"),
    SetGround(ground="snow", albedo=0.8),
    SetHaze(optical_depth_550=0.3, own=OwnAerosol(angle_deg=(0.0, 180.0), phase=(2.0, 1.0))),
    WEATHER,
    SCENE,
    SceneNeeds(sky_in_view=True, visible_faces=(0, 5), receives_light=True),
    SectionChanged(normal=UP, offset_m=1.5),
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
    SkySpectraSeen(
        wavelength_nm=(400.0, 500.0), cube=Array(np.ones((6, 2, 2, 2), np.float32)),
        sun_irradiance=(1.0, 1.0), ground_radiance=(0.1, 0.1), ground_albedo=(0.2, 0.3), source="s",
    ),
    SkyPolarisationChanged(
        cube=Array(np.zeros((2, 6, 2, 2, 3), np.float16)), radiance_scale=0.25, source="s"
    ),
    AirChanged(volume=AIR, source="s"),
    small_air(AIR_LIGHT, second=second_light(AIR_LIGHT)),
    CloudinessChanged(
        cover=0.5, global_share=None, direct_share=0.8, sun_elevation_rad=0.3, source="s"
    ),
    CloudsChanged(layers=(CLOUDS,), source="s"),
    AmbientChanged(irradiance_sh_rgb=Array(np.ones((25, 3), np.float32)), source="s"),
    SkyRadianceChanged(
        cube=CUBE, radiance_scale=0.5, ground_radiance_rgb=(1.0, 1.0, 0.0), source="s"
    ),
    GpuJob(module="m", job="j", compute_shader="", uniforms={"a": 1}, output="2d", size=4),
    LAID,
    SURFACE_LIGHT,
    NightLightChanged(
        instant=NOON, moon=MOON, glow_rgb=Array(np.ones((4, 8, 3), np.float32)), source="s"
    ),
    StarsChanged(
        direction=Array(np.array([UP], np.float32)),
        irradiance_rgb=Array(np.ones((1, 3), np.float32)), source="s",
    ),
    MoonDiscChanged(
        direction=UP, angular_radius_rad=0.0045, flattening=0.9, to_sun=UP,
        axes=(1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0), lit_rgb=(1.0, 1.0, 1.0),
        dark_rgb=(0.0, 0.0, 0.0), albedo=Array(np.ones((4, 8), np.float32)), source="s",
        shadow=EarthShadow(
            direction=UP, umbra_rad=0.01, penumbra_rad=0.02, umbra_rgb=(1e-4, 1e-5, 1e-5)
        ),
    ),
    MoonPathChanged(
        start=NOON, step_s=1200.0, direction=Array(np.array([UP], np.float32)), rises_s=(60.0,),
        sets_s=(), source="s",
    ),
    StillAsked(camera=VIEW_LIGHT.camera, size_px=(16, 9)),
    VIEW_LIGHT,
    SkyGlowAdded(
        glow_rgb=Array(np.ones((4, 8, 3), np.float32)), of_slot="aurora", source="aurora"
    ),
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


def named(message):
    return type(message).__name__


class Poster(Module):
    """Posts the message it is given."""

    manifest = Manifest(
        name="poster", title="Poster", version="1", provides=("sun", "sky", "light_map", "night")
    )
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
