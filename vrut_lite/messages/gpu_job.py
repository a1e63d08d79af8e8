"""Compute jobs that a module sends to the owner of the GPU, without importing GL.

A host that can run such jobs demands `GpuJob` (a `Demand` as for any message). A module checks
`link.wanted(GpuJob)` and uses its CPU path where it is not wanted.
"""

import hashlib
from functools import cached_property
from typing import Any, Literal

import msgspec

from vrut_lite import checks
from vrut_lite.array import Array
from vrut_lite.kernel.messages import Derived
from vrut_lite.messages.gpu_texture import GpuTexture
from vrut_lite.messages.limits import LARGEST_EDGE

__all__ = ["GpuJob", "GpuTexture"]

Number = float | int
TexelFormat = Literal["rgba16f", "rgba32f"]
UniformValue = Number | tuple[Number, ...]
# Work groups along one axis that every OpenGL 4.3 can start.
_MOST_GROUPS = 65535
# OpenGL 4.3 has eight image units.
_MOST_SCRATCH = 6
# Numbers of a shared buffer: the 2^27 bytes that every OpenGL 4.3 can bind are 2^25.
_MOST_SHARED = 2**22


class GpuPass(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A further program of a `GpuJob`; its fields are those of the job's first program."""

    compute_shader: str
    uniforms: dict[str, UniformValue]
    groups: tuple[int, int, int] = (1, 1, 1)
    buffers: tuple[tuple[int, Array], ...] = ()

    def check(self) -> None:
        """Checks all fields; only OpenGL can tell whether the shader compiles."""
        checks.text(self, "compute_shader")
        checks.shader_inputs(self)
        checks.wholes(self, "groups", 1, _MOST_GROUPS, most=3)


class GpuJob(Derived, frozen=True, kw_only=True, dict=True):
    """A compute shader that writes a texture; its completion comes back as a `JobResult`.

    The shader (GLSL 4.30) writes image unit 0: a cube (`imageCube`) or 2-D image (`image2D`) of
    the given size and format, or a 3-D image (`image3D`) of size (width, height, depth). It reads
    `uniforms` by name, and `buffers`: pairs of a binding and the content of the std430 storage
    buffer there, an `Array` of float32, which is not sent again if the last job of this name had
    it too. Of a module's waiting jobs of one name only the latest is run. The result is an `Array`
    (6, size, size, 4), (size, size, 4) or (depth, height, width, 4) of float32 if `read_back`,
    else a `GpuTexture`, without a copy.

    Programs of `then` run after the first, one after the other, and may also read image unit 0.
    `reads` is another job's texture, at unit 1. So many `scratch` images of the output's size and
    format, undefined at first, are at units 2 and on, for all programs of the job. `shared` are
    storage buffers of all programs, undefined at first, written by one and read by a later one:
    pairs of a binding and a number of float32.
    """

    module: str
    job: str
    compute_shader: str
    uniforms: dict[str, UniformValue]
    output: Literal["cube", "2d", "3d"]
    size: int | tuple[int, int, int]
    format: TexelFormat = "rgba16f"
    groups: tuple[int, int, int] = (1, 1, 1)
    read_back: bool = False
    buffers: tuple[tuple[int, Array], ...] = ()
    then: tuple[GpuPass, ...] = ()
    scratch: int = 0
    reads: GpuTexture | None = None
    shared: tuple[tuple[int, int], ...] = ()

    def key(self) -> str:
        """One pending job per module and name."""
        return f"{self.module}.{self.job}"

    def check(self) -> None:
        """Checks all fields; only OpenGL can tell whether the shader compiles."""
        checks.text(self, "module", "job", "compute_shader")
        checks.shader_inputs(self)
        checks.choice(self, "output", ("cube", "2d", "3d"))
        checks.choice(self, "format", ("rgba16f", "rgba32f"))
        sizes = self.size if isinstance(self.size, tuple) else (self.size,) * 3
        if len(sizes) != 3 or not all(checks.is_whole(n) and 0 < n <= LARGEST_EDGE for n in sizes):
            checks.refuse(self, "size", f"be a whole number from 1 to {LARGEST_EDGE}, or three")
        checks.wholes(self, "groups", 1, _MOST_GROUPS, most=3)
        checks.flag(self, "read_back")
        checks.whole(self, "scratch", 0, _MOST_SCRATCH)
        check_programs(self, "then")
        checks.instance(self, "reads", (GpuTexture, type(None)))
        check_shared(self, "shared")

    @property
    def programs(self) -> tuple[GpuPass, ...]:
        """All programs, in order."""
        first = GpuPass(
            compute_shader=self.compute_shader,
            uniforms=self.uniforms,
            groups=self.groups,
            buffers=self.buffers,
        )
        return first, *self.then

    @cached_property
    def recipe(self) -> str:
        """Hexadecimal BLAKE2b-128 of everything that determines the texels."""
        then = [
            (step.compute_shader, step.uniforms, step.groups, _digests(step.buffers))
            for step in self.then
        ]
        reads = None if self.reads is None else self.reads.recipe
        return recipe_of(self.compute_shader, self.uniforms, self.output, self.size, self.format,
                         self.groups, _digests(self.buffers), then, reads)  # fmt: skip


def check_programs(message: msgspec.Struct, name: str) -> None:
    """Check a field of programs.

    Raises:
        UserError: it holds something else, or one is invalid.
    """
    checks.instance(message, name, tuple)
    for step in getattr(message, name):
        if not isinstance(step, GpuPass):
            checks.refuse(message, name, "be programs")
        step.check()


def check_shared(message: msgspec.Struct, name: str) -> None:
    """Check a field of storage buffers that programs have in common.

    Raises:
        UserError: it is no tuple of bindings and sizes.
    """
    checks.instance(message, name, tuple)
    for pair in getattr(message, name):
        if not (isinstance(pair, tuple) and len(pair) == 2 and all(map(checks.is_whole, pair))):
            checks.refuse(message, name, "be pairs of a binding and a number of float32")
        if not (pair[0] >= 0 and 0 < pair[1] <= _MOST_SHARED):
            checks.refuse(message, name, f"have at most {_MOST_SHARED} numbers each")


def _digests(buffers: tuple[tuple[int, Array], ...]) -> list[tuple[int, str]]:
    return [(binding, array.digest) for binding, array in buffers]


def in_format(compute_shader: str, format: TexelFormat) -> str:
    """A shader that rounds to half precision (`rounded_to_half`), for an image of another format.

    In half precision the text stays as it is, which recipes in journals are made of.
    """
    if format == "rgba16f":
        return compute_shader
    unrounded = "#define rounded_to_half(x) (x)\nvoid main()"
    return compute_shader.replace("rgba16f", format).replace("void main()", unrounded)


def recipe_of(*made_of: Any) -> str:
    """Digest of a job's shader, uniforms, output, size, format, groups, buffers, further programs
    and the recipe of the texture that it reads.

    Buffers are pairs of a binding and an array's digest. What is empty at the end does not count,
    so that jobs keep the recipes that they had in earlier versions.
    """
    while not made_of[-1]:
        made_of = made_of[:-1]
    text = msgspec.json.encode(made_of, order="sorted")
    return hashlib.blake2b(text, digest_size=16).hexdigest()
