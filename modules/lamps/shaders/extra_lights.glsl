// The scene's lamps; vrut_lite/messages/lamps.py defines their numbers.
//!include lamp_block.glsl

// Drawn by lamp_shadows.py.
//!sampler sampler2DShadow lamp_shadows
//!sampler sampler2DArray lamp_tables

const float TURN = 6.283185307179586;

// Share of a lamp's intensity into a direction: its cone, and its table if it has one.
float lamp_share(mat4 lamp, vec3 d) {
    float along = dot(lamp[1].xyz, d);
    float ramp = clamp((along - lamp[1].w) * lamp[0].w, 0.0, 1.0);
    float share = ramp * ramp;
    if (lamp[2].w >= 0.0 && share > 0.0) {
        vec3 side = lamp[3].w * cross(lamp[2].xyz, lamp[1].xyz);
        vec2 around = vec2(dot(lamp[2].xyz, d), dot(side, d));
        // Straight along the axis every angle around it is as good.
        float turn = dot(around, around) > 0.0 ? atan(around.y, around.x) / TURN : 0.0;
        vec2 at = vec2(fract(turn), acos(clamp(along, -1.0, 1.0)) / PI);
        vec2 nodes = vec2(textureSize(lamp_tables, 0).xy);
        share *= texture(lamp_tables, vec3((at * (nodes - 1.0) + 0.5) / nodes, lamp[2].w)).r;
    }
    return share;
}

// Share of a lamp that is seen from a point, which counts from the lamp; `face` is the surface's.
float lamp_visibility(int number, vec3 p, vec3 face) {
    vec3 size = abs(p);
    float farthest = max(size.x, max(size.y, size.z));
    // Off the surface by what the taps can span, as for the sun.
    vec3 d = p + face * (2.5 * lamps.texel * farthest);
    size = abs(d);
    farthest = max(size.x, max(size.y, size.z));
    if (farthest <= 0.0) return 1.0;
    int axis = size.x == farthest ? 0 : size.y == farthest ? 1 : 2;
    vec2 place = vec2(d[(axis + 1) % 3], d[(axis + 2) % 3]) * (lamps.face_share / farthest);
    int tile = 2 * axis + (d[axis] < 0.0 ? 1 : 0);
    vec2 at = (vec2(tile, number) + 0.5 + 0.5 * place) / lamps.tiles;
    float depth = lamps.depth_scale + lamps.depth_offset / farthest;
    vec2 texel = 1.0 / vec2(textureSize(lamp_shadows, 0));
    float lit = 0.0;
    for (int i = -1; i <= 1; ++i)
        for (int j = -1; j <= 1; ++j)
            lit += texture(lamp_shadows, vec3(at + vec2(i, j) * texel, depth));
    return lit / 9.0;
}

int extra_light_count() {
    return int(lamps.count);
}

// Irradiance of a lamp on a plane that faces it, at a point relative to the eye.
vec3 extra_light(int number, vec3 point, vec3 face, out vec3 towards) {
    mat4 lamp = lamps.lamps[number];
    vec3 p = point - lamp[0].xyz;
    float squared = dot(p, p);
    towards = -p * inversesqrt(max(squared, 1e-20));
    if (dot(face, towards) <= 0.0 || squared <= 0.0) return vec3(0.0);
    float share = lamp_share(lamp, -towards) / squared;
    if (share <= 0.0) return vec3(0.0);
    return lamp[3].rgb * (share * lamp_visibility(number, p, face));
}
