// What of the sun arrives: by the shadow maps, and through glass.

layout(binding = 9) uniform sampler2DShadow shadow_map;
layout(binding = 29) uniform sampler2D shadow_ranges;  // passes/shadow_ranges.py
uniform mat4 shadow_matrix;          // from positions relative to the eye
uniform float shadow_texel_m;
uniform float shadow_spread;         // texels of a penumbra's radius, by its caster's distance in depth
uniform float shadow_aspect;         // the map's width over its depth
#ifdef NEAR_SHADOW
layout(binding = 15) uniform sampler2DShadow near_shadow_map;  // finer, around the eye
layout(binding = 30) uniform sampler2D near_shadow_ranges;
uniform mat4 near_shadow_matrix;
uniform float near_shadow_texel_m;
uniform float near_shadow_spread;
uniform float near_shadow_aspect;
const float NEAR_RIM = 0.25;         // of its half width, where it goes over into the other
#endif

const float FIRST_CELL = 8.0;        // texels along cells of ranges
const float LAST_CELL = 256.0;
const float HARD_RADIUS = 1.83;      // texels: a disc's, of the same variance as the least filter
const float TAP_VARIANCE = 0.67;     // texels^2: what linear filtering adds to a disc's radius^2
const int SOFT_TAPS = 32;
const mat2 GOLDEN_TURN = mat2(-0.7373688, 0.6754903, -0.6754903, -0.7373688);
const float OWN_SLOPE = 1.0;         // off its plane, what rises less is the surface's own

// Radius in texels of the disc through which a place is lit, 0 where all of it is shaded. Ranges
// bound how far a caster in the sun's cone can be, and so the cone: three times, closer and closer.
float sun_radius(sampler2D ranges, vec3 at, float spread, vec2 steep, float texel) {
    float cells = float(textureSize(ranges, 0).y), radius = spread * at.z;
    vec2 found;
    for (int i = 0; i < 3; ++i) {
        // The next power of two.
        float wide = clamp(2.0 * radius, FIRST_CELL, LAST_CELL);
        wide = intBitsToFloat((floatBitsToInt(wide) + 0x7fffff) & 0x7f800000);
        float across = cells * FIRST_CELL / wide;
        vec2 corner = min(at.xy * across + 0.5, across - 0.5);
        found = texelFetch(ranges, ivec2(corner.x + 2.0 * (cells - across), corner.y), 0).rg;
        radius = spread * max(at.z - found.x, 0.0);
    }
    radius = min(radius, 0.5 * LAST_CELL);
    float reach = (abs(steep.x) + abs(steep.y)) * (max(radius, 2.0) + 1.0) * texel;
    return found.y < at.z - reach - texel ? 0.0 : max(radius, HARD_RADIUS);
}

// Of a gather's comparisons, by the weights of its columns and rows. Components are left and right of
// the upper row, right and left of the lower: w z / x y.
float weighed(vec4 hit, vec2 first, vec2 second) {
    vec2 rows = hit.wx * first.x + hit.zy * second.x;
    return dot(rows, vec2(first.y, second.y));
}

// One linearly filtered comparison, in texels, with a surface of this depth there.
float lit_linearly(sampler2DShadow map, vec2 place, float depth, vec2 steep, vec2 texel) {
    vec2 within = fract(place);
    float below = depth + dot(steep, (0.5 - within) * texel);
    vec4 hit = textureGather(map, (place - within + 1.0) * texel, clamp(below, 0.0, 1.0));
    return weighed(hit, 1.0 - within, within);
}

