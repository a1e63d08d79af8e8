"""Work that a module hands to the owner of the GPU, without importing any GL itself."""

from typing import Literal

from vrut_lite.kernel.messages import Derived

Number = float | int
UniformValue = Number | tuple[Number, ...]


class GpuJob(Derived, frozen=True, kw_only=True):
    """A compute shader that writes a texture; its completion comes back as a `JobResult`.

    The shader (GLSL 4.30) writes image unit 0, a cube (`imageCube`) or 2-D image
    (`image2D`) of the given size and format. Only the latest pending job of a module and
    name is run. The result's value is an `Array` (6, size, size, 4) or (size, size, 4) of
    float32 if `read_back`, else the texture stays on the GPU and the value is its GL name.
    """

    module: str
    job: str
    compute_shader: str
    uniforms: dict[str, UniformValue]
    output: Literal["cube", "2d"]
    size: int
    format: Literal["rgba16f", "rgba32f"] = "rgba16f"
    groups: tuple[int, int, int] = (1, 1, 1)
    read_back: bool = False

    def key(self) -> str:
        """One pending job per module and name."""
        return f"{self.module}.{self.job}"
