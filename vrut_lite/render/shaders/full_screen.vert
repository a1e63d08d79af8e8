#version 430 core
// One triangle over the whole picture, behind everything (depth is reversed); the ray through
// each pixel in world axes.

uniform mat4 ray_from_clip;

out vec3 ray;
out vec2 at;

void main() {
    at = vec2(float((gl_VertexID << 1) & 2), float(gl_VertexID & 2));
    vec2 place = at * 2.0 - 1.0;
    gl_Position = vec4(place, 0.0, 1.0);
    vec4 near = ray_from_clip * vec4(place, 1.0, 1.0);
    ray = near.xyz / near.w;
}
