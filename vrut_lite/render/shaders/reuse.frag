#version 430 core
// What of the picture before still holds, where it has moved to. A pixel that is drawn anew keeps
// the depth of what is seen there, and surfaces pass; all others get a depth just before it.

uniform sampler2D front;         // depth of solid surfaces
uniform sampler2D old_radiance;  // and in alpha over which angle of view it holds
uniform sampler2D old_depth;     // of all that was drawn
uniform mat4 old_from_clip;      // clip coordinates of the picture before
uniform vec3 brighter;           // the light now, of the light then
uniform float seen_turned;       // by which angle since then, of a surface of depth 1
uniform int turn;                // which pixels are drawn anew in any case; below 0: all
uniform int most_apart;          // pictures between two turns of a pixel, less one: 7 or 15

const int BLOCK = 4;             // pixels along a side that a software renderer shades at once
const float BEFORE_SKY = 1e-25;  // nearer than infinity, farther than anything
const float LEAST_WEIGHT = 0.4;  // of the four pixels about a place, what is on its surface

in vec2 at;
out vec4 frag_radiance;

// By a lattice in which neighbours are far apart in time.
bool has_its_turn(ivec2 pixel, float holds_for) {
    ivec2 block = pixel / BLOCK;
    int apart = holds_for >= 16.0 ? 15 : holds_for >= 8.0 ? 7 : holds_for >= 4.0 ? 3
        : holds_for >= 2.0 ? 1 : 0;
    return turn < 0 || ((block.x + 3 * block.y - turn) & apart & most_apart) == 0;
}

float smaller(float one, float other) {
    return abs(one) < abs(other) ? one : other;
}

void main() {
    vec2 size = vec2(textureSize(old_radiance, 0)), pixel = 1.0 / vec2(textureSize(front, 0));
    // Left, here and below; above and right.
    vec4 lower = textureGather(front, at - 0.5 * pixel), upper = textureGather(front, at + 0.5 * pixel);
    float depth = lower.y;
    vec4 old = old_from_clip * vec4(2.0 * at - 1.0, depth, 1.0);
    old.xyz /= old.w;
    vec2 place = (0.5 + 0.5 * old.xy) * size - 0.5, first = floor(place), share = place - first;
    bool inside = old.w > 0.0 && all(greaterThan(place, vec2(0.0)))
        && all(lessThan(place, size - 1.0));
    // Depth is linear across a plane; of two neighbours one is on the same.
    vec2 slope = vec2(smaller(depth - lower.x, upper.z - depth),
                      smaller(depth - lower.z, upper.x - depth));
    vec4 expected = old.z - dot(slope, share) + vec4(0.0, slope.x, slope.y, slope.x + slope.y);
    vec4 off = abs(textureGather(old_depth, (first + 1.0) / size).wzxy - expected);
    float near_enough = 2e-4 * old.z + min(0.1 * (abs(slope.x) + abs(slope.y)), 0.01 * old.z);
    near_enough += BEFORE_SKY;
    // Steeper than linear: blurs less where a picture is moved again and again.
    share *= share * (3.0 - 2.0 * share);
    vec2 rest = 1.0 - share;
    vec4 weight = vec4(rest.x, share.x, rest.x, share.x) * vec4(rest.yy, share.yy);
    weight *= vec4(lessThanEqual(off, vec4(near_enough)));
    float total = dot(weight, vec4(1.0));
    // Where not all four are there, the heaviest and one beside it, or it alone: one look-up.
    bvec2 end = bvec2(max(weight.y, weight.w) > max(weight.x, weight.z),
                      max(weight.z, weight.w) > max(weight.x, weight.y));
    float beside = end.x ? (end.y ? weight.z : weight.x) : (end.y ? weight.w : weight.y);
    float across = end.y ? (end.x ? weight.y : weight.x) : (end.x ? weight.w : weight.z);
    if (min(min(weight.x, weight.y), min(weight.z, weight.w)) <= 0.0) {
        if (beside > 0.0 || across <= 0.0) share.y = float(end.y);
        if (beside <= 0.0) share.x = float(end.x);
    }
    vec4 moved = textureLod(old_radiance, (first + 0.5 + share) / size, 0.0);
    float holds_for = moved.a / max(seen_turned * depth, 1e-20);
    if (inside && total >= LEAST_WEIGHT && !has_its_turn(ivec2(gl_FragCoord.xy), holds_for)) {
        frag_radiance = vec4(brighter * moved.rgb, moved.a);
        gl_FragDepth = depth > 0.0 ? uintBitsToFloat(floatBitsToUint(depth) + 1u) : BEFORE_SKY;
    } else {
        frag_radiance = vec4(0.0, 0.0, 0.0, 1.0);
        gl_FragDepth = depth;
    }
}
