// Texels of a cube map: their directions, and values fit for half precision.

// World axes, by table 8.19 of the OpenGL 4.6 specification; a place on a face runs
// from -1 to 1.
vec3 face_direction(int face, vec2 c) {
    vec3 d[6] = vec3[6](vec3(1.0, -c.y, -c.x), vec3(-1.0, -c.y, c.x), vec3(c.x, 1.0, c.y),
                        vec3(c.x, -1.0, -c.y), vec3(c.x, -c.y, 1.0), vec3(-c.x, -c.y, -1.0));
    return normalize(d[face]);
}

// Divided last: some cards' quotients are not exact, and a middle must be 0.
vec2 texel_middle(ivec2 at, int size) {
    return (2.0 * vec2(at) + 1.0 - float(size)) / float(size);
}

vec3 texel_direction(int face, ivec2 at, int size) {
    return face_direction(face, texel_middle(at, size));
}

// To the nearest half, ties to even: drivers are free to cut the bits off instead.
vec3 rounded_to_half(vec3 x) {
    uvec3 bits = floatBitsToUint(x);
    bits += 0xFFFu + ((bits >> 13) & 1u);
    return uintBitsToFloat(bits & ~0x1FFFu);
}
