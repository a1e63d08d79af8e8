// What of the sun arrives: by the shadow maps, and through glass.

layout(binding = 9) uniform sampler2DShadow shadow_map;
uniform mat4 shadow_matrix;          // from positions relative to the eye
uniform float shadow_texel_m;
#ifdef NEAR_SHADOW
layout(binding = 15) uniform sampler2DShadow near_shadow_map;  // finer, around the eye
uniform mat4 near_shadow_matrix;
uniform float near_shadow_texel_m;
const float NEAR_RIM = 0.25;         // of its half width, where it goes over into the other
#endif

// Share of the sun at a place in a shadow map: the mean of 3 x 3 linearly filtered comparisons. They
// meet 4 x 4 texels, which four gathers fetch once each. The surface's depth changes by `steep`
// across the map, in widths of it: a gather is compared with the surface below its middle (Isidoro
// 2006, "Shadow mapping: GPU-based tips and techniques"), less what half a texel each way can span.
// So shadows begin a texel off a surface, where they are.
float lit_share(sampler2DShadow map, vec3 at, vec2 steep) {
    at = at * 0.5 + 0.5;
    if (any(lessThan(at.xy, vec2(0.0))) || any(greaterThan(at.xy, vec2(1.0)))) return 1.0;
    vec2 size = vec2(textureSize(map, 0)), texel = 1.0 / size;
    vec2 from_first = at.xy * size - 0.5, f = fract(from_first);
    vec2 corner = (from_first - f) * texel, opposite = corner + 2.0 * texel;
    float depth = at.z - 0.5 * texel.x * (abs(steep.x) + abs(steep.y) + 1.0);
    vec2 first = steep * (corner - at.xy), last = steep * (opposite - at.xy);
    vec4 depths = clamp(depth + vec4(first.x + first.y, last.x + first.y,
                                     first.x + last.y, last.x + last.y), 0.0, 1.0);
    vec4 a = textureGather(map, corner, depths.x);
    vec4 b = textureGather(map, vec2(opposite.x, corner.y), depths.y);
    vec4 c = textureGather(map, vec2(corner.x, opposite.y), depths.z);
    vec4 d = textureGather(map, opposite, depths.w);
    // Components are left and right of the upper row, right and left of the lower: w z / x y.
    vec2 left = vec2(1.0 - f.x, 1.0), right = vec2(1.0, f.x);
    vec2 rows_1_2 = vec2(dot(a.wz, left) + dot(b.wz, right), dot(a.xy, left) + dot(b.xy, right));
    vec2 rows_3_4 = vec2(dot(c.wz, left) + dot(d.wz, right), dot(c.xy, left) + dot(d.xy, right));
    return (dot(rows_1_2, vec2(1.0 - f.y, 1.0)) + dot(rows_3_4, vec2(1.0, f.y))) / 9.0;
}

// Share of the sun that reaches this point.
float sun_visibility(vec3 face) {
    vec3 slope = mat3(shadow_matrix) * face;  // both maps have the sun's axes
    vec2 steep = -slope.xy / min(slope.z, -1e-3 * length(slope));
    vec3 p = point_in_triangle(face);
    vec3 at = (shadow_matrix * vec4(p, 1.0)).xyz;
#ifdef NEAR_SHADOW
    vec3 near_at = (near_shadow_matrix * vec4(p, 1.0)).xyz;
    vec3 from_middle = abs(near_at);
    float to_rim = 1.0 - max(from_middle.x, max(from_middle.y, from_middle.z));
    float share = clamp(to_rim / NEAR_RIM, 0.0, 1.0);
    if (share <= 0.0) return lit_share(shadow_map, at, steep);
    float near_lit = lit_share(near_shadow_map, near_at, steep);
    return share >= 1.0 ? near_lit : mix(lit_share(shadow_map, at, steep), near_lit, share);
#else
    return lit_share(shadow_map, at, steep);
#endif
}

#ifdef GLASS_SHADOW
layout(binding = 23) uniform sampler2D glass_shadow;  // of the nearest of the maps
const float GLASS_DEPTH = 2e-3;                      // half floats tell no less apart

// What glass before this point leaves of the sun; off its own surface as in `sun_visibility`.
vec3 sun_through_glass(vec3 face) {
    vec3 slope = normalize(mat3(shadow_matrix) * face);
    vec3 off = face * (0.5 + 2.0 * (abs(slope.x) + abs(slope.y)));
#ifdef NEAR_SHADOW
    vec3 p = point_in_triangle(face) + off * near_shadow_texel_m;
    vec3 at = (near_shadow_matrix * vec4(p, 1.0)).xyz * 0.5 + 0.5;
#else
    vec3 p = point_in_triangle(face) + off * shadow_texel_m;
    vec3 at = (shadow_matrix * vec4(p, 1.0)).xyz * 0.5 + 0.5;
#endif
    if (any(lessThan(at.xy, vec2(0.0))) || any(greaterThan(at.xy, vec2(1.0)))) return vec3(1.0);
    vec2 texel = 1.0 / vec2(textureSize(glass_shadow, 0));
    vec3 left = vec3(0.0);
    for (int i = -1; i <= 1; ++i) {
        for (int j = -1; j <= 1; ++j) {
            vec4 glass = textureLod(glass_shadow, at.xy + vec2(i, j) * texel, 0.0);
            left += at.z > glass.a + GLASS_DEPTH ? glass.rgb : vec3(1.0);
        }
    }
    return left / 9.0;
}
#endif
