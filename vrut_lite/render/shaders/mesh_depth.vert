#version 430 core
// Depth from the sun, and the inputs of a cut-out texture's shadow.

layout(location = 0) in vec3 position;
#ifdef TEXCOORD_0_LOC
layout(location = TEXCOORD_0_LOC) in vec2 texcoord_0;
#endif
#ifdef TEXCOORD_1_LOC
layout(location = TEXCOORD_1_LOC) in vec2 texcoord_1;
uniform int alpha_layer;
#endif

uniform mat4 clip_from_model;

#ifdef TEXCOORD_0_LOC
out vec2 uv;
#endif

void main() {
    gl_Position = clip_from_model * vec4(position, 1.0);
#ifdef TEXCOORD_0_LOC
    uv = texcoord_0;
#endif
#ifdef TEXCOORD_1_LOC
    if (alpha_layer == 1) uv = texcoord_1;
#endif
}
