#version 430 core
// What of the picture before still holds, where it has moved to. A pixel that is drawn anew keeps
// the depth of what is seen there, and surfaces pass; all others get a depth just before it.

uniform sampler2D front;         // depth of solid surfaces
uniform sampler2D old_radiance;
uniform sampler2D old_depth;     // of all that was drawn
uniform mat4 old_from_clip;      // clip coordinates of the picture before
uniform vec3 brighter;           // the light now, of the light then
uniform float turn;              // which pixels are drawn anew in any case; below 0: all

const int BLOCK = 4;             // pixels along a side that a software renderer shades at once
const float BEFORE_SKY = 1e-25;  // nearer than infinity, farther than anything

in vec2 at;
out vec4 frag_radiance;

// Eight turns, by a lattice in which neighbours are far apart in time.
bool has_its_turn(ivec2 pixel) {
    ivec2 block = pixel / BLOCK;
    return turn < 0.0 || ((block.x + 3 * block.y) & 7) == int(turn);
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
    // Depth is linear across a plane; of two neighbours one is on the same.
    vec2 slope = vec2(smaller(depth - lower.x, upper.z - depth),
                      smaller(depth - lower.z, upper.x - depth));
    float at_first = old.z - dot(slope, share);
    vec4 expected = at_first + vec4(slope.y, slope.x + slope.y, slope.x, 0.0);
    vec4 off = abs(textureGather(old_depth, (first + 1.0) / size) - expected);
    float near_enough = 2e-4 * old.z + min(0.2 * (abs(slope.x) + abs(slope.y)), 0.03 * old.z);
    near_enough += BEFORE_SKY;
    bool alike = max(max(off.x, off.y), max(off.z, off.w)) <= near_enough;
    // Steeper than linear: blurs less where a picture is moved again and again.
    vec2 nearest = step(0.5, share);
    float off_nearest = mix(mix(off.w, off.z, nearest.x), mix(off.x, off.y, nearest.x), nearest.y);
    share = alike ? share * share * (3.0 - 2.0 * share) : nearest;
    vec3 moved = textureLod(old_radiance, (first + share + 0.5) / size, 0.0).rgb;
    bool inside = old.w > 0.0 && all(greaterThan(place, vec2(0.0)))
        && all(lessThan(place, size - 1.0));
    if (inside && off_nearest <= near_enough && !has_its_turn(ivec2(gl_FragCoord.xy))) {
        frag_radiance = vec4(brighter * moved, 1.0);
        gl_FragDepth = depth > 0.0 ? uintBitsToFloat(floatBitsToUint(depth) + 1u) : BEFORE_SKY;
    } else {
        frag_radiance = vec4(0.0, 0.0, 0.0, 1.0);
        gl_FragDepth = depth;
    }
}
