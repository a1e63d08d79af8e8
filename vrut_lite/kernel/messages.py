"""What modules and the host say to each other: typed, frozen, with units in the names.

An input comes from outside (a person, the clock, a file, a finished job) and opens a
transaction. A derived message is a consequence, posted by a handler inside one.
"""

from datetime import datetime
from typing import Any, ClassVar, Literal, Self

import msgspec

from vrut_lite.kernel.array import Array
from vrut_lite.kernel.gpu_texture import GpuTexture

Vector = tuple[float, float, float]
# In order of precedence: who wants float32 cannot use float16, the reverse can be had.
Encoding = Literal["", "u8", "float16", "float32"]
ToneMap = Literal["agx", "exponential", "none"]
Number = float | int
Matrix = tuple[tuple[float, float, float, float], ...]


class Message(msgspec.Struct, frozen=True, kw_only=True):
    """Base of all messages."""

    def key(self) -> str | None:
        """What distinguishes messages of one type: of equal keys the latest wins.

        None means that every single one is delivered.
        """
        return ""


class Input(Message, frozen=True, kw_only=True):
    """A fact from outside; each opens a transaction of its own."""

    # Inputs of one line merge only with the last of their line: their order matters.
    line: ClassVar[str | None] = None

    def merged(self, older: Self) -> Self:
        """What takes the place of this input and of an older one of its key that still waits."""
        return self


class Derived(Message, frozen=True, kw_only=True):
    """A consequence, posted by a handler; those of a slot only by the slot's holder."""

    slot: ClassVar[str | None] = None


# --- the kernel's own -----------------------------------------------------------------


class SetSetting(Input, frozen=True, kw_only=True):
    """Give one setting of one module a new value."""

    module: str
    name: str
    value: Any

    def key(self) -> str:
        """One pending value per setting."""
        return f"{self.module}.{self.name}"


class EnableModule(Input, frozen=True, kw_only=True):
    """Switch a module on or off."""

    module: str
    enabled: bool = True

    def key(self) -> str:
        """One pending state per module."""
        return self.module


class RestartModule(Input, frozen=True, kw_only=True):
    """Start a module anew with its present settings, also after it was suspended."""

    module: str

    def key(self) -> None:
        """Every restart counts."""


class ReloadModule(Input, frozen=True, kw_only=True):
    """Import a module's package afresh; settings and snapshot pass to the new version."""

    module: str

    def key(self) -> None:
        """Every reload counts."""


class ChooseSlot(Input, frozen=True, kw_only=True):
    """Let a module hold a slot (`sun` or `sky`)."""

    slot: str
    module: str

    def key(self) -> str:
        """One pending choice per slot."""
        return self.slot


class Demand(Input, frozen=True, kw_only=True):
    """A consumer wants messages of a type, in this size and format; size 0 takes it back.

    The encoding "" leaves the choice to the producer. The demand of a consumer that is a
    module holds while that module runs.
    """

    consumer: str
    message: str
    size: int = 1
    encoding: Encoding = ""

    def key(self) -> str:
        """One demand per consumer and message."""
        return f"{self.consumer}.{self.message}"


class JobResult(Input, frozen=True, kw_only=True):
    """A background or GPU job is done; `error` tells why not, if it is not.

    Only the module that asked hears it; a result that nobody waits for any more is dropped.
    Work that raised leaves its `trace`, and is told as a `Fault` too.
    """

    module: str
    job: str
    value: Any = None
    error: str = ""
    trace: str = ""
    for_user: bool = False

    def key(self) -> None:
        """Every result counts."""


class SlotChanged(Derived, frozen=True, kw_only=True):
    """Another module holds the slot now; empty when none can."""

    name: str
    holder: str

    def key(self) -> str:
        """One holder per slot."""
        return self.name


class SettingChanged(Derived, frozen=True, kw_only=True):
    """A module's setting has a new, valid value."""

    module: str
    name: str
    value: Any

    def key(self) -> str:
        """One value per setting."""
        return f"{self.module}.{self.name}"


class Fault(Derived, frozen=True, kw_only=True):
    """A module failed; the others went on. `for_user`: the error is a sentence for people."""

    module: str
    where: str
    error: str
    trace: str = ""
    suspended: bool = False
    for_user: bool = False

    def key(self) -> None:
        """Every fault is told."""


class ClockMoved(Derived, frozen=True, kw_only=True):
    """The host's clock stands at this instant, in UTC, whether it was set or it ticked."""

    instant: datetime


# --- inputs of daylight ---------------------------------------------------------------


class SetClock(Input, frozen=True, kw_only=True):
    """The host's clock stands at this aware instant; modules listen to `ClockMoved`."""

    line: ClassVar[str | None] = "clock"

    instant: datetime


class SetClockRate(Input, frozen=True, kw_only=True):
    """Play: so many seconds of the host's clock pass in one of the tick's; 0 pauses."""

    line: ClassVar[str | None] = "clock"

    rate: float


