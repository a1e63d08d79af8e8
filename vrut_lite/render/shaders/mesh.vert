#version 430 core
// Positions relative to the eye, normals and texture coordinates of a mesh; pyrender binds the
// attributes and replaces the *_LOC names by their locations. M is relative to the eye too: the
// CPU subtracts in double precision, so that a scene may lie anywhere.

layout(location = 0) in vec3 position;
#ifdef NORMAL_LOC
layout(location = NORMAL_LOC) in vec3 normal;
#endif
#ifdef TEXCOORD_0_LOC
layout(location = TEXCOORD_0_LOC) in vec2 texcoord_0;
#endif
#ifdef TEXCOORD_1_LOC
layout(location = TEXCOORD_1_LOC) in vec2 texcoord_1;
#endif
#ifdef COLOR_0_LOC
layout(location = COLOR_0_LOC) in vec4 color_0;
#endif
#ifdef LIGHT_MAP
layout(location = TANGENT_LOC) in vec4 map_place;  // texels from the corner of its rectangle
#endif
layout(location = INST_M_LOC) in mat4 inst_m;

uniform mat4 M;
uniform mat4 V;
uniform mat4 P;
#ifdef SECTION
uniform vec4 section;  // points with dot(section.xyz, point) <= section.w are seen
#endif

out vec3 eye_to_point;
centroid out vec3 eye_to_sample;
#ifdef NORMAL_LOC
centroid out vec3 world_normal;
#endif
#ifdef TEXCOORD_0_LOC
out vec2 first_uv;
#endif
#ifdef TEXCOORD_1_LOC
out vec2 second_uv;
#endif
#ifdef COLOR_0_LOC
centroid out vec4 vertex_color;
#endif
#ifdef LIGHT_MAP
centroid out vec2 place_px;
#endif

void main() {
    mat4 turned = M * inst_m;
    vec4 point = turned * vec4(position, 1.0);
    eye_to_point = point.xyz;
    eye_to_sample = point.xyz;
    gl_Position = P * V * point;
#ifdef SECTION
    gl_ClipDistance[0] = section.w - dot(section.xyz, point.xyz);
#endif
#ifdef NORMAL_LOC
    // Normals go with the cofactors, the inverse transpose times the determinant: also under
    // uneven scale, and where one axis is flattened to nothing.
    mat3 m = mat3(turned);
    float side = determinant(m) < 0.0 ? -1.0 : 1.0;
    world_normal = side * (mat3(cross(m[1], m[2]), cross(m[2], m[0]), cross(m[0], m[1])) * normal);
#endif
#ifdef TEXCOORD_0_LOC
    first_uv = texcoord_0;
#endif
#ifdef TEXCOORD_1_LOC
    second_uv = texcoord_1;
#endif
#ifdef COLOR_0_LOC
    vertex_color = color_0;
#endif
#ifdef LIGHT_MAP
    place_px = map_place.xy;
#endif
}
