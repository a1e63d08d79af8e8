// The world direction of a cube map's texel: the table of the OpenGL specification, and the
// twin of geometry/cube_map.py.
vec3 texel_direction(ivec3 at, int size) {
    // Divided last: some cards' quotients are not exact, and a middle must be 0.
    vec2 c = (2.0 * vec2(at.xy) + 1.0 - float(size)) / float(size);
    vec3 d[6] = vec3[6](vec3(1, -c.y, -c.x), vec3(-1, -c.y, c.x), vec3(c.x, 1, c.y),
                        vec3(c.x, -1, -c.y), vec3(c.x, -c.y, 1), vec3(-c.x, -c.y, -1));
    return normalize(d[at.z]);
}