class Tick(Input, frozen=True, kw_only=True):
    """So much time went by outside."""

    line: ClassVar[str | None] = "clock"

    elapsed_s: float

    def merged(self, older: Self) -> Self:
        """Both went by: a slow kernel falls behind in frames, never in time."""
        return type(self)(elapsed_s=self.elapsed_s + older.elapsed_s)


class SetPlace(Input, frozen=True, kw_only=True):
    """The observer's place; longitude is east-positive."""

    latitude_deg: float
    longitude_deg: float
    altitude_m: float = 0.0
    north_offset_rad: float = 0.0


class LoadScene(Input, frozen=True, kw_only=True):
    """Open this scene file."""

    path: str


class MoveCamera(Input, frozen=True, kw_only=True):
    """Look from `eye_m` to `target_m`, world axes."""

    eye_m: Vector
    target_m: Vector
    vertical_field_of_view_rad: float = 0.8


class Resize(Input, frozen=True, kw_only=True):
    """The picture's size in pixels."""

    width_px: int
    height_px: int


class SetExposure(Input, frozen=True, kw_only=True):
    """How radiance becomes a picture: exposure, white balance, tone map.

    Automatic exposure, or a fixed EV100; the compensation brightens by so many stops. Light of
    `white_temperature_k`, moved off the daylight locus by `white_duv` (towards green), is shown
    white; 6504 K leaves colours as they are.
    """

    mode: Literal["auto", "manual"] = "auto"
    ev100: float = 15.0
    compensation_ev: float = 0.0
    tone_map: ToneMap = "agx"
    white_temperature_k: float = 6504.0
    white_duv: float = 0.0


class LookAlong(Input, frozen=True, kw_only=True):
    """Ask for the sky's spectrum in a direction, a unit vector in world axes."""

    direction: Vector


class SetTolerance(Input, frozen=True, kw_only=True):
    """How far radiance may be off, as a share of itself: above 0, 1 at most.

    Sizes, orders of scattering and thresholds follow, but for those that someone names:
    99 of 100 directions of a picture stay within it (those darker than a thousandth of the
    brightest are measured by that).
    """

    tolerance: float


# --- derived messages of daylight -----------------------------------------------------


class SceneLoaded(Derived, frozen=True, kw_only=True):
    """A scene is open; its bounds in metres, world axes."""

    path: str
    lower_m: Vector
    upper_m: Vector
    triangles: int


class SceneNeeds(Derived, frozen=True, kw_only=True):
    """What the scene asks of light: producers compute nothing else.

    `air_reach_m`: how far from the eye things stand between which and the eye air is to be
    drawn; 0 where none is. `eye_height_m`: the eye's y, also of a camera that a scene brings.
    """

    sky_in_view: bool
    visible_faces: tuple[int, ...]
    receives_light: bool
    air_reach_m: float = 0.0
    eye_height_m: float = 0.0


class SunMoved(Derived, frozen=True, kw_only=True):
    """Where the sun stands; the direction is apparent, in world axes, pointing to the sun."""

    slot: ClassVar[str | None] = "sun"

    direction: Vector
    azimuth_rad: float
    elevation_rad: float
    apparent_elevation_rad: float
    visible_disc_fraction: float


