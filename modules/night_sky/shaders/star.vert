#version 430 core
// A point of light at infinity: its light is spread over the pixels around it, none lost.

uniform mat4 clip_from_eye;
uniform vec2 size_px;
uniform float pixels_per_sr;         // in the middle of the picture

in vec3 direction;
in vec3 irradiance;

flat out vec3 radiance;              // of all its light in one pixel
flat out vec2 at_px;

const float EDGE_PX = 7.0;

void main() {
    vec4 clip = clip_from_eye * vec4(direction, 0.0);
    // Off the axis a pixel sees less of the sky.
    float cosine = max(clip.w, 1e-3);
    radiance = irradiance * pixels_per_sr / (cosine * cosine * cosine);
    at_px = (clip.xy / cosine * 0.5 + 0.5) * size_px;
    gl_PointSize = EDGE_PX;
    gl_Position = vec4(clip.xy, 0.0, clip.w);
}
