"""Frame parts: what modules draw into the picture.

A module brings a part by an entry point of the group `vrut_lite.frame_parts` that names a subclass
of `FramePart`. The scene manager hears the messages that it names in `hears`; the renderer makes
one instance on its GL thread, passes it those messages and calls its hooks, in this order for a
picture: `prepare`, opaque surfaces and the sky, `draw_over_sky`, `draw_over_solid`, and blended
surfaces. No other code refers to it.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar, NamedTuple, Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray

from vrut_lite.kernel.messages import Derived
from vrut_lite.kernel.work_counters import WorkCounters
from vrut_lite.messages.camera import MoveCamera
from vrut_lite.messages.scene import SceneOpened
from vrut_lite.messages.sky import AmbientChanged
from vrut_lite.messages.sun import KeyLightChanged
from vrut_lite.numeric_types import Float32Array, FloatArray, Vector
from vrut_lite.uniform_block import UniformBlock

# Latest messages that a part shows, by type.
Heard = Mapping[type[Derived], Derived]
Size = tuple[int, int]
D = TypeVar("D", bound=Derived)
# Number of the ground disc among the scene's parts.
GROUND = -1
# Angle from the sun up to which surfaces shade the air before them without light shafts too: there
# particles scatter so much forward that the unshaded air would outshine what hides the sun.
SUN_GLOW_RAD = math.radians(25.0)


# Whether a point has no surface in a unit direction (3,) up to a distance (m).
IsFree = Callable[[FloatArray, float], bool]


class PartView(Protocol):
    """The camera of a picture."""

    @property
    def eye_m(self) -> NDArray[np.float64]:
        """The eye (3,), world axes."""

    @property
    def rotation(self) -> NDArray[np.float64]:
        """Matrix (4, 4) from world axes to the camera's."""

    @property
    def projection(self) -> NDArray[np.float64]:
        """Matrix (4, 4) from the camera's axes to clip space; depth is reversed."""

    @property
    def clip_from_eye(self) -> NDArray[np.float64]:
        """Matrix (4, 4) from positions relative to the eye, in world axes, to clip space."""


class Casters(Protocol):
    """Shadow casters of a scene; a new object when their depth must be redrawn."""

    @property
    def centre_m(self) -> NDArray[np.float64]:
        """Centre (3,) of the scene's sphere, world axes."""

    @property
    def radius_m(self) -> float:
        """Radius of that sphere."""

    def draw_depth(
        self, clip_from_place: NDArray[np.float64], place_m: NDArray[np.float64]
    ) -> None:
        """Draw the depth of both sides of their faces into the bound framebuffer.

        The matrix (4, 4) maps positions relative to a place (3,), in world axes, to clip space.
        """


class PartShadow(NamedTuple):
    """Shadow map of the sun in all the scene.

    `texture` compares depths; `clip_from_eye` (4, 4) maps positions relative to the eye, in world
    axes, into it.
    """

    texture: Any
    clip_from_eye: NDArray[np.float64]


class PlacedSurface(Protocol):
    """A mesh placed in the scene."""

    @property
    def part(self) -> int | None:
        """Number of the scene's part, `GROUND` for the ground disc, None for points and lines."""

    @property
    def is_two_sided(self) -> bool:
        """Whether its back faces are drawn."""


class Hit(NamedTuple):
    """Hit of a ray: point, unit normal (3,) towards the ray's start, and material.

    `part` is `GROUND` or the scene's part, `triangle` the number in its mesh.
    """

    point_m: FloatArray
    normal: FloatArray
    material: str
    part: int
    triangle: int


@dataclass(frozen=True, eq=False)
class MeshChart:
    """A mesh unwrapped so that each of its points has a place in a part's map.

    Attributes:
        source_vertex: (V,) int32, the mesh's vertex that each of these copies.
        uv: (V, 2) places of these vertices in the map, which shaders get as `place_px`.
        triangles: (F, 3) int32, numbers of these vertices, in the order of the mesh's triangles.
    """

    source_vertex: NDArray[np.int32]
    uv: Float32Array
    triangles: NDArray[np.int32]


