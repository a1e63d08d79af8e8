"""What modules and the host say to each other: typed, frozen, with units in the names.

An input comes from outside (a person, the clock, a file, a finished job) and opens a
transaction. A derived message is a consequence, posted by a handler inside one.

Each type says in `check` what those who hear it rely on: an input is checked when it is admitted,
a derived message when it is posted.
"""

import math
from datetime import datetime
from typing import Any, ClassVar, Literal, Self, get_args

import msgspec

from vrut_lite.errors import UserError
from vrut_lite.kernel import checks
from vrut_lite.kernel.array import Array
from vrut_lite.kernel.gpu_texture import GpuTexture

Vector = tuple[float, float, float]
# In order of precedence: who wants float32 cannot use float16, the reverse can be had.
Encoding = Literal["", "u8", "float16", "float32"]
ToneMap = Literal["agx", "exponential", "none"]
Number = float | int
Matrix = tuple[tuple[float, float, float, float], ...]

# No ground is lower; geostationary orbit is higher than any observer of an atmosphere needs.
LOWEST_M, HIGHEST_M = -11_000.0, 36_000_000.0
# The largest cube and the largest picture that the command line offers.
LARGEST_DEMAND = 4096
LARGEST_PICTURE_PX = 16384
# What every OpenGL 4.3 can hold: the edge of a cube or of a map, and of a 3-D texture.
LARGEST_EDGE, _LARGEST_VOLUME = 16384, 2048
# W m^-2, also per steradian, whose sums and products stay finite in 32 bits; the sun's disc has
# 2e7.
_MOST_LIGHT = 1e10
# A full turn, and straight up, with room for rounding.
_TURN_RAD, _UP_RAD = 6.3, 1.58
# As the frame's shader has them.
_MOST_LIMB_TERMS = 6
# Stops of exposure whose powers of two stay finite in 32 bits.
_MOST_STOPS = 100.0
# White that the eye takes for white.
LOWEST_K, HIGHEST_K, MOST_DUV = 1700.0, 25_000.0, 0.05
_LARGEST_M = 1e10
_MOST_EXTINCTION_PER_M = 1e3
_MOST_WAVELENGTHS = 4096


class Message(msgspec.Struct, frozen=True, kw_only=True):
    """Base of all messages."""

    def key(self) -> str | None:
        """What distinguishes messages of one type: of equal keys the latest wins.

        None means that every single one is delivered.
        """
        return ""

    def check(self) -> None:
        """Pass if every field is what those who hear the message rely on, whatever it holds.

        Takes microseconds: what fills arrays is `check_arrays`' to see.

        Raises:
            UserError: a field is not; the sentence names it.
        """

    def check_arrays(self) -> None:
        """Pass if the arrays of a message that passes `check` hold what one can draw with.

        Raises:
            UserError: one does not.
        """


class Input(Message, frozen=True, kw_only=True):
    """A fact from outside; each opens a transaction of its own."""

    # Inputs of one line merge only with the last of their line: their order matters.
    line: ClassVar[str | None] = None
    # Whether a stranger said it: what it leads to is told, and no command fails for it.
    by_stranger: ClassVar[bool] = False

    def merged(self, older: Self) -> Self:
        """What takes the place of this input and of an older one of its key that still waits."""
        return self


class Derived(Message, frozen=True, kw_only=True):
    """A consequence, posted by a handler; those of a slot only by the slot's holder."""

    slot: ClassVar[str | None] = None
    # Whether there is anything to ask before it is posted.
    guarded: ClassVar[bool] = False

    def __init_subclass__(cls) -> None:
        """Note it here, where it costs no post anything."""
        super().__init_subclass__()
        cls.guarded = cls.slot is not None or cls.check is not Message.check


# --- the kernel's own -----------------------------------------------------------------


