#version 430 core
// Clouds over what is drawn already: blended as radiance + transmittance * what is behind.

uniform sampler2D cloud;

in vec2 at;
out vec4 frag_radiance;

void main() {
    frag_radiance = textureLod(cloud, at, 0.0);
}
