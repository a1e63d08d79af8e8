"""The air between the eye and the scene."""

from typing import ClassVar

import msgspec

from vrut_lite import checks
from vrut_lite.array import Array
from vrut_lite.kernel.messages import Derived
from vrut_lite.messages.gpu_texture import GpuTexture
from vrut_lite.messages.limits import LARGEST_VOLUME, MOST_LIGHT, check_scale
from vrut_lite.numeric_types import Vector

_LARGEST_M = 1e10
_MOST_EXTINCTION_PER_M = 1e3
# Angles of a phase function, and its largest value: a texture holds them in single precision.
_MOST_ANGLES, _MOST_PHASE = 8192, 1e9


class SecondLight(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Light of a second body, scattered by the air of an `AirVolume`; no shadow removes it.

    Attributes:
        light: as the volume's, at the same nodes, but with columns counted from this body's azimuth
            and phase functions of the angle to this body. None where the volume's is a texture,
            which has this light's slices after its own.
        radiance_scale: factor of this light, a power of two; in a texture the volume's.
        direction: to the body, in world axes.
    """

    light: Array | None
    radiance_scale: float
    direction: Vector

    def check(self, shape: tuple[int, ...] | None) -> None:
        """Light of the volume's `shape`, None for a texture; a scale and a direction.

        Raises:
            UserError: a field is invalid.
        """
        if shape is not None:
            checks.instance(self, "light", Array)
            checks.array(self, "light", shape, ("<f2",))
        elif self.light is not None:
            checks.refuse(self, "light", "be None where the volume's is a texture")
        check_scale(self)
        checks.direction(self, "direction")


class AirVolume(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The air between an eye and surfaces in all directions, up to a reach.

    Values are kept at nodes (slices, rows, columns) by distance, height and azimuth from the
    sun; `vrut_lite.sky.air_volume` places the nodes and looks values up.
    Radiance is linear sRGB, to be multiplied by `radiance_scale` (a power of two), and is a mean
    along the ray: the air before a point adds mean * (1 - transmittance).

    Attributes:
        light: (3, slices, rows, columns, 3) of three kinds. Light scattered twice or more, W m^-2
            sr^-1: it remains in shadow. Sunlight scattered
            once by molecules, and once by aerosol, each to be multiplied by its phase function
            (sr^-1): W m^-2. An array of float16, or a texture, the slices of one kind after those
            of the other.
        extinction: (slices, rows, 3) float32, m^-1, mean along the ray: transmittance is
            exp(-extinction * distance).
        aerosol_phase: (n, 3) float32, the aerosol's phase function in each channel, sr^-1, at n
            angles uniform in sin(angle / 2).
        rows_above, rows_below: numbers of rows above and below the horizon.
        reach_m: length of a ray that the slices span at most, from where it enters the air.
        sun_direction: to the body whose light this is, whose shadows the scene casts.
        second: the light of another body, the sun or the moon; None where one lights the air.
    """

    light: Array | GpuTexture
    extinction: Array
    columns: int
    radiance_scale: float
    aerosol_phase: Array
    rows_above: int
    rows_below: int
    reach_m: float
    observer_altitude_m: float
    ground_radius_m: float
    top_altitude_m: float
    sun_direction: Vector
    second: SecondLight | None = None

    def check(self) -> None:
        """Tables whose shapes match, with at least two nodes along each axis.

        Raises:
            UserError: a table or a field is invalid.
        """
        for name in ("rows_above", "rows_below", "columns"):
            checks.whole(self, name, 2, LARGEST_VOLUME // 2)
        checks.instance(self, "extinction", Array)
        rows = self.rows_above + self.rows_below
        checks.instance(self, "second", (SecondLight, type(None)))
        # The slices of the three kinds of light, of one body or two, lie in one texture.
        most = -(LARGEST_VOLUME // (3 if self.second is None else 6))
        checks.array(self, "extinction", (most, rows, 3), ("<f4",))
        slices = self.extinction.shape[0]
        if slices < 2:
            checks.refuse(self, "extinction", "have two slices or more")
        shape = (3, slices, rows, self.columns, 3)
        if self.second is not None:
            self.second.check(None if isinstance(self.light, GpuTexture) else shape)
        if not isinstance(self.light, GpuTexture):
            checks.array(self, "light", shape, ("<f2",))
        check_scale(self)
        checks.instance(self, "aerosol_phase", Array)
        checks.array(self, "aerosol_phase", (-_MOST_ANGLES, 3), ("<f4",))
        if self.aerosol_phase.shape[0] < 2:
            checks.refuse(self, "aerosol_phase", "have two angles or more")
        checks.number(self, "reach_m", 1e-3, _LARGEST_M)
        checks.number(self, "observer_altitude_m", 0.0, _LARGEST_M)
        checks.number(self, "ground_radius_m", 1.0, _LARGEST_M)
        checks.number(self, "top_altitude_m", 1.0, _LARGEST_M)
        checks.direction(self, "sun_direction")

    def check_arrays(self) -> None:
        """Finite light, and extinction that is not negative.

        Raises:
            UserError: a value is infinite, NaN or negative.
        """
        for source in (self, self.second):
            if source is not None and isinstance(source.light, Array):
                most = MOST_LIGHT / source.radiance_scale
                checks.contents(source, "light", -most, most)
        checks.contents(self, "extinction", 0.0, _MOST_EXTINCTION_PER_M)
        checks.contents(self, "aerosol_phase", 0.0, _MOST_PHASE)


class AirChanged(Derived, frozen=True, kw_only=True):
    """The air in front of the scene; the volume is None where air is invisible."""

    slot: ClassVar[str | None] = "sky"

    volume: AirVolume | None
    source: str

    def check(self) -> None:
        """Check the volume."""
        checks.text(self, "source")
        if self.volume is not None:
            checks.instance(self, "volume", AirVolume)
            self.volume.check()

    def check_arrays(self) -> None:
        """Check the content of the volume's tables."""
        if self.volume is not None:
            self.volume.check_arrays()
