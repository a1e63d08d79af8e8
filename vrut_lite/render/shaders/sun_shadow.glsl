// Visibility of the sun by the shadow maps, and transmittance of glass.

#ifdef NO_SHADOW
// Of a mesh outside the map.
float sun_visibility(vec3 face) { return 1.0; }
#else

uniform float shadow_spread;         // penumbra radius (texels) per distance of its caster in depth
#ifdef STILL_SHADOW
layout(binding = 34) uniform sampler2D still_map;
layout(binding = 35) uniform sampler2D still_ranges;   // passes/shadow_ranges.py
const int SQUARES = 4;               // passes/still_shadow.py
const float SQUARE_TEXELS = 2048.0;
const float INSIDE = 1.0 - 2.0 * 132.0 / SQUARE_TEXELS;
uniform mat3 shadow_axes;            // of the sun; metres along them from the eye
uniform vec3 shadow_squares[SQUARES];  // centre, 1 / half width
uniform vec3 shadow_depths[SQUARES]; // middle, 1 / depth, rounding in it
#else
layout(binding = 9) uniform sampler2DShadow shadow_map;
layout(binding = 29) uniform sampler2D shadow_ranges;
uniform mat4 shadow_matrix;          // from positions relative to the eye
uniform float shadow_texel_m;
uniform float shadow_aspect;         // the map's width over its depth
#endif
#ifdef NEAR_SHADOW
layout(binding = 15) uniform sampler2DShadow near_shadow_map;  // finer, around the eye
layout(binding = 30) uniform sampler2D near_shadow_ranges;
uniform mat4 near_shadow_matrix;
uniform float near_shadow_texel_m;
uniform float near_shadow_spread;
uniform float near_shadow_aspect;
const float NEAR_RIM = 0.25;         // of its half width, blended with the scene's map
#endif

const float FIRST_CELL = 8.0;        // texels along cells of ranges
const float LAST_CELL = 256.0;
const float MOST_RADIUS = 0.5 * LAST_CELL;
const float TAP_VARIANCE = 0.67;     // texels^2 that linear filtering adds to a disc's radius^2
#ifdef STILL_SHADOW
const float HARD_RADIUS = 0.82;      // texels, of a disc with the variance of the smallest filter
const float OFF_PLANE = 0.15;        // texels: depth bias for surfaces off their plane
const int STILL_TAPS = 64;           // in all pictures of a still
const float GOLDEN_RAD = 2.3999632;
#else
const float HARD_RADIUS = 1.83;
const int SOFT_TAPS = 32;
const mat2 GOLDEN_TURN = mat2(-0.7373688, 0.6754903, -0.6754903, -0.7373688);
#endif
const float OWN_SLOPE = 1.0;         // depth bias by radius: smaller rises belong to the receiver

// Radius (texels) of the filter disc of a place, in texels and depth; 0 in full shadow. Ranges
// bound the distance of casters in the sun's cone, and so the cone, in three iterations.
float sun_radius(sampler2D ranges, vec3 at, float spread, vec2 steep, float texel) {
    float texels = float(textureSize(ranges, 0).y) * FIRST_CELL, radius = spread * at.z;
    vec2 found;
    for (int i = 0; i < 3; ++i) {
        // The next power of two.
        float wide = clamp(2.0 * radius, FIRST_CELL, LAST_CELL);
        wide = intBitsToFloat((floatBitsToInt(wide) + 0x7fffff) & 0x7f800000);
        vec2 corner = min(at.xy / wide + 0.5, texels / wide - 0.5);
        float left = 2.0 * (texels / FIRST_CELL - texels / wide);
        found = texelFetch(ranges, ivec2(corner.x + left, corner.y), 0).rg;
        radius = spread * max(at.z - found.x, 0.0);
    }
    radius = min(radius, MOST_RADIUS);
    float reach = (abs(steep.x) + abs(steep.y)) * (max(radius, 2.0) + 1.0) * texel;
    return found.y < at.z - reach - texel ? 0.0 : max(radius, HARD_RADIUS);
}

// Sum of a gather's comparisons, weighted by columns and rows; w z are the upper row, x y lower.
float weighed(vec4 hit, vec2 first, vec2 second) {
    vec2 rows = hit.wx * first.x + hit.zy * second.x;
    return dot(rows, vec2(first.y, second.y));
}

