#version 430 core
// World positions, normals and texture coordinates of a mesh; pyrender binds the attributes
// and replaces the *_LOC names by their locations.

layout(location = 0) in vec3 position;
#ifdef NORMAL_LOC
layout(location = NORMAL_LOC) in vec3 normal;
#endif
#ifdef TEXCOORD_0_LOC
layout(location = TEXCOORD_0_LOC) in vec2 texcoord_0;
#endif
#ifdef COLOR_0_LOC
layout(location = COLOR_0_LOC) in vec4 color_0;
#endif
layout(location = INST_M_LOC) in mat4 inst_m;

uniform mat4 M;
uniform mat4 V;
uniform mat4 P;

out vec3 world_position;
#ifdef NORMAL_LOC
out vec3 world_normal;
#endif
#ifdef TEXCOORD_0_LOC
out vec2 uv;
#endif
#ifdef COLOR_0_LOC
out vec4 vertex_color;
#endif

void main() {
    mat4 world_from_model = M * inst_m;
    vec4 world = world_from_model * vec4(position, 1.0);
    world_position = world.xyz;
    gl_Position = P * V * world;
#ifdef NORMAL_LOC
    // Normals go with the inverse transpose, which also holds under uneven scale.
    world_normal = transpose(inverse(mat3(world_from_model))) * normal;
#endif
#ifdef TEXCOORD_0_LOC
    uv = texcoord_0;
#endif
#ifdef COLOR_0_LOC
    vertex_color = color_0;
#endif
}