@dataclass(frozen=True)
class PartFrame:
    """A picture that is about to be drawn.

    Attributes:
        view: the camera's matrices.
        camera: the camera as it was set.
        shows: "picture", or the name of the values that are shown in false colours.
        seen: surfaces that may be in the picture.
        size_px: width and height.
        is_still: whether it must be complete; otherwise it is a moving picture and must be quick.
        is_first_view: False for the views of a frame after its first, a headset's second eye: work
            that is done in slices goes on in the first alone, and all show the same.
        highest_m: y that no surface of the scene exceeds.
        ground_level_m: y of the ground behind the scene.
        key_light: the light with shadows, unattenuated by parts.
        clear_sky: irradiance of the clear sky.
        whole_sky: irradiance of the sky with its layers.
        ground_is_bare: whether the background shows that ground without air in front of it.
        casters: the shadow casters of the scene.
        shadow: the scene's shadow map if its shadows are visible in the air: all of them, or those
            in the glow around the sun (`SUN_GLOW_RAD`) if that may be in the picture.
        light_shafts: whether all shadows of the scene are visible in the air.
        air: defines with which a part's own shader includes `through_air.glsl`; empty without
            air, and in `prepare`.
    """

    view: PartView
    camera: MoveCamera
    shows: str
    seen: Sequence[PlacedSurface]
    size_px: Size
    is_still: bool
    highest_m: float
    ground_level_m: float
    key_light: KeyLightChanged
    clear_sky: AmbientChanged
    whole_sky: AmbientChanged
    ground_is_bare: bool
    casters: Casters
    shadow: PartShadow | None
    light_shafts: bool
    air: tuple[str, ...] = ()
    is_first_view: bool = True


class PartTarget(Protocol):
    """The framebuffer of a picture."""

    size: Size

    @property
    def buffer(self) -> Any:
        """moderngl's framebuffer: radiance (linear sRGB, W m^-2 sr^-1) and depth."""


class Screen(Protocol):
    """A fragment shader for every pixel; its input `ray` is the pixel's direction from the eye."""

    program: Any

    def set(self, name: str, value: Any) -> None:
        """Set a uniform, a number or numbers, unless the compiler found it unused."""

    def draw(
        self, view: PartView | None = None, box_px: tuple[int, int, int, int] | None = None
    ) -> None:
        """Draw into the bound framebuffer, or a box of it: left, lower, width and height.

        Without a view the rays of the last one are used.
        """

    def release(self) -> None:
        """Free it before the part goes."""


class ComputePass(Protocol):
    """A compute shader."""

    def set(self, name: str, value: Any) -> None:
        """Set a uniform, a number or numbers, unless the compiler found it unused."""

    def run(self, x: int, y: int = 1, z: int = 1) -> None:
        """Run so many work groups; passes and pictures that follow see what they wrote."""


class Tiles(Protocol):
    """A pass that may be given up while it is drawn."""

    def draw(self, size: Size, draw: Callable[[Any], None]) -> None:
        """Call `draw` for each piece of a picture of this size, clipped to it."""


class DepthCopy(Protocol):
    """The depth of a framebuffer, one sample a pixel, for shaders."""

    def copy(self, framebuffer: Any) -> None:
        """Take the depth of a framebuffer as it is now."""

    def use(self, location: int) -> None:
        """Bind it to a texture unit."""

    def release(self) -> None:
        """Free it."""


class PartGl(Protocol):
    """The renderer's side of a part; it frees screens and programs when the part goes.

    A part's own program may use texture units 0 to 8, 10 and 11: sky and meshes rebind theirs.

    Attributes:
        context: moderngl's context.
        gl: the functions of OpenGL (PyOpenGL's `OpenGL.GL`).
        counters: counts what the frame did and skipped.
        before_sky: least reversed depth of surfaces; the sky's is less.
    """

    context: Any
    gl: Any
    counters: WorkCounters
    before_sky: float

    def screen(self, fragment_shader: Path, defines: tuple[str, ...] = ()) -> Screen:
        """A program of a module's own shader; `//!include FILE` brings a file beside it, one of
        the renderer's, or one of the part's blocks."""

    def program(self, vertex_shader: Path, fragment_shader: Path) -> Any:
        """moderngl's program of a module's own shaders."""

    def compute(self, shader: Path, defines: tuple[str, ...] = ()) -> ComputePass:
        """A compute shader of a module's own; it includes as fragment shaders do."""

    def check_wanted(self) -> None:
        """Call it between pieces of slow work in `prepare`.

        Raises:
            GivenUp: nobody waits for the picture any more; the part lets it pass.
        """

    def report(self, job: str, error: str) -> None:
        """Send the part's module a failed `JobResult`; the part stays in pictures."""

    def tiles(self, most: int | None = None) -> Tiles:
        """A slow pass drawn in pieces of at most `most` of the renderer's tiles."""

    def depth_copy(self, size: Size) -> DepthCopy:
        """A texture for the depth of pictures of a size."""

    def by_size(self, make: Callable[[Size], Any]) -> Any:
        """A cache of the results of `make` for the last two sizes: `get(size)`, `release()`."""

    def block(self, name: str) -> UniformBlock:
        """One of the part's `blocks`, with its binding."""

    def unit(self, sampler: str) -> int:
        """Texture unit of one of the part's `samplers`."""

    def average_down(self, texture: Any) -> None:
        """Generate the mipmaps of a texture; the caller sets its filter."""

    def leave_framebuffers(self) -> None:
        """Bind a permanent framebuffer, before others are freed."""


