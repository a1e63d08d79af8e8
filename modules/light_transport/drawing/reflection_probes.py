"""Cube maps of the surroundings of glossy parts, on the GPU: uploaded when such a part is seen."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from light_transport.drawing.hour_on_card import HourOnCard
from vrut_lite.frame_part import PartGl
from vrut_lite.messages.light_map import ReflectionProbes, SurfaceLightChanged

SAMPLERS = ("mirror", "mirror_nearness")


class MirrorCubes:
    """The cubes of one hour's light; used on the GL thread only."""

    def __init__(self, gl: PartGl):
        self._gl, self._context = gl, gl.context
        self._mirrors: ReflectionProbes | None = None
        self._light: SurfaceLightChanged | None = None
        self._card: HourOnCard | None = None
        self._texels = ""
        # By number: radiance and nearness, with their light and layout.
        self._textures: dict[int, tuple[Any, Any]] = {}
        self._radiance_is_of: dict[int, SurfaceLightChanged] = {}

    @property
    def there(self) -> bool:
        """Whether there are cubes to reflect."""
        return self._mirrors is not None and self._light is not None

    def show(
        self,
        mirrors: ReflectionProbes | None,
        light: SurfaceLightChanged | None,
        card: HourOnCard | None,
    ) -> None:
        """Take the light of an hour in place of the last; a `card` has computed it."""
        texels = "f4" if card is not None or light is None else _type_of(light)
        if mirrors is not self._mirrors or texels != self._texels:
            self.release()
        self._card, self._texels = card, texels
        has_light = light is not None and light.mirrors is not None
        self._mirrors, self._light = mirrors, light if has_light else None

    def upload(self, number: int) -> None:
        """Bring a part's cubes to the GPU; before anything is drawn, or it waits for that."""
        assert self._mirrors is not None
        assert self._light is not None
        assert self._light.mirrors is not None
        if number not in self._textures:
            nearness = self._mirrors.nearness.values[number][..., None]
            edge = nearness.shape[1]
            self._textures[number] = self._cube(edge, 4, self._texels), self._cube(edge, 1, "f4")
            _write(self._textures[number][1], nearness)
        radiance, _ = self._textures[number]
        if self._radiance_is_of.get(number) is not self._light:
            if self._card is None:
                _write(radiance, self._light.mirrors.values[number])
            else:
                self._card.write_mirror(number, radiance)
            radiance.build_mipmaps()
            radiance.filter = (self._context.LINEAR_MIPMAP_LINEAR, self._context.LINEAR)
            self._radiance_is_of[number] = self._light

    def bind(self, number: int) -> None:
        """Bind a part's cubes, which are uploaded."""
        for sampler, cube in zip(SAMPLERS, self._textures[number], strict=True):
            cube.use(location=self._gl.unit(sampler))

    def from_middle_m(self, number: int, eye_m: NDArray[np.float64]) -> NDArray[np.float64]:
        """The eye (3,) as seen from the middle of a part's cubes."""
        assert self._mirrors is not None
        return np.asarray(eye_m - self._mirrors.centre_m.values[number])

    def release(self) -> None:
        """Free the GL objects."""
        if self._textures:
            self._gl.leave_framebuffers()
        for cubes in self._textures.values():
            for cube in cubes:
                cube.release()
        self._textures.clear()
        self._radiance_is_of.clear()

    def _cube(self, edge: int, channels: int, dtype: str) -> Any:
        """A cube map."""
        cube = self._context.texture_cube((edge, edge), channels, dtype=dtype)
        cube.filter = (self._context.LINEAR, self._context.LINEAR)
        return cube


def _type_of(light: SurfaceLightChanged) -> str:
    """Type of the texels of cubes that are uploaded."""
    return "f2" if light.mirrors is None else f"f{light.mirrors.values.itemsize}"


def _write(cube: Any, values: NDArray[Any]) -> None:
    for face, texels in enumerate(values):
        cube.write(face, np.ascontiguousarray(texels).tobytes())