#ifndef STILL_SHADOW
// One linearly filtered comparison at a place (texels) with a plane whose depth changes by `steep`
// per texel, at its middle (Isidoro 2006, "Shadow mapping: GPU-based tips and techniques").
float lit_linearly(sampler2DShadow map, vec2 place, float depth, vec2 steep) {
    vec2 within = fract(place), size = vec2(textureSize(map, 0));
    float below = depth + dot(steep, 0.5 - within);
    vec4 hit = textureGather(map, (place - within + 1.0) / size, clamp(below, 0.0, 1.0));
    return weighed(hit, 1.0 - within, within);
}

// Share of the sun at a place in a shadow map. A penumbra is the mean over the disc that the sun's
// cone cuts at the farthest caster (Fernando 2005, "Percentage-closer soft shadows"), of linearly
// filtered comparisons along a spiral (Vogel 1979). Where it is narrower than texels resolve, the
// mean of 3 x 3: they cover 4 x 4 texels, which four gathers fetch once each. One loop serves both,
// since a software renderer executes both sides of an `if`.
// `steep` is the change of the surface's depth across the map's width: a gather is compared with
// the surface at its middle, less the depth that half a texel each way can span. Shadows then begin
// a texel off the surface.
float lit_share(sampler2DShadow map, sampler2D ranges, vec3 at, vec2 steep, float spread,
                float aspect) {
    at.xy = at.xy * 0.5 + 0.5;
    if (any(lessThan(at.xy, vec2(0.0))) || any(greaterThan(at.xy, vec2(1.0)))) return 1.0;
    at.z = min(at.z * 0.5 + 0.5, 1.0);
    vec2 size = vec2(textureSize(map, 0)), texel = 1.0 / size;
    float radius = sun_radius(ranges, vec3(at.xy * size, at.z), spread, steep, texel.x * aspect);
    bool soft = radius > HARD_RADIUS;
    int taps = radius <= 0.0 ? 1 : soft ? SOFT_TAPS : 4;
    float disc = sqrt(max(radius * radius - TAP_VARIANCE, 0.0));
    vec2 place = at.xy * size - 0.5, f = fract(place);
    float depth = at.z - 0.5 * texel.x * (abs(steep.x) + abs(steep.y) + aspect);
    // Where the middle is lit, casters farther than it are ignored: beyond an inner corner they are
    // the other surface, in front of the plane.
    float shaded = 1.0 - lit_linearly(map, place, depth, steep * texel);
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

#endif

#ifdef STILL_SHADOW
// Depth in a square, from 0 nearest to the sun to 1.
float depth_in(int square, float towards_sun_m) {
    float away = (shadow_depths[square].x - towards_sun_m) * shadow_depths[square].y;
    return min(0.5 + away, 1.0);
}

// The finest square that contains a place, in metres along the sun's axes. Beyond its depth, which
// is that of the near points it is for, casters are missing.
int square_at(vec3 at) {
    int found = 0;
    for (int i = 1; i < SQUARES; ++i) {
        vec2 off = abs(at.xy - shadow_squares[i].xy) * shadow_squares[i].z;
        if (max(off.x, off.y) < INSIDE && depth_in(i, at.z) < 1.0) found = i;
    }
    return found;
}

// Texels of the map at a place in a square.
vec2 place_in(int square, vec2 at) {
    vec2 within = clamp((at - shadow_squares[square].xy) * shadow_squares[square].z, -1.0, 1.0);
    return SQUARE_TEXELS * (vec2(square & 1, square >> 1) + 0.5 + 0.5 * within);
}

// One linearly filtered comparison at a place (texels) with a plane whose depth changes by `steep`
// per texel: each of the four texels with the plane at its own middle.
float lit_linearly(vec2 place, float depth, vec2 steep) {
    vec2 within = fract(place), size = vec2(textureSize(still_map, 0));
    float below = depth + dot(steep, 0.5 - within), up = 0.5 * (steep.y - steep.x);
    float along = 0.5 * (steep.x + steep.y);
    vec4 depths = textureGather(still_map, (place - within + 1.0) / size);
    vec4 hit = step(min(below + vec4(up, along, -up, -along), 1.0), depths);
    return weighed(hit, 1.0 - within, within);
}

// Share of the sun that reaches this point, from a part of the sun's disc; all pictures of a still
// cover it all. As `lit_share`, but texels are finer than pixels; the least filter is a gather.
float sun_visibility(vec3 face) {
    vec3 slope = shadow_axes * face;
    vec2 steep = slope.xy / max(slope.z, 1e-3 * length(slope));
    vec3 at = shadow_axes * point_in_triangle(face);
    vec2 off = abs(at.xy - shadow_squares[0].xy) * shadow_squares[0].z;
    if (max(off.x, off.y) > 1.0) return 1.0;
    // Where a penumbra exceeds MOST_RADIUS, the next square has wider texels.
    float radius, texel;
    vec3 place;
    for (int square = square_at(at); square >= 0; --square) {
        float texel_m = 2.0 / (SQUARE_TEXELS * shadow_squares[square].z);
        place = vec3(place_in(square, at.xy), depth_in(square, at.z));
        place.z -= shadow_depths[square].z * (1.0 + abs(steep.x) + abs(steep.y));
        texel = texel_m * shadow_depths[square].y;
        radius = sun_radius(still_ranges, place, shadow_spread / texel, steep, texel);
        if (radius < MOST_RADIUS) break;
    }
    float disc = sqrt(max(radius * radius - TAP_VARIANCE, 0.0));
    float depth = place.z - OFF_PLANE * texel * (abs(steep.x) + abs(steep.y) + 1.0);
    steep *= texel;
    place -= 0.5;
    float middle = lit_linearly(place.xy, depth, steep), lit = 0.0;
    int taps = STILL_TAPS / picture_count;
    float angle = GOLDEN_RAD * float(picture_number), turn = GOLDEN_RAD * float(picture_count);
    vec2 turned = vec2(cos(angle), sin(angle)), next = vec2(cos(turn), sin(turn));
    for (int i = 0; i < taps; ++i) {
        if (radius <= HARD_RADIUS) break;
        float number = float(i * picture_count + picture_number) + 0.5;
        float far = disc * sqrt(number / float(STILL_TAPS));
        float lower = dot(steep, far * turned);
        float below = depth + min(lower, lower * (1.0 - middle)) - OWN_SLOPE * far * texel;
        lit += lit_linearly(place.xy + far * turned, below, steep);
        turned = vec2(turned.x * next.x - turned.y * next.y, turned.x * next.y + turned.y * next.x);
    }
    return radius <= 0.0 ? 0.0 : radius <= HARD_RADIUS ? middle : lit / float(taps);
}
#else
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

#endif

#ifdef GLASS_SHADOW
layout(binding = 23) uniform sampler2D glass_shadow;  // of the finest map
const float GLASS_DEPTH = 2e-3;                      // resolution of half floats

// Transmittance of the glass in front of this point, offset from its own surface.
vec3 sun_through_glass(vec3 face) {
    vec3 p = point_in_triangle(face);
#ifdef STILL_SHADOW
    vec3 slope = shadow_axes * face;
    int square = square_at(shadow_axes * p);
    float texel_m = 2.0 / (shadow_squares[square].z * SQUARE_TEXELS);
    float aspect = 2.0 * shadow_depths[square].y / shadow_squares[square].z;
#else
    vec3 slope = mat3(shadow_matrix) * face;
    slope.z /= shadow_aspect;
#ifdef NEAR_SHADOW
    float aspect = near_shadow_aspect, texel_m = near_shadow_texel_m;
#else
    float aspect = shadow_aspect, texel_m = shadow_texel_m;
#endif
#endif
    slope = normalize(slope);
    p += face * (0.5 + 2.0 * (abs(slope.x) + abs(slope.y))) * texel_m;
#ifdef STILL_SHADOW
    vec3 at = shadow_axes * p;
    at = vec3(place_in(square, at.xy) / vec2(textureSize(glass_shadow, 0)), depth_in(square, at.z));
#elif defined(NEAR_SHADOW)
    vec3 at = (near_shadow_matrix * vec4(p, 1.0)).xyz * 0.5 + 0.5;
#else
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
#endif