class SetSetting(Input, frozen=True, kw_only=True):
    """Give one setting of one module a new value."""

    module: str
    name: str
    value: Any

    def key(self) -> str:
        """One pending value per setting."""
        return f"{self.module}.{self.name}"

    def check(self) -> None:
        """A plain value; the setting itself decides whether it takes it."""
        checks.text(self, "module", "name")
        if not isinstance(self.value, bool | int | float | str | None):
            raise UserError(
                "SetSetting: a setting's value is a number, a text, true, false or null"
            )


class EnableModule(Input, frozen=True, kw_only=True):
    """Switch a module on or off."""

    module: str
    enabled: bool = True

    def key(self) -> str:
        """One pending state per module."""
        return self.module

    def check(self) -> None:
        """A module by name, on or off."""
        checks.text(self, "module")
        checks.flag(self, "enabled")


class RestartModule(Input, frozen=True, kw_only=True):
    """Start a module anew with its present settings, also after it was suspended."""

    module: str

    def key(self) -> None:
        """Every restart counts."""

    def check(self) -> None:
        """A module by name."""
        checks.text(self, "module")


class ReloadModule(Input, frozen=True, kw_only=True):
    """Import a module's package afresh; settings and snapshot pass to the new version."""

    module: str

    def key(self) -> None:
        """Every reload counts."""

    def check(self) -> None:
        """A module by name."""
        checks.text(self, "module")


class ChooseSlot(Input, frozen=True, kw_only=True):
    """Let a module hold a slot (`sun` or `sky`)."""

    slot: str
    module: str

    def key(self) -> str:
        """One pending choice per slot."""
        return self.slot

    def check(self) -> None:
        """Slot and module by name."""
        checks.text(self, "slot", "module")


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

    def check(self) -> None:
        """A size and an encoding that producers know."""
        checks.text(self, "consumer", "message")
        checks.whole(self, "size", 0, LARGEST_DEMAND)
        if not (isinstance(self.encoding, str) and self.encoding in get_args(Encoding)):
            raise UserError(
                f"{self.consumer} wants {self.message} as {checks.shown(self.encoding)}: "
                f"it can be {', '.join(filter(None, get_args(Encoding)))}"
            )


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

    def check(self) -> None:
        """Whose it is, and texts; the value is what that module made it."""
        checks.text(self, "module", "job", "error", "trace")
        checks.flag(self, "for_user")


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

    def check(self) -> None:
        """Texts."""
        checks.text(self, "module", "where", "error", "trace")
        checks.flag(self, "suspended", "for_user")


class ClockMoved(Derived, frozen=True, kw_only=True):
    """The host's clock stands at this instant, in UTC, whether it was set or it ticked."""

    instant: datetime

    def check(self) -> None:
        """A time with a time zone."""
        checks.instant(self, "instant")


# --- inputs of daylight ---------------------------------------------------------------


class SetClock(Input, frozen=True, kw_only=True):
    """The host's clock stands at this aware instant; modules listen to `ClockMoved`."""

    line: ClassVar[str | None] = "clock"

    instant: datetime

    def check(self) -> None:
        """A time with a time zone that UTC can name."""
        checks.instant(self, "instant")


class SetClockRate(Input, frozen=True, kw_only=True):
    """Play: so many seconds of the host's clock pass in one of the tick's; 0 pauses."""

    line: ClassVar[str | None] = "clock"

    rate: float

    def check(self) -> None:
        """A number."""
        if not checks.is_finite(self.rate):
            raise UserError(
                f"the clock's rate must be a finite number, not {checks.shown(self.rate)}"
            )


class Tick(Input, frozen=True, kw_only=True):
    """So much time went by outside."""

    line: ClassVar[str | None] = "clock"

    elapsed_s: float

    def merged(self, older: Self) -> Self:
        """Both went by: a slow kernel falls behind in frames, never in time."""
        return type(self)(elapsed_s=self.elapsed_s + older.elapsed_s)

    def check(self) -> None:
        """Time never goes back."""
        if not (checks.is_finite(self.elapsed_s) and self.elapsed_s >= 0):
            raise UserError(f"a tick must be of 0 s or more, not {checks.shown(self.elapsed_s)}")


