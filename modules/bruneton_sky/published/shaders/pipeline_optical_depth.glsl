// Look-up of the transmittance; the table holds the optical depth, since in haze the
// transmittances themselves are zero in single precision where their ratio is not.
//
// Between nodes it is the transmittances that are blended linearly, as in the double precision
// twin. By hand: the weights of a GPU's own filter have 8 bits.

layout(binding = 0) uniform sampler2D optical_depth;    // x: mu, y: altitude

// factor times exp(-depth); the factor is never zero.
struct Transmittance {
    vec4 depth;
    vec4 factor;
};

// Depth of a node, infinite where the node has no weight.
vec4 node_depth(ivec2 at, float weight) {
    return weight > 0.0 ? texelFetch(optical_depth, at, 0) : vec4(3e38);
}

// To the top of the atmosphere, from a point in a direction with a deficit: the difference of its
// ray to the longest that misses the ground.
Transmittance transmittance_to_top(Point point) {
    const ivec2 size = ivec2(TRANSMITTANCE_MU, TRANSMITTANCE_ALTITUDE);
    float lacking = point.deficit / room_to_top(point.altitude);
    float unit = tangent(point.altitude) / top_tangent_m;
    // From the last node of mu: near the horizon the smallest weight counts.
    vec2 place = clamp(vec2(lacking, unit), 0.0, 1.0) * vec2(size - 1);
    ivec2 at = min(ivec2(place), size - 2);
    vec2 far = place - vec2(at);
    vec2 near = 1.0 - far;
    vec4 weight = vec4(near.x, far.x, near.x, far.x) * vec4(near.yy, far.yy);
    ivec2 node = ivec2(size.x - 1 - at.x, at.y);
    vec4 a = node_depth(node, weight.x);
    vec4 b = node_depth(node - ivec2(1, 0), weight.y);
    vec4 c = node_depth(node + ivec2(0, 1), weight.z);
    vec4 d = node_depth(node + ivec2(-1, 1), weight.w);
    vec4 least = min(min(a, b), min(c, d));
    vec4 factor = weight.x * exp(least - a) + weight.y * exp(least - b)
        + weight.z * exp(least - c) + weight.w * exp(least - d);
    return Transmittance(least, factor);
}

// A point and a direction that misses the ground.
Point towards(float altitude, float mu) {
    return Point(altitude, longest_to_top(altitude) - length_to_top(altitude, mu));
}

vec4 value(Transmittance t) {
    return t.factor * exp(-t.depth);
}

// Between two points of a ray, from both their transmittances to where it leaves the air.
vec4 ratio(Transmittance whole, Transmittance rest) {
    return min(exp(rest.depth - whole.depth) * whole.factor / rest.factor, 1.0);
}

// To the sun's disc, fading as it sinks below the horizon: a smooth step over its width.
vec4 transmittance_to_sun(float altitude, float mu_s) {
    float inverse_radius = 1.0 / (ground_radius_m + altitude);
    float half_width = sun_angular_radius * ground_radius_m * inverse_radius;
    float above = mu_s + tangent(altitude) * inverse_radius;
    if (above <= -half_width) {
        return vec4(0.0);
    }
    float shown = smoothstep(-half_width, half_width, above);
    return shown * value(transmittance_to_top(towards(altitude, mu_s)));
}