class FramePart:
    """A module's part of the frame; override the hooks it uses.

    Instances are made and called on the GL thread, class methods on other threads too.

    A part belongs to the module that has the name of its entry point. One that raises is left out
    of all further pictures, and is that module's Fault. If the module provides a slot of that name,
    the part is switched off while nobody holds the slot.

    Class attributes:
        hears: messages whose latest ones `show` gets; a slot's are dropped when nobody holds it.
            The scene manager demands them, and adds the open scene where a part hears
            `SceneOpened`.
        on_demand: those among them that the scene manager does not demand.
        blocks: uniform blocks of its shaders, by the names that these include.
        samplers: names of textures that surfaces and sky look up for it, declared in GLSL by a
            line `//!sampler TYPE NAME`; `gl.unit(name)` is where it binds them in `prepare`.
        sun_factor: GLSL that dims the sun before it reaches a surface, called while `shades_sun`:
            `float sun_factor(vec3 from_eye)` is the share that reaches a point,
            `vec3 ground_factor(vec3 from_eye)` that of the light of open ground, and
            `float sun_factor_end_m(vec3 d, float metres)` how far along a ray points may be
            dimmed.
        irradiance: GLSL of the light on surfaces, without the key light's direct part, for those
            that have `surface_defines`: render/shaders/light_of_surface.glsl lists its functions.
            The part's messages are demanded while a scene is open.
        extra_lights: GLSL of lights besides sun and sky, called while the part is seen:
            `int extra_light_count()`, and `vec3 extra_light(int number, vec3 point, vec3 face,
            out vec3 towards)`, the irradiance (W m^-2) of one on a plane that faces it at a point
            from the eye, on a surface with the normal `face`; `towards` is its direction.
        through_air: GLSL of the air, called while the part is seen: `vec3 through_air(vec3
            radiance, vec3 direction, float metres, float share)` is a radiance seen at that
            distance, through air with a share of the light of open air;
            `float ground_horizon()` is the sine of the elevation that divides the sky from the
            ground behind the scene, `void background_through_air(vec3 direction, inout vec3
            ground, inout vec3 sky)` adds the air that both lack. LIGHT_SHAFTS is defined with
            `PartFrame.light_shafts`, SUN_FACTOR where a part dims the sun.
        switch: name of the scene's setting that switches the part; its messages are demanded only
            while that is on and a scene is open. Empty: always.

    Several installed parts may have `sun_factor`, whose shares are multiplied, and `extra_lights`;
    other functions of these files begin with the part's name. One may have `irradiance`, and one
    `through_air`.
    """

    hears: ClassVar[tuple[type[Derived], ...]] = ()
    on_demand: ClassVar[tuple[type[Derived], ...]] = ()
    blocks: ClassVar[Mapping[str, UniformBlock]] = {}
    samplers: ClassVar[tuple[str, ...]] = ()
    sun_factor: ClassVar[Path | None] = None
    irradiance: ClassVar[Path | None] = None
    extra_lights: ClassVar[Path | None] = None
    through_air: ClassVar[Path | None] = None
    switch: ClassVar[str] = ""

    def __init__(self, gl: PartGl):
        self.gl = gl

    @classmethod
    def hear(cls, heard: Heard, message: Derived) -> Heard:
        """The messages to show after one that arrives: the latest of each type."""
        return {**heard, type(message): message}

    @classmethod
    def demands(cls, kind: type[Derived]) -> bool:
        """Whether the scene manager demands a type of message that the part hears."""
        return kind is not SceneOpened and kind not in cls.on_demand

    @classmethod
    def reach_m(cls, heard: Heard, camera: MoveCamera) -> float:
        """Distance from the eye up to which it draws things in the air."""
        return 0.0

    @classmethod
    def sun_share(cls, heard: Heard, point_m: Vector, direction: Vector) -> float:
        """Share of the sun in a direction that it lets reach a point: `sun_factor`'s twin."""
        return 1.0

    @classmethod
    def extra_irradiance(
        cls,
        heard: Heard,
        camera: MoveCamera,
        point_m: FloatArray,
        normal: FloatArray,
        is_free: IsFree,
    ) -> FloatArray:
        """Irradiance (3,), W m^-2, of its lights on a plane: the twin of `extra_lights`."""
        return np.zeros(3)

    @classmethod
    def irradiance_at(cls, heard: Heard, hit: Hit, sky: AmbientChanged) -> FloatArray | None:
        """Irradiance (3,), linear sRGB in W m^-2, of a surface: `irradiance`'s twin.

        None where the open sky lights the surface.
        """
        return None

    @classmethod
    def finishes(cls, heard: Heard, camera: MoveCamera, size_px: Size) -> bool:
        """Whether it has the light of a finished still, which is the mean of several pictures."""
        return False

    @classmethod
    def may_reuse(cls, before: Heard, now: Heard, hour_moved: bool) -> bool:
        """Whether moving pictures may reuse surfaces that were drawn with other messages.

        `hour_moved`: sun and sky have changed a little with the hour, otherwise they are the same.
        A part whose light moves with the camera returns False.
        """
        if cls.sun_factor or cls.extra_lights:
            return are_same(before, now)
        return cls.through_air is None or hour_moved or are_same(before, now)

    def show(self, heard: Heard) -> None:
        """Draw these from the next picture on; called when one of them changes."""

    @property
    def is_seen(self) -> bool:
        """Whether there is anything to draw."""
        return True

    @property
    def charts(self) -> Sequence[MeshChart | None] | None:
        """Charts of the scene's parts in their order, None for meshes that stay whole.

        Read after `show`; the same object while the charts are unchanged.
        """
        return None

    def sees_sky(self, surface: PlacedSurface) -> bool:
        """Whether a surface may get light from the sky itself; asked before `prepare`."""
        return True

    def surface_defines(self, surface: PlacedSurface) -> tuple[str, ...]:
        """Defines of a surface's program with which `irradiance` is compiled; empty: it is not."""
        return ()

    def bind_surface(self, surface: PlacedSurface) -> Mapping[str, Any]:
        """Bind the textures of `irradiance` for a surface; returns values of its uniforms.

        The same object while the values are the same.
        """
        return {}

    def prepare(self, frame: PartFrame) -> None:
        """Compute the data of the picture, and bind the textures that surfaces sample."""

    @property
    def shades_sun(self) -> bool:
        """Whether `sun_factor` dims anything in the picture that was prepared."""
        return False

    @property
    def air_defines(self) -> tuple[str, ...]:
        """Defines with which `through_air` is compiled in the picture that was prepared."""
        return ()

    def air_defines_on(self, centre_m: NDArray[np.float64], radius_m: float) -> tuple[str, ...]:
        """Further defines on surfaces within a sphere, its centre (3,) in world axes."""
        return ()

    def draw_over_sky(self, size_px: Size, view: PartView) -> None:
        """Add radiance (linear sRGB, W m^-2 sr^-1) to the sky where no surface covers it.

        Blending adds what fragments return, whose alpha must be 0.
        """

    def draw_over_solid(self, frame: PartFrame, target: PartTarget, sample: int) -> None:
        """Draw over sky and solid surfaces; `sample`: which of a still's pictures."""

    def release(self) -> None:
        """Free the GL objects that the part made by itself."""


def latest(heard: Heard, kind: type[D]) -> D | None:
    """The latest message of a type that is heard, or None."""
    message = heard.get(kind)
    assert message is None or isinstance(message, kind)
    return message


def are_same(before: Heard, now: Heard) -> bool:
    """Whether a part heard the very same messages."""
    return before.keys() == now.keys() and all(before[kind] is now[kind] for kind in now)
