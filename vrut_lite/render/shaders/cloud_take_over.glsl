// While something moves, three quarters of the clouds are taken over from the picture before, where
// they have moved to: each block of pixels is marched once in four pictures.

layout(binding = 8) uniform sampler2D old_before_sky;
layout(binding = 10) uniform sampler2D old_before_mesh;
layout(binding = 11) uniform sampler2D old_distance_m;
uniform mat4 old_clip_from_axes;
uniform vec3 moved_m;  // from the eye then to the eye now, less the wind's drift
uniform int turn;

const int TURNS = 4, BLOCK = 4;  // a software renderer shades blocks at once
const float FAR_M = 1e7;
// Clouds before a mesh are taken over where they are clearly nearer or clearly farther.
const float BESIDE = 0.1;

vec2 old_place(vec3 d, float metres) {
    vec4 clip = old_clip_from_axes * vec4(d * metres + moved_m, 1.0);
    return clip.w > 0.0 ? 0.5 + 0.5 * clip.xy / clip.w : vec2(-1.0);
}

bool taken_over(vec3 d, float mesh_m) {
    ivec2 block = ivec2(gl_FragCoord.xy) / BLOCK;
    if (((block.x + 2 * (block.y & 1) + (block.y >> 1)) & (TURNS - 1)) == turn) return false;
    vec2 place = old_place(d, FAR_M);
    float metres = textureLod(old_distance_m, place, 0.0).r;
    if (metres > 0.0) place = old_place(d, metres);
    vec2 margin = 0.5 / vec2(textureSize(old_before_sky, 0));
    if (any(lessThan(place, margin)) || any(greaterThan(place, 1.0 - margin))) return false;
    metres = textureLod(old_distance_m, place, 0.0).r;
    if (metres > 0.0 && abs(mesh_m - metres) < BESIDE * metres) return false;
    before_sky = textureLod(old_before_sky, place, 0.0);
    bool hidden = metres == 0.0 || mesh_m < metres;
    before_mesh = hidden ? vec4(0.0, 0.0, 0.0, 1.0) : textureLod(old_before_mesh, place, 0.0);
    cloud_distance_m = metres;
    return true;
}
