"""The air of a card in the light of one body or two, and of a glow: one `GpuJob`, one texture.

A sky's last program computes the light of each node once, and writes it to image unit 0 by
`imageStore`. The slices of the second body's three kinds of light lie after those of the first's.
"""

from collections.abc import Sequence
from typing import NamedTuple

import msgspec

from vrut_lite.messages.gpu_job import GpuJob, GpuPass
from vrut_lite.numeric_types import FloatArray
from vrut_lite.sky.cube_sum import with_store
from vrut_lite.sky.shader_text import floats

_STORE = """layout(rgba32f, binding = 0) writeonly uniform image3D {image};
uniform int part_from, part_glows_below;
uniform vec3 part_share, part_glow;
void store_part(ivec3 at, vec4 value) {{
    vec3 glow = at.z < part_glows_below ? part_glow : vec3(0.0);
    imageStore({image}, at + ivec3(0, 0, part_from), vec4(part_share * value.rgb + glow, 1.0));
}}
"""


class LitAir(NamedTuple):
    """A body's job for the air, the share (3,) of its light, and radiance (3,) of a glow in it."""

    job: GpuJob
    share: FloatArray
    glow_rgb: FloatArray


def air_of_bodies(parts: Sequence[LitAir]) -> GpuJob | None:
    """The job that writes the light of all parts, whose textures are of one size.

    None where a job does not write its image as this module says.
    """
    steps: list[GpuPass] = []
    size = parts[0].job.size
    assert isinstance(size, tuple)
    columns, rows, slices = size
    for number, (job, share, glow_rgb) in enumerate(parts):
        assert job.size == size
        *before, last = job.programs
        text = with_store(last.compute_shader, "image3D", _STORE)
        if text is None:
            return None
        uniforms = {
            **last.uniforms,
            "part_from": number * slices,
            # Light scattered twice or more is the first of three kinds.
            "part_glows_below": slices // 3,
            "part_share": floats(share),
            "part_glow": floats(glow_rgb),
        }
        steps += *before, msgspec.structs.replace(last, compute_shader=text, uniforms=uniforms)
    first, *then = steps
    return msgspec.structs.replace(
        parts[0].job,
        compute_shader=first.compute_shader,
        uniforms=first.uniforms,
        groups=first.groups,
        buffers=first.buffers,
        then=tuple(then),
        size=(columns, rows, len(parts) * slices),
    )