class SetPlace(Input, frozen=True, kw_only=True):
    """The observer's place; longitude is east-positive."""

    latitude_deg: float
    longitude_deg: float
    altitude_m: float = 0.0
    north_offset_rad: float = 0.0

    def check(self) -> None:
        """A place on or above the Earth."""
        checks.number(self, "latitude_deg", -90.0, 90.0, of="a place")
        checks.number(self, "longitude_deg", -180.0, 180.0, of="a place")
        checks.number(self, "altitude_m", LOWEST_M, HIGHEST_M, of="a place")
        checks.number(self, "north_offset_rad", -_TURN_RAD, _TURN_RAD, of="a place")


class LoadScene(Input, frozen=True, kw_only=True):
    """Open this scene file."""

    path: str

    def check(self) -> None:
        """The file itself tells the rest."""
        checks.text(self, "path")


class MoveCamera(Input, frozen=True, kw_only=True):
    """Look from `eye_m` to `target_m`, world axes."""

    eye_m: Vector
    target_m: Vector
    vertical_field_of_view_rad: float = 0.8

    def check(self) -> None:
        """From one point to another, at a possible angle."""
        checks.numbers(self, "eye_m", 3, of="a camera")
        checks.numbers(self, "target_m", 3, of="a camera")
        if self.eye_m == self.target_m:
            raise UserError("the camera's eye and target are one point: move one of them")
        angle = self.vertical_field_of_view_rad
        if not (checks.is_finite(angle) and 0.0 < angle < math.pi):
            raise UserError(
                "vertical_field_of_view_rad of a camera must lie between 0 and pi, not "
                f"{checks.shown(angle)}"
            )


class Resize(Input, frozen=True, kw_only=True):
    """The picture's size in pixels."""

    width_px: int
    height_px: int

    def check(self) -> None:
        """A picture that can be drawn."""
        checks.whole(self, "width_px", 1, LARGEST_PICTURE_PX)
        checks.whole(self, "height_px", 1, LARGEST_PICTURE_PX)


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

    def check(self) -> None:
        """Stops of which powers of two stay finite, and white that is near daylight."""
        checks.choice(self, "mode", ("auto", "manual"))
        checks.number(self, "ev100", -_MOST_STOPS, _MOST_STOPS)
        checks.number(self, "compensation_ev", -_MOST_STOPS, _MOST_STOPS)
        checks.choice(self, "tone_map", get_args(ToneMap))
        checks.number(self, "white_temperature_k", LOWEST_K, HIGHEST_K)
        checks.number(self, "white_duv", -MOST_DUV, MOST_DUV)


class LookAlong(Input, frozen=True, kw_only=True):
    """Ask for the sky's spectrum in a direction, a unit vector in world axes."""

    direction: Vector

    def check(self) -> None:
        """A unit vector."""
        checks.direction(self, "direction")


class SetTolerance(Input, frozen=True, kw_only=True):
    """How far radiance may be off, as a share of itself: above 0, 1 at most.

    Sizes, orders of scattering and thresholds follow, but for those that someone names:
    99 of 100 directions of a picture stay within it (those darker than a thousandth of the
    brightest are measured by that).
    """

    tolerance: float

    def check(self) -> None:
        """A share above 0, and 1 at most."""
        if not (checks.is_finite(self.tolerance) and 0.0 < self.tolerance <= 1.0):
            raise UserError(
                "the tolerance must be above 0 and 1 (100 %) at most, not "
                f"{checks.shown(self.tolerance)}"
            )


# --- derived messages of daylight -----------------------------------------------------


class SceneLoaded(Derived, frozen=True, kw_only=True):
    """A scene is open; its bounds in metres, world axes."""

    path: str
    lower_m: Vector
    upper_m: Vector
    triangles: int

    def check(self) -> None:
        """Bounds and a count."""
        checks.text(self, "path")
        checks.numbers(self, "lower_m", 3)
        checks.numbers(self, "upper_m", 3)
        checks.whole(self, "triangles", 0, 2**63)


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

    def check(self) -> None:
        """Faces of a cube, and lengths."""
        checks.flag(self, "sky_in_view", "receives_light")
        checks.wholes(self, "visible_faces", 0, 5, most=6)
        checks.number(self, "air_reach_m", 0.0)
        checks.number(self, "eye_height_m")


