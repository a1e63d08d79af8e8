#version 430
// Hosek-Wilkie sky and level ground as a cube map in world axes, in half precision.
//
// The arithmetic is that of hosek_wilkie/cube_rows.py, for the reasons that fast_formula.py
// gives: the angle from the sun out of its chord, chi's denominator and C + D exp(E gamma)
// without cancellation, and polynomials of our own: acos and exp are as good as each driver likes.

layout(local_size_x = 8, local_size_y = 8) in;
layout(rgba16f, binding = 0) writeonly uniform imageCube sky;

uniform int faces[6];           // which face each layer of work groups writes
uniform vec3 sun;               // unit vector
uniform vec3 ground;            // the ground's radiance over the scale
// The formula's numbers for red, green and blue, folded as fast_formula.fold says.
uniform vec3 zenith_base, zenith_factor, zenith_decay;
uniform vec3 CD, D, E, F, G, gap, I, H;
uniform float angle_polynomial[7];
uniform float exp2m1_polynomial[5];
uniform float horizon_offset;

const float PI = 3.14159265358979;

// 2^y - 1 = 2^n (2^f - 1) + (2^n - 1), |f| <= 1/2.
vec3 exp2m1(vec3 x) {
    vec3 y = max(x, -126.0);
    vec3 n = floor(y + 0.5);
    vec3 f = y - n;
    vec3 power = intBitsToFloat((ivec3(n) + 127) << 23);
    vec3 q = vec3(exp2m1_polynomial[4]);
    for (int k = 3; k >= 0; --k) {
        q = exp2m1_polynomial[k] + f * q;
    }
    return power * (f * q) + (power - 1.0);
}

// The angle whose squared chord is u in [0, 4]; mirrored beyond a right angle.
float angle(float u) {
    float v = min(u, 4.0 - u);
    float p = angle_polynomial[6];
    for (int k = 5; k >= 0; --k) {
        p = angle_polynomial[k] + v * p;
    }
    float near = sqrt(max(v, 0.0)) * p;
    return u <= 2.0 ? near : PI - near;
}

vec3 radiance(vec3 direction) {
    float cos_theta = direction.y;
    vec3 difference = direction - sun;
    float u = dot(difference, difference);
    float cos_gamma = 1.0 - 0.5 * u;
    float square = cos_gamma * cos_gamma;
    vec3 zenith = zenith_base + zenith_factor * exp2m1(zenith_decay / (cos_theta + horizon_offset));
    vec3 t = 1.0 / (gap + I * u);
    vec3 chi = (1.0 + square) * t * sqrt(t);
    vec3 glow = CD + D * exp2m1(E * angle(u)) + F * square + G * chi + H * sqrt(cos_theta);
    return max(zenith * glow, 0.0);
}

// Each face's middle, and where its columns and rows run: table 8.19 of the OpenGL 4.6
// specification. Constants: to build a table for each texel cost llvmpipe 8 % more.
const vec3 middle[6] = vec3[6](vec3(1.0, 0.0, 0.0), vec3(-1.0, 0.0, 0.0), vec3(0.0, 1.0, 0.0),
                               vec3(0.0, -1.0, 0.0), vec3(0.0, 0.0, 1.0), vec3(0.0, 0.0, -1.0));
const vec3 right[6] = vec3[6](vec3(0.0, 0.0, -1.0), vec3(0.0, 0.0, 1.0), vec3(1.0, 0.0, 0.0),
                              vec3(1.0, 0.0, 0.0), vec3(1.0, 0.0, 0.0), vec3(-1.0, 0.0, 0.0));
const vec3 down[6] = vec3[6](vec3(0.0, -1.0, 0.0), vec3(0.0, -1.0, 0.0), vec3(0.0, 0.0, 1.0),
                             vec3(0.0, 0.0, -1.0), vec3(0.0, -1.0, 0.0), vec3(0.0, -1.0, 0.0));

vec3 texel_direction(int face, vec2 c) {
    return normalize(middle[face] + c.x * right[face] + c.y * down[face]);
}

// To the nearest half, ties to even: drivers are free to cut the bits off instead.
vec3 rounded_to_half(vec3 x) {
    uvec3 bits = floatBitsToUint(x);
    bits += 0xFFFu + ((bits >> 13) & 1u);
    return uintBitsToFloat(bits & ~0x1FFFu);
}

void main() {
    ivec2 at = ivec2(gl_GlobalInvocationID.xy);
    int size = imageSize(sky).x;
    if (any(greaterThanEqual(at, ivec2(size)))) {
        return;
    }
    int face = faces[gl_WorkGroupID.z];
    // Divided last: some cards' quotients are not exact, and a middle must be 0.
    vec2 c = (2.0 * vec2(at) + 1.0 - float(size)) / float(size);
    vec3 direction = texel_direction(face, c);
    // By index, not by direction.y: the level row of an odd size is ground on the CPU too.
    bool up = face == 2 || (face != 3 && at.y < size / 2);
    vec3 value = up ? radiance(direction) : ground;
    imageStore(sky, ivec3(at, face), vec4(rounded_to_half(value), 1.0));
}
