#version 430 core
// Clouds blended over the frame: radiance + transmittance * the frame's radiance.

uniform sampler2D cloud;

in vec2 at;
out vec4 frag_radiance;

void main() {
    frag_radiance = textureLod(cloud, at, 0.0);
}
