#version 430 core
// One triangle over the whole picture; the ray through each pixel in world axes.

uniform mat4 ray_from_clip;

out vec3 ray;
out vec2 at;

void main() {
    at = vec2(float((gl_VertexID << 1) & 2), float(gl_VertexID & 2));
    gl_Position = vec4(at * 2.0 - 1.0, 1.0, 1.0);
    vec4 near = ray_from_clip * gl_Position;
    ray = near.xyz / near.w;
}