class SunMoved(Derived, frozen=True, kw_only=True):
    """Where the sun stands; the direction is apparent, in world axes, pointing to the sun."""

    slot: ClassVar[str | None] = "sun"

    direction: Vector
    azimuth_rad: float
    elevation_rad: float
    apparent_elevation_rad: float
    visible_disc_fraction: float

    def check(self) -> None:
        """Angles, and a share of the disc."""
        checks.direction(self, "direction")
        checks.number(self, "azimuth_rad", -_TURN_RAD, _TURN_RAD)
        checks.number(self, "elevation_rad", -_UP_RAD, _UP_RAD)
        checks.number(self, "apparent_elevation_rad", -_UP_RAD, _UP_RAD)
        checks.number(self, "visible_disc_fraction", 0.0, 1.0)


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

    def check(self) -> None:
        """A source, and what it reads; whether it compiles, OpenGL says."""
        checks.text(self, "source")
        checks.shader_inputs(self)


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

    def check(self) -> None:
        """A cube that a GPU can hold, with light in it."""
        if not isinstance(self.cube, GpuTexture):
            edge = -LARGEST_EDGE
            checks.array(self, "cube", (6, edge, edge, 3), ("|u1", "<f2", "<f4"))
        _check_scale(self)
        checks.light(self, "ground_radiance_rgb", _MOST_LIGHT)
        checks.text(self, "source")
        checks.flag(self, "ground_through_air")
        if self.view is not None:
            checks.instance(self, "view", ViewShader)
            self.view.check()
        if self.seen_sun_irradiance_rgb is not None:
            checks.light(self, "seen_sun_irradiance_rgb", _MOST_LIGHT)
        checks.choice(self, "color_space", ("linear-srgb",))
        checks.choice(self, "frame", ("world",))

    def check_arrays(self) -> None:
        """Radiance, which is finite."""
        if isinstance(self.cube, Array):
            most = _MOST_LIGHT / self.radiance_scale
            checks.contents(self, "cube", -most, most)


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

    def check(self) -> None:
        """A disc in the sky, and polynomials of as many terms as are drawn."""
        checks.direction(self, "direction")
        checks.light(self, "irradiance_rgb", _MOST_LIGHT)
        checks.number(self, "angular_radius_rad", 1e-6, 0.5 * math.pi)
        checks.polynomials(self, "limb_darkening_rgb", 3, _MOST_LIMB_TERMS)
        checks.text(self, "source")


