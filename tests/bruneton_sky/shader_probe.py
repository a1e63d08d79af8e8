"""Runs the GLSL of single scattering along given rays."""

import numpy as np
from bruneton_sky import Atmosphere
from bruneton_sky.published.gpu_single_scattering import atmosphere_uniforms, quadrature_uniforms
from numpy.typing import NDArray

from vrut_lite.sky.shader_text import expand_includes

_GROUP = 64
PREAMBLE = """#version 430
#include "single_scattering.glsl"
layout(local_size_x = 64) in;
layout(std430, binding = 0) readonly buffer Rays { vec4 rays[]; };
layout(std430, binding = 1) writeonly buffer Values { vec4 values[]; };
void main() {
    uint i = gl_GlobalInvocationID.x;
    if (i >= uint(rays.length())) {
        return;
    }
    vec4 ray = rays[i];
"""
RADIANCE = "    values[i] = vec4(single_scattering(ray.x, ray.y, ray.z, ray.w), 0.0);\n}\n"
DEPTH = """
    Ray line = make_ray(ray.x, ray.y);
    values[i] = vec4(optical_depth_to(line, end_of(line)), float(hits_ground(line)));
}
"""


class ShaderProbe:
    """Shaders of one GL thread, compiled once each."""

    def __init__(self, owner):
        self._owner = owner
        self._programs = {}

    def __call__(self, body: str, uniforms: dict, rays: NDArray[np.float32]) -> NDArray[np.float64]:
        """The body's values (n, 4) of rays (n, 4): altitude, mu, mu_s, nu."""
        return self._owner.call(lambda context: self._run(context, body, uniforms, rays))

    def radiance(self, air: Atmosphere, rays, rule="gauss-legendre", samples=12):
        """Radiance (n, 3) by the GLSL of a rule."""
        uniforms = {**atmosphere_uniforms(air), **quadrature_uniforms(rule, samples)}
        return self(RADIANCE, uniforms, rays)[:, :3]

    def optical_depth(self, air: Atmosphere, rays):
        """Optical depth (n, 3) from end to end, and whether the ray (n,) meets the ground."""
        values = self(DEPTH, atmosphere_uniforms(air), rays)
        return values[:, :3], values[:, 3] > 0

    def _run(self, context, body, uniforms, rays):
        if body not in self._programs:
            self._programs[body] = context.compute_shader(
                expand_includes(PREAMBLE + body, "bruneton_sky.published")
            )
        program = self._programs[body]
        for name, value in uniforms.items():
            if name in program:
                program[name].value = value
        given = context.buffer(np.ascontiguousarray(rays, dtype=np.float32).tobytes())
        made = context.buffer(reserve=given.size)
        given.bind_to_storage_buffer(0)
        made.bind_to_storage_buffer(1)
        program.run(-(-len(rays) // _GROUP))
        context.memory_barrier()
        values = np.frombuffer(made.read(), np.float32).reshape(-1, 4).astype(float)
        given.release()
        made.release()
        return values