// Share of the sun at a place in a shadow map. A penumbra is the mean over the disc that the sun's
// cone cuts at the farthest caster (Fernando 2005, "Percentage-closer soft shadows"), of linearly
// filtered comparisons along a spiral (Vogel 1979). Where it is narrower than texels can tell,
// the mean of 3 x 3: they meet 4 x 4 texels, which four gathers fetch once each. One loop serves both,
// as a software renderer runs both sides of an `if`.
// The surface's depth changes by `steep` across the map, in widths of it: a gather is compared with
// the surface below its middle (Isidoro 2006, "Shadow mapping: GPU-based tips and techniques"),
// less what half a texel each way can span. So shadows begin a texel off a surface, where they are.
float lit_share(sampler2DShadow map, sampler2D ranges, vec3 at, vec2 steep, float spread,
                float aspect) {
    at.xy = at.xy * 0.5 + 0.5;
    if (any(lessThan(at.xy, vec2(0.0))) || any(greaterThan(at.xy, vec2(1.0)))) return 1.0;
    at.z = min(at.z * 0.5 + 0.5, 1.0);
    vec2 size = vec2(textureSize(map, 0)), texel = 1.0 / size;
    float radius = sun_radius(ranges, at, spread, steep, texel.x * aspect);
    bool soft = radius > HARD_RADIUS;
    int taps = radius <= 0.0 ? 1 : soft ? SOFT_TAPS : 4;
    float disc = sqrt(max(radius * radius - TAP_VARIANCE, 0.0));
    vec2 place = at.xy * size - 0.5, f = fract(place);
    float depth = at.z - 0.5 * texel.x * (abs(steep.x) + abs(steep.y) + aspect);
    // Where the middle is lit, what is farther than it shades nothing: beyond an inner corner that
    // is the other surface, which the plane lies behind.
    float shaded = 1.0 - lit_linearly(map, place, depth, steep, texel);
    float lit = 0.0;
    vec2 turned = vec2(1.0, 0.0);
    for (int i = 0; i < taps; ++i) {
        float far = disc * sqrt((float(i) + 0.5) / float(SOFT_TAPS));
        vec2 spiral = place + far * turned;
        turned = GOLDEN_TURN * turned;
        vec2 within = fract(spiral);
        vec2 square = vec2(i & 1, i >> 1);
        vec2 middle = soft ? spiral - within + 1.0 : place - f + 2.0 * square;
        vec2 first = soft ? 1.0 - within : mix(1.0 - f, vec2(1.0), square);
        vec2 second = soft ? within : mix(vec2(1.0), f, square);
        float lower = dot(steep, (middle - place - 0.5) * texel);
        float below = depth + min(lower, lower * shaded);
        below -= soft ? OWN_SLOPE * far * texel.x * aspect : 0.0;
        lit += weighed(textureGather(map, middle * texel, clamp(below, 0.0, 1.0)), first, second);
    }
    return radius <= 0.0 ? 0.0 : lit / (soft ? float(SOFT_TAPS) : 9.0);
}

// Share of the sun that reaches this point.
float sun_visibility(vec3 face) {
    vec3 slope = mat3(shadow_matrix) * face;  // both maps have the sun's axes
    slope.z /= shadow_aspect;
    vec2 steep = -slope.xy / min(slope.z, -1e-3 * length(slope));
    vec3 p = point_in_triangle(face);
    vec3 at = (shadow_matrix * vec4(p, 1.0)).xyz;
#ifdef NEAR_SHADOW
    vec3 near_at = (near_shadow_matrix * vec4(p, 1.0)).xyz;
    float to_rim = 1.0 - max(abs(near_at.x), abs(near_at.y));
    float share = clamp(to_rim / NEAR_RIM, 0.0, 1.0);
    float near_lit = lit_share(near_shadow_map, near_shadow_ranges, near_at,
                               steep * near_shadow_aspect, near_shadow_spread, near_shadow_aspect);
    float far_lit = lit_share(shadow_map, shadow_ranges, at, steep * shadow_aspect, shadow_spread,
                              shadow_aspect);
    return mix(far_lit, near_lit, share);
#else
    return lit_share(shadow_map, shadow_ranges, at, steep * shadow_aspect, shadow_spread,
                     shadow_aspect);
#endif
}

#ifdef GLASS_SHADOW
layout(binding = 23) uniform sampler2D glass_shadow;  // of the nearest of the maps
const float GLASS_DEPTH = 2e-3;                      // half floats tell no less apart

// What glass before this point leaves of the sun; off its own surface as in `sun_visibility`.
vec3 sun_through_glass(vec3 face) {
    vec3 slope = mat3(shadow_matrix) * face;
    slope.z /= shadow_aspect;
    slope = normalize(slope);
    vec3 off = face * (0.5 + 2.0 * (abs(slope.x) + abs(slope.y)));
    float aspect = shadow_aspect;
#ifdef NEAR_SHADOW
    aspect = near_shadow_aspect;
    vec3 p = point_in_triangle(face) + off * near_shadow_texel_m;
    vec3 at = (near_shadow_matrix * vec4(p, 1.0)).xyz * 0.5 + 0.5;
#else
    vec3 p = point_in_triangle(face) + off * shadow_texel_m;
    vec3 at = (shadow_matrix * vec4(p, 1.0)).xyz * 0.5 + 0.5;
#endif
    if (any(lessThan(at.xy, vec2(0.0))) || any(greaterThan(at.xy, vec2(1.0)))) return vec3(1.0);
    float depth = clamp((at.z - 0.5) / aspect + 0.5, 0.0, 1.0);
    vec2 texel = 1.0 / vec2(textureSize(glass_shadow, 0));
    vec3 left = vec3(0.0);
    for (int i = -1; i <= 1; ++i) {
        for (int j = -1; j <= 1; ++j) {
            vec4 glass = textureLod(glass_shadow, at.xy + vec2(i, j) * texel, 0.0);
            left += depth > glass.a + GLASS_DEPTH ? glass.rgb : vec3(1.0);
        }
    }
    return left / 9.0;
}
#endif