class SpectrumSeen(Derived, frozen=True, kw_only=True):
    """The sky's spectral radiance (W m^-2 sr^-1 nm^-1) in a direction, without the sun's disc.

    Both lists are empty where the holder of the sky knows colours alone, as at twilight some do.
    """

    slot: ClassVar[str | None] = "sky"

    direction: Vector
    wavelength_nm: tuple[float, ...]
    radiance: tuple[float, ...]
    source: str

    def check(self) -> None:
        """As many values as wavelengths."""
        checks.direction(self, "direction")
        checks.instance(self, "wavelength_nm", tuple)
        checks.numbers(self, "wavelength_nm", min(len(self.wavelength_nm), _MOST_WAVELENGTHS))
        checks.numbers(self, "radiance", len(self.wavelength_nm))
        checks.text(self, "source")


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

    def check(self) -> None:
        """Tables that go with each other, and have something to blend between.

        Raises:
            UserError: they do not.
        """
        for name in ("rows_above", "rows_below", "columns"):
            checks.whole(self, name, 2, _LARGEST_VOLUME // 2)
        checks.instance(self, "extinction", Array)
        rows = self.rows_above + self.rows_below
        # The slices of the three kinds of light lie in one texture.
        most = -(_LARGEST_VOLUME // 3)
        checks.array(self, "extinction", (most, rows, 3), ("<f4",))
        slices = self.extinction.shape[0]
        if slices < 2:
            checks.refuse(self, "extinction", "have two slices or more")
        if not isinstance(self.light, GpuTexture):
            checks.array(self, "light", (3, slices, rows, self.columns, 3), ("<f2",))
        _check_scale(self)
        checks.numbers(self, "aerosol_phase", 3)
        if not abs(self.aerosol_phase[0]) < 1.0:
            checks.refuse(self, "aerosol_phase", "begin with a g between -1 and 1")
        checks.number(self, "reach_m", 1e-3, _LARGEST_M)
        checks.number(self, "observer_altitude_m", 0.0, _LARGEST_M)
        checks.number(self, "ground_radius_m", 1.0, _LARGEST_M)
        checks.number(self, "top_altitude_m", 1.0, _LARGEST_M)
        checks.direction(self, "sun_direction")

    def check_arrays(self) -> None:
        """Light that is finite, and air that takes light and gives none.

        Raises:
            UserError: there is none such.
        """
        if isinstance(self.light, Array):
            most = _MOST_LIGHT / self.radiance_scale
            checks.contents(self, "light", -most, most)
        checks.contents(self, "extinction", 0.0, _MOST_EXTINCTION_PER_M)


class AirChanged(Derived, frozen=True, kw_only=True):
    """The air in front of the scene; no volume where it would not be seen."""

    slot: ClassVar[str | None] = "sky"

    volume: AirVolume | None
    source: str

    def check(self) -> None:
        """What the volume says of itself."""
        checks.text(self, "source")
        if self.volume is not None:
            checks.instance(self, "volume", AirVolume)
            self.volume.check()

    def check_arrays(self) -> None:
        """What the volume's tables hold."""
        if self.volume is not None:
            self.volume.check_arrays()


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

    def check(self) -> None:
        """A layer with some thickness, and maps that a GPU can hold.

        Raises:
            UserError: it is none.
        """
        checks.number(self, "base_m", -_LARGEST_M, _LARGEST_M)
        checks.number(self, "thickness_m", 1e-3, _LARGEST_M)
        checks.number(self, "extinction_per_m", 0.0, _MOST_EXTINCTION_PER_M)
        checks.number(self, "coverage", 0.0, 1.0)
        checks.number(self, "threshold")
        checks.number(self, "column_density", 0.0)
        checks.numbers(self, "drift_m", 2)
        checks.numbers(self, "phase", 3)
        map_edge, volume_edge = -LARGEST_EDGE, -_LARGEST_VOLUME
        checks.array(self, "weather", (map_edge,) * 2, ("<u2",))
        checks.array(self, "shape", (volume_edge,) * 3, ("|u1",))
        checks.array(self, "detail", (volume_edge,) * 3, ("|u1",))


class CloudsChanged(Derived, frozen=True, kw_only=True):
    """The clouds; no layer where there are none."""

    layer: CloudLayer | None
    source: str

    def check(self) -> None:
        """What the layer says of itself."""
        checks.text(self, "source")
        if self.layer is not None:
            checks.instance(self, "layer", CloudLayer)
            self.layer.check()


class AmbientChanged(Derived, frozen=True, kw_only=True):
    """Irradiance of sky and ground, without the sun: harmonics (25, 3) float32, W m^-2."""

    slot: ClassVar[str | None] = "sky"

    irradiance_sh_rgb: Array
    source: str

    def check(self) -> None:
        """The harmonics of order 4 and below."""
        checks.array(self, "irradiance_sh_rgb", (25, 3), ("<f4", "<f8"))
        checks.text(self, "source")

    def check_arrays(self) -> None:
        """Irradiance, which is finite."""
        checks.contents(self, "irradiance_sh_rgb", -_MOST_LIGHT, _MOST_LIGHT)


def _check_scale(message: BackgroundChanged | AirVolume) -> None:
    # Below it values of 32 bits lose digits; the largest of 16 bits is 65504.
    checks.number(message, "radiance_scale", 2.0**-126, _MOST_LIGHT)
