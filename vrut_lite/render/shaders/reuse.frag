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

// Four turns, so that neighbours follow each other crosswise.
bool has_its_turn(ivec2 pixel) {
    ivec2 block = (pixel / BLOCK) & 1;
    int number = 2 * (block.x ^ block.y) + block.y;
    return turn < 0.0 || number == int(turn);
}

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    float depth = texelFetch(front, pixel, 0).r;
    vec4 old = old_from_clip * vec4(2.0 * at - 1.0, depth, 1.0);
    old.xyz /= old.w;
    vec2 size = vec2(textureSize(old_radiance, 0)), place = (0.5 + 0.5 * old.xy) * size - 0.5;
    vec2 first = floor(place), share = place - first;
    // Depth is linear across a plane; where it jumps little may pass.
    float slope = min(abs(dFdx(old.z)) + abs(dFdy(old.z)), 0.1 * old.z);
    float near_enough = 0.005 * old.z + slope + BEFORE_SKY;
    // Steeper than linear: blurs less where a picture is moved again and again.
    share *= share * (3.0 - 2.0 * share);
    vec4 weights = vec4((1.0 - share.x) * (1.0 - share.y), share.x * (1.0 - share.y),
                        (1.0 - share.x) * share.y, share.x * share.y);
    vec3 sum = vec3(0.0);
    float found = 0.0;
    ivec2 most = ivec2(size) - 1, corner = ivec2(first);
    for (int k = 0; k < 4; ++k) {
        ivec2 texel = clamp(corner + ivec2(k & 1, k >> 1), ivec2(0), most);
        float there = texelFetch(old_depth, texel, 0).r;
        float weight = abs(there - old.z) <= near_enough ? weights[k] : 0.0;
        sum += weight * texelFetch(old_radiance, texel, 0).rgb;
        found += weight;
    }
    bool inside = old.w > 0.0 && all(greaterThan(place, vec2(-0.5)))
        && all(lessThan(place, size - 0.5));
    if (inside && found > 0.4 && !has_its_turn(pixel)) {
        frag_radiance = vec4(brighter * sum / found, 1.0);
        gl_FragDepth = depth > 0.0 ? uintBitsToFloat(floatBitsToUint(depth) + 1u) : BEFORE_SKY;
    } else {
        frag_radiance = vec4(0.0, 0.0, 0.0, 1.0);
        gl_FragDepth = depth;
    }
}
