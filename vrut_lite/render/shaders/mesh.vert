#version 430 core
// Positions relative to the eye, normals and texture coordinates of a mesh; pyrender binds the
// attributes and replaces the *_LOC names by their locations. Matrices are relative to the eye too:
// the CPU multiplies and subtracts in double precision, so that a scene may lie anywhere.

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
#ifdef TANGENT_LOC
layout(location = TANGENT_LOC) in vec4 map_place;  // in its chart
#endif

uniform mat4 clip_from_model;
uniform mat4 eye_from_model;   // in world axes
uniform mat3 normal_matrix;
#ifdef SECTION
uniform vec4 section;  // points with dot(section.xyz, point) <= section.w are kept
#endif

// Equal to the depth of the depth pass to the bit.
invariant gl_Position;
out vec3 eye_to_point;
#ifndef ONE_SAMPLE
centroid out vec3 eye_to_sample;
#endif
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
#ifdef TANGENT_LOC
centroid out vec2 place_px;
#endif

#ifdef FROM_BUFFER
uniform int surface_number;

// The whole picture, at the depth of a surface's number.
void main() {
    vec2 corner = vec2(4 * (gl_VertexID & 1) - 1, 4 * (gl_VertexID >> 1) - 1);
    gl_Position = vec4(corner, float(surface_number) / 256.0, 1.0);
}
#else
void main() {
    gl_Position = clip_from_model * vec4(position, 1.0);
    vec4 point = eye_from_model * vec4(position, 1.0);
    eye_to_point = point.xyz;
#ifndef ONE_SAMPLE
    eye_to_sample = point.xyz;
#endif
#ifdef SECTION
    gl_ClipDistance[0] = section.w - dot(section.xyz, point.xyz);
#endif
#ifdef NORMAL_LOC
    world_normal = normal_matrix * normal;
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
#ifdef TANGENT_LOC
    place_px = map_place.xy;
#endif
}
#endif