class ViewShader(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """What is seen behind the scene, pixel by pixel, for who can run a shader.

    `source` is GLSL 4.30 of a fragment shader, without a `#version` line, that defines

        vec3 background_radiance(vec3 direction)   // sky and planet, W m^-2 sr^-1
        vec3 background_sunlight(vec3 direction)   // irradiance by a sun that is seen there, W m^-2

    of a unit vector in world axes, in linear sRGB: the second through whatever air lies there,
    on a plane that faces it, and zero where a planet hides it. Functions are called for every
    pixel alike, so that derivatives may be taken. All names that it declares begin with
    `background_`. It reads `uniforms` by name, and `buffers`, pairs of a binding and what a
    std430 storage buffer there holds: an `Array` of float32.
    """

    source: str
    uniforms: dict[str, Number | tuple[Number, ...]]
    buffers: tuple[tuple[int, Array], ...] = ()


class BackgroundChanged(Derived, frozen=True, kw_only=True):
    """A new sky without its disc, as a cube map in world axes.

    cube (6, size, size, 3) float16, or a cube texture that stays on the GPU; linear sRGB
    radiance in W m^-2 sr^-1 is cube times `radiance_scale`, a power of two. The lower half
    holds `ground_radiance_rgb` (W m^-2 sr^-1): bare, so that who draws the air draws it before
    that ground too, or, `ground_through_air`, as it is seen through the air. Where a cube map
    would blur what is seen there is a `view` too, which shows the same, and the sun's disc as it
    is seen from there; the cube goes on lighting and being mirrored. `seen_sun_irradiance_rgb`
    (W m^-2) is what the eye's own place receives of the sun that is seen there, where that
    differs from the scene's.
    """

    slot: ClassVar[str | None] = "sky"

    cube: Array | GpuTexture
    radiance_scale: float
    ground_radiance_rgb: Vector
    source: str
    ground_through_air: bool = False
    view: ViewShader | None = None
    seen_sun_irradiance_rgb: Vector | None = None
    color_space: Literal["linear-srgb"] = "linear-srgb"
    frame: Literal["world"] = "world"


class SunLightChanged(Derived, frozen=True, kw_only=True):
    """The sun's light: irradiance (W m^-2, linear sRGB) on a plane that faces it.

    `limb_darkening_rgb` holds, per channel, a polynomial in cos psi (constant first), of
    which the mean over the disc is 1: radiance = irradiance / solid angle * polynomial.
    """

    slot: ClassVar[str | None] = "sky"

    direction: Vector
    irradiance_rgb: Vector
    angular_radius_rad: float
    limb_darkening_rgb: tuple[tuple[float, ...], ...]
    source: str


class SpectrumSeen(Derived, frozen=True, kw_only=True):
    """The sky's spectral radiance (W m^-2 sr^-1 nm^-1) in a direction, without the sun's disc.

    Both lists are empty where the holder of the sky knows colours alone, as at twilight some do.
    """

    slot: ClassVar[str | None] = "sky"

    direction: Vector
    wavelength_nm: tuple[float, ...]
    radiance: tuple[float, ...]
    source: str


class AirVolume(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The air between one eye and whatever stands in any direction, at any distance up to a reach.

    Values are kept at nodes (slices, rows, columns) by distance, height and azimuth from the
    sun; `vrut_lite.geometry.air_volume` says where the nodes lie and how values become light.
    Radiance is linear sRGB, to be multiplied by `radiance_scale` (a power of two), and is a mean
    along the ray: what the air adds before a point is mean * (1 - transmittance).

    Attributes:
        light: (3, slices, rows, columns, 3) of three kinds. Light scattered twice or more,
            W m^-2 sr^-1: what the air sends also where no sun falls on it. Sunlight scattered
            once by molecules, and once by aerosol, each to be multiplied by its phase function
            (sr^-1): W m^-2. An array of float16, or a texture, the slices of one kind after those
            of the other.
        extinction: (slices, rows, 3) float32, m^-1, mean along the ray: transmittance is
            exp(-extinction * distance).
        aerosol_phase: g, factor and form: factor (1 + form nu^2) / (1 + g^2 - 2 g nu)^1.5.
        rows_above, rows_below: of the rows, how many lie above and below the horizon.
        reach_m: how much of a ray's air the slices span at most, from where it enters the air.
    """

    light: Array | GpuTexture
    extinction: Array
    columns: int
    radiance_scale: float
    aerosol_phase: tuple[float, float, float]
    rows_above: int
    rows_below: int
    reach_m: float
    observer_altitude_m: float
    ground_radius_m: float
    top_altitude_m: float
    sun_direction: Vector


class AirChanged(Derived, frozen=True, kw_only=True):
    """The air in front of the scene; no volume where it would not be seen."""

    slot: ClassVar[str | None] = "sky"

    volume: AirVolume | None
    source: str


class CloudLayer(msgspec.Struct, frozen=True, kw_only=True):
    """One layer of clouds between two altitudes; `vrut_lite.geometry.clouds` says what it holds.

    Altitudes count from world y = 0, azimuths as the world's.

    Attributes:
        extinction_per_m: of a cloud's full density.
        coverage: share of the sky's zenith that is cloud, 0 to 1.
        threshold: what of `weather` lies above it bears cloud.
        column_density: mean over clouds of density times share of the thickness.
        drift_m: how far the wind has carried the pattern, along world x and z.
        phase: two lobes of Henyey and Greenstein: g forward, g backward, share of the first.
        weather: (n, n) uint16, where clouds stand; periodic.
        shape: (n, n, n) uint8 (y, z, x), their billows; periodic.
        detail: (n, n, n) uint8 (y, z, x), what frays their edges; periodic.
    """

    base_m: float
    thickness_m: float
    extinction_per_m: float
    coverage: float
    threshold: float
    column_density: float
    drift_m: tuple[float, float]
    phase: tuple[float, float, float]
    weather: Array
    shape: Array
    detail: Array


class CloudsChanged(Derived, frozen=True, kw_only=True):
    """The clouds; no layer where there are none."""

    layer: CloudLayer | None
    source: str


class AmbientChanged(Derived, frozen=True, kw_only=True):
    """Irradiance of sky and ground, without the sun: harmonics (25, 3) float32, W m^-2."""

    slot: ClassVar[str | None] = "sky"

    irradiance_sh_rgb: Array
    source: str
