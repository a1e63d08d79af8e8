"""Cube maps of a card that are sums of lights: one `GpuJob` of programs that add theirs.

A sky's last program computes the radiance of each texel once, and writes it to image unit 0 by
`imageStore`. Sums are in single precision: in half precision each program would round.
"""

import math
import re
from collections.abc import Sequence

import msgspec
import numpy as np

from vrut_lite.array import Array
from vrut_lite.messages.gpu_job import GpuJob, GpuPass
from vrut_lite.numeric_types import FloatArray, Vector
from vrut_lite.sky.shader_text import floats, shader_source

_GLOW_BINDING = 1
_GROUP = 8
_LOWEST_EXPONENT = -100
_IMAGE = r"layout\(rgba32f, binding = 0\) (?:restrict )?writeonly uniform {kind} (\w+);"
_STORE = """layout(rgba32f, binding = 0) uniform imageCube {image};
uniform vec3 part_share;
void store_part(ivec3 at, vec4 value) {{
    vec3 before = BEFORE;
    imageStore({image}, at, vec4(before + part_share * value.rgb, 1.0));
}}
"""


def sum_of_parts(parts: Sequence[tuple[GpuJob, FloatArray]]) -> GpuJob | None:
    """The job that sums cubes of one size, each times its share (3,).

    The last program of each job writes the cube, in texels of single precision. None where it does
    not write its image as this module says.
    """
    steps: list[GpuPass] = []
    shared: dict[int, int] = {}
    for number, (job, share) in enumerate(parts):
        *before, last = job.programs
        text = _adding(last.compute_shader, adds=number > 0)
        if text is None:
            return None
        uniforms = {**last.uniforms, "part_share": floats(share)}
        steps += *before, msgspec.structs.replace(last, compute_shader=text, uniforms=uniforms)
        # One part's programs end before the next one's begin.
        for binding, count in job.shared:
            shared[binding] = max(count, shared.get(binding, 0))
    first, *then = steps
    return msgspec.structs.replace(
        parts[0][0],
        compute_shader=first.compute_shader,
        uniforms=first.uniforms,
        groups=first.groups,
        buffers=first.buffers,
        then=tuple(then),
        shared=tuple(shared.items()),
    )


def _adding(compute_shader: str, adds: bool) -> str | None:
    """A program that stores its values times a share, or adds them to what is there."""
    before = "imageLoad({image}, at).rgb" if adds else "vec3(0.0)"
    return with_store(compute_shader, "imageCube", _STORE.replace("BEFORE", before))


def with_store(compute_shader: str, kind: str, store: str) -> str | None:
    """A program whose stores into its image of a kind are calls of `store_part`.

    `store` declares the image, which it names `{image}`, and that function; None where the program
    declares none in texels of single precision at unit 0.
    """
    found = re.search(_IMAGE.format(kind=kind), compute_shader)
    if found is None:
        return None
    image = found[1]
    stored = compute_shader.replace(f"imageStore({image},", "store_part(")
    return stored.replace(found[0], store.format(image=image))


def glow_pass(
    glow: Array, size: int, ground_rgb: Vector, share: float, scale: float, horizon_rad: float = 0.0
) -> GpuPass:
    """Adds a share of a glow over lit ground, as `glow_cube` has it, to texels of this scale."""
    groups = -(-size // _GROUP)
    values = np.ascontiguousarray(glow.values, np.float32)
    return GpuPass(
        compute_shader=shader_source("glow.comp"),
        uniforms={
            "glow_shape": values.shape[:2],
            "glow_ground": floats(ground_rgb),
            "sine_horizon": floats(math.sin(horizon_rad))[0],
            "glow_share": floats(share / scale)[0],
        },
        groups=(groups, groups, 6),
        buffers=((_GLOW_BINDING, glow if values is glow.values else Array(values)),),
    )


def scale_of_sum(scales: Sequence[float]) -> float:
    """The power of two that serves a sum of lights with these scales."""
    total = math.fsum(scales)
    exponent = math.ceil(math.log2(total)) if total > 0.0 else 0
    return 2.0 ** max(exponent, _LOWEST_EXPONENT)
