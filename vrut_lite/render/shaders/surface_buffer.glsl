// Attributes of the visible point of an opaque surface, 16 bytes a pixel, for deferred shading: x has
// the interpolated normal, y the triangle's and the mesh's number, z and w the place in the chart, the
// change of the mirrored ray and that of the place (normals.glsl).

const float CHART_STEPS = 16777215.0;  // of the place in the chart, 24 bits
const float FACE_STEPS = 4095.0;       // of the triangle's normal, 12 bits
// Squared changes of ray and place, from the least in octaves, 8 bits.
const vec2 LEAST_CHANGE_LOG2 = vec2(-26.0, -20.0);
const float CHANGE_OCTAVES = 30.0;

uniform vec2 chart_first_px;
uniform vec2 chart_size_px;
uniform int surface_number;            // from 1; 0 where nothing is drawn

vec2 sign_or_one(vec2 v) {
    return vec2(v.x < 0.0 ? -1.0 : 1.0, v.y < 0.0 ? -1.0 : 1.0);
}

// A unit vector on an octahedron unfolded to [-1, 1]^2 (Cigolle et al. 2014, "A survey of efficient
// representations for independent unit vectors").
vec2 unfolded(vec3 n) {
    vec2 at = n.xy / (abs(n.x) + abs(n.y) + abs(n.z));
    return n.z < 0.0 ? (1.0 - abs(at.yx)) * sign_or_one(at) : at;
}

vec3 folded(vec2 at) {
    vec3 n = vec3(at, 1.0 - abs(at.x) - abs(at.y));
    if (n.z < 0.0) n.xy = (1.0 - abs(n.yx)) * sign_or_one(n.xy);
    return normalize(n);
}

uvec4 packed_surface(vec3 smooth_n, vec3 face, vec2 place_px, vec2 changes) {
    uvec2 facing = uvec2(round((0.5 + 0.5 * unfolded(face)) * FACE_STEPS));
    vec2 share = clamp((place_px - chart_first_px) / chart_size_px, 0.0, 1.0);
    uvec2 place = uvec2(round(share * CHART_STEPS)) << 8;
    vec2 octaves = log2(max(changes, 1e-30)) - LEAST_CHANGE_LOG2;
    place |= uvec2(round(clamp(octaves / CHANGE_OCTAVES, 0.0, 1.0) * 255.0));
    return uvec4(packSnorm2x16(unfolded(smooth_n)),
                 facing.x << 20 | facing.y << 8 | uint(surface_number), place);
}

#ifdef FROM_BUFFER
layout(binding = 36) uniform usampler2D surface_attributes;
layout(binding = 37) uniform sampler2D surface_depth;
uniform mat4 eye_from_clip;
vec3 eye_to_point, world_normal, face_in_buffer;
vec2 place_px;
float ray_change_in_buffer, place_change_in_buffer;

void read_surface() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    uvec4 read = texelFetch(surface_attributes, at, 0);
    vec2 across = 2.0 * gl_FragCoord.xy / vec2(textureSize(surface_depth, 0)) - 1.0;
    vec4 point = eye_from_clip * vec4(across, texelFetch(surface_depth, at, 0).r, 1.0);
    eye_to_point = point.xyz / point.w;
    world_normal = folded(unpackSnorm2x16(read.x));
    vec2 facing = vec2(read.y >> 20, read.y >> 8 & 0xfffu);
    face_in_buffer = folded(facing * (2.0 / FACE_STEPS) - 1.0);
    place_px = chart_first_px + vec2(read.zw >> 8) * (chart_size_px / CHART_STEPS);
    vec2 octaves = vec2(read.zw & 0xffu) * (CHANGE_OCTAVES / 255.0);
    vec2 changes = exp2(LEAST_CHANGE_LOG2 + octaves);
    ray_change_in_buffer = changes.x;
    place_change_in_buffer = changes.y;
}
#endif
