"""Cube maps of the surroundings of glossy parts, on the GPU: uploaded when such a part is seen."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from vrut_lite.frame_part import PartGl
from vrut_lite.messages.light_map import ReflectionProbes, SurfaceLightChanged

SAMPLERS = ("mirror", "mirror_nearness")


class MirrorCubes:
    """The cubes of one hour's light; used on the GL thread only."""

    def __init__(self, gl: PartGl):
        self._gl, self._context = gl, gl.context
        self._mirrors: ReflectionProbes | None = None
        self._light: SurfaceLightChanged | None = None
        # By number: radiance and nearness, with their light and layout.
        self._textures: dict[int, tuple[Any, Any]] = {}
        self._radiance_is_of: dict[int, SurfaceLightChanged] = {}

    @property
    def there(self) -> bool:
        """Whether there are cubes to reflect."""
        return self._mirrors is not None and self._light is not None

    def show(self, mirrors: ReflectionProbes | None, light: SurfaceLightChanged | None) -> None:
        """Take the light of an hour in place of the last."""
        if mirrors is not self._mirrors:
            self.release()
        has_light = light is not None and light.mirrors is not None
        self._mirrors, self._light = mirrors, light if has_light else None

    def upload(self, number: int) -> None:
        """Bring a part's cubes to the GPU; before anything is drawn, or it waits for that."""
        assert self._mirrors is not None
        assert self._light is not None
        assert self._light.mirrors is not None
        if number not in self._textures:
            nearness = self._mirrors.nearness.values[number]
            self._textures[number] = (
                self._cube(self._light.mirrors.values[number]),
                self._cube(nearness[..., None]),
            )
        radiance, _ = self._textures[number]
        if self._radiance_is_of.get(number) is not self._light:
            _write(radiance, self._light.mirrors.values[number])
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

    def _cube(self, values: NDArray[Any]) -> Any:
        """A cube map of values (6, e, e, C)."""
        edge, channels = values.shape[2:]
        data = np.ascontiguousarray(values).tobytes()
        cube = self._context.texture_cube((edge, edge), channels, data, dtype=f"f{values.itemsize}")
        cube.filter = (self._context.LINEAR, self._context.LINEAR)
        return cube


def _write(cube: Any, values: NDArray[Any]) -> None:
    for face, texels in enumerate(values):
        cube.write(face, np.ascontiguousarray(texels).tobytes())
