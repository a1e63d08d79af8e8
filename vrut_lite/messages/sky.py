"""The sky behind the scene, its light on surfaces, and its spectrum."""

from itertools import pairwise
from typing import ClassVar, Literal

import msgspec
import numpy as np
from numpy.typing import ArrayLike

from vrut_lite import checks
from vrut_lite.array import Array
from vrut_lite.geometry.colour import luminance
from vrut_lite.kernel.messages import Derived, Input
from vrut_lite.messages.gpu_job import GpuPass, check_programs, check_shared
from vrut_lite.messages.gpu_texture import GpuTexture
from vrut_lite.messages.limits import LARGEST_EDGE, MOST_LIGHT, check_scale
from vrut_lite.numeric_types import Number, Vector

NO_LAMPS: Vector = (0.0, 0.0, 0.0)

_MOST_WAVELENGTHS = 4096
# Edge of cube maps of spectra, and the range of their wavelengths.
_LARGEST_SPECTRA = 256
_VISIBLE_NM = (360.0, 830.0)


class ViewShader(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The background as a shader, evaluated for each pixel.

    `source` is GLSL 4.30 of a fragment shader, without a `#version` line, that defines

        vec3 background_radiance(vec3 direction)   // sky and planet, W m^-2 sr^-1
        vec3 background_sunlight(vec3 direction)   // irradiance by a sun that is seen there, W m^-2

    of a unit vector in world axes, in linear sRGB: the second on a plane that faces the sun, behind
    the air, and zero where a planet hides it. Functions are called for every
    pixel alike, so that derivatives may be taken. All names that it declares begin with
    `background_`. It reads `uniforms` by name, and `buffers`: pairs of a binding and the content
    of the std430 storage buffer there, an `Array` of float32.

    `programs` are compute shaders that run once, one after the other, before its first picture;
    they write `shared`: storage buffers that the source reads too, pairs of a binding and a number
    of float32.
    """

    source: str
    uniforms: dict[str, Number | tuple[Number, ...]]
    buffers: tuple[tuple[int, Array], ...] = ()
    programs: tuple[GpuPass, ...] = ()
    shared: tuple[tuple[int, int], ...] = ()

    def check(self) -> None:
        """Check the source and its inputs; only OpenGL can tell whether it compiles."""
        checks.text(self, "source")
        checks.shader_inputs(self)
        check_programs(self, "programs")
        check_shared(self, "shared")


class BackgroundChanged(Derived, frozen=True, kw_only=True):
    """A new sky without its disc, as a cube map in world axes.

    cube (6, size, size, 3) float16, or a cube texture that stays on the GPU; linear sRGB
    radiance in W m^-2 sr^-1 is cube times `radiance_scale`, a power of two. The lower half
    holds `ground_radiance_rgb` (W m^-2 sr^-1): it excludes the air, which the renderer adds, unless
    `ground_through_air`. Where a cube map would blur the picture, `view` shows the same per pixel
    with the sun's disc; the cube still serves lighting and reflections. `seen_sun_irradiance_rgb`
    (W m^-2) is the sun's irradiance at the eye where it differs from the scene's.
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
        """Check the cube's size, scale and values' types."""
        if not isinstance(self.cube, GpuTexture):
            edge = -LARGEST_EDGE
            checks.array(self, "cube", (6, edge, edge, 3), ("|u1", "<f2", "<f4"))
        check_scale(self)
        checks.light(self, "ground_radiance_rgb", MOST_LIGHT)
        checks.text(self, "source")
        checks.flag(self, "ground_through_air")
        if self.view is not None:
            checks.instance(self, "view", ViewShader)
            self.view.check()
        if self.seen_sun_irradiance_rgb is not None:
            checks.light(self, "seen_sun_irradiance_rgb", MOST_LIGHT)
        checks.choice(self, "color_space", ("linear-srgb",))
        checks.choice(self, "frame", ("world",))

    def check_arrays(self) -> None:
        """Radiance, which is finite."""
        if isinstance(self.cube, Array):
            most = MOST_LIGHT / self.radiance_scale
            checks.contents(self, "cube", -most, most)


class AmbientChanged(Derived, frozen=True, kw_only=True):
    """Irradiance of sky and ground, without the sun: harmonics (25, 3) float32, W m^-2.

    `lamps_rgb` is the radiance of the lands around by their lamps, W m^-2 sr^-1, which lights
    clouds, and the scene by them alone.
    """

    slot: ClassVar[str | None] = "sky"

    irradiance_sh_rgb: Array
    source: str
    lamps_rgb: Vector = NO_LAMPS

    @property
    def level(self) -> float:
        """The mean luminance of sky and ground around the scene, times a constant; at least 0."""
        return mean_level(self.irradiance_sh_rgb.values)

    def check(self) -> None:
        """The harmonics of order 4 and below."""
        checks.array(self, "irradiance_sh_rgb", (25, 3), ("<f4", "<f8"))
        checks.light(self, "lamps_rgb", MOST_LIGHT)
        checks.text(self, "source")

    def check_arrays(self) -> None:
        """Irradiance, which is finite."""
        checks.contents(self, "irradiance_sh_rgb", -MOST_LIGHT, MOST_LIGHT)


def mean_level(irradiance_sh: ArrayLike) -> float:
    """The mean luminance of all directions, times a constant, of harmonics (25, 3); at least 0."""
    return max(0.0, float(luminance(np.asarray(irradiance_sh)[0])))


class SkyRadianceChanged(Derived, frozen=True, kw_only=True):
    """The sky as it lights the scene: seen from the ground, without the sun's disc.

    For consumers that integrate radiance on the CPU: the background may stay on the GPU and is seen
    from the camera's height. cube (6, size, size, 3) float16 in world axes; linear sRGB radiance in
    W m^-2 sr^-1 is cube times `radiance_scale`. Below the horizon it holds `ground_radiance_rgb`
    (W m^-2 sr^-1).
    """

    slot: ClassVar[str | None] = "sky"

    cube: Array
    radiance_scale: float
    ground_radiance_rgb: Vector
    source: str

    def check(self) -> None:
        """Check the cube's size and scale."""
        edge = -LARGEST_EDGE
        checks.array(self, "cube", (6, edge, edge, 3), ("<f2",))
        check_scale(self)
        checks.light(self, "ground_radiance_rgb", MOST_LIGHT)
        checks.text(self, "source")

    def check_arrays(self) -> None:
        """Radiance, which is finite."""
        most = MOST_LIGHT / self.radiance_scale
        checks.contents(self, "cube", -most, most)


class SkyPolarisationChanged(Derived, frozen=True, kw_only=True):
    """Linear polarisation of the clear sky above the horizon, without the sun's disc.

    cube (2, 6, size, size, 3) float16 holds Q and U as cube maps in world axes; linear sRGB in
    W m^-2 sr^-1 is cube times `radiance_scale`. Q > 0 vibrates along the direction's axis
    (`geometry.polarisation.map_axis`), U > 0 at 45 degrees counter-clockwise from it, as the
    observer sees it. Below the horizon both are 0: the ground is unpolarised. The night's glow and
    clouds are too: they add to I alone. `cube` is None in a sky that knows no polarisation.
    """

    slot: ClassVar[str | None] = "sky"

    cube: Array | None
    radiance_scale: float = 1.0
    source: str

    def check(self) -> None:
        """Check the cubes' size and scale."""
        if self.cube is not None:
            edge = -LARGEST_EDGE
            checks.array(self, "cube", (2, 6, edge, edge, 3), ("<f2",))
        check_scale(self)
        checks.text(self, "source")

    def check_arrays(self) -> None:
        """Radiance, which is finite."""
        if self.cube is not None:
            most = MOST_LIGHT / self.radiance_scale
            checks.contents(self, "cube", -most, most)


class LookAlong(Input, frozen=True, kw_only=True):
    """Ask for the sky's spectrum in a direction, a unit vector in world axes."""

    revises: ClassVar[bool] = False

    direction: Vector

    def check(self) -> None:
        """A unit vector."""
        checks.direction(self, "direction")


class SpectrumSeen(Derived, frozen=True, kw_only=True):
    """The sky's spectral radiance (W m^-2 sr^-1 nm^-1) in a direction, without the sun's disc.

    Both lists are empty where the sky has no spectrum, as DynamicSkyLight at twilight.
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


class LookAround(Input, frozen=True, kw_only=True):
    """Ask for the sky's spectra in all directions, and for the sun's and the ground's.

    `wavelength_nm` rises; `size` is the edge of the cube map in texels, an even number.
    """

    revises: ClassVar[bool] = False

    wavelength_nm: tuple[float, ...]
    size: int

    def check(self) -> None:
        """Rising wavelengths of light, and a size."""
        checks.instance(self, "wavelength_nm", tuple)
        checks.numbers(self, "wavelength_nm", min(len(self.wavelength_nm), _MOST_WAVELENGTHS))
        rises = all(one < other for one, other in pairwise(self.wavelength_nm))
        low, high = self.wavelength_nm[:1] or (0.0,), self.wavelength_nm[-1:] or (0.0,)
        if not rises or not (_VISIBLE_NM[0] <= low[0] and high[0] <= _VISIBLE_NM[1]):
            checks.refuse(self, "wavelength_nm", "rise from 360 to 830 nm")
        checks.whole(self, "size", 2, _LARGEST_SPECTRA)
        if self.size % 2:
            checks.refuse(self, "size", "be even")


class SkySpectraSeen(Derived, frozen=True, kw_only=True):
    """Spectra of the clear sky, the sun and the ground around the scene, as they light it.

    cube (6, size, size, W) float32 in world axes: radiance of the sky without the sun's disc in W
    m^-2 sr^-1 nm^-1, 0 below the horizon. Tuples are of W wavelengths: `sun_irradiance` on a plane
    that faces the sun (W m^-2 nm^-1), `ground_radiance` (W m^-2 sr^-1 nm^-1), `ground_albedo`.
    Without spectra, as of weather, a photograph or a night, the cube is None and the tuples are
    empty.
    """

    slot: ClassVar[str | None] = "sky"

    wavelength_nm: tuple[float, ...]
    cube: Array | None
    sun_irradiance: tuple[float, ...]
    ground_radiance: tuple[float, ...]
    ground_albedo: tuple[float, ...]
    source: str

    def check(self) -> None:
        """As many values as wavelengths."""
        checks.instance(self, "wavelength_nm", tuple)
        count = min(len(self.wavelength_nm), _MOST_WAVELENGTHS)
        for name in ("wavelength_nm", "sun_irradiance", "ground_radiance", "ground_albedo"):
            checks.numbers(self, name, count)
        if self.cube is not None:
            edge = -_LARGEST_SPECTRA
            checks.array(self, "cube", (6, edge, edge, max(count, 1)), ("<f4",))
        checks.text(self, "source")

    def check_arrays(self) -> None:
        """Radiance, which is finite and not below zero."""
        if self.cube is not None:
            checks.contents(self, "cube", 0.0, MOST_LIGHT)
