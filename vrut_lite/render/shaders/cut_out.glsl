// Coverage of a cut-out surface; render/cut_out.py describes its map.

// Level of detail of a pixel in a map, clamped to [0, 1]. Drivers differ in textureQueryLod for
// maps with a LOD bias.
float level_to_one(sampler2D map, vec2 uv) {
    vec2 texels = vec2(textureSize(map, 0)), x = dFdx(uv) * texels, y = dFdy(uv) * texels;
    return clamp(0.5 * log2(max(max(dot(x, x), dot(y, y)), 1e-12)), 0.0, 1.0);
}

// Share of a pixel that a map with this alpha covers: an edge one pixel wide where texels are
// larger than pixels, the map's own coverage where they are smaller.
float covered_share(sampler2D map, vec2 uv, float alpha) {
    float edge = clamp((alpha - 0.5) / clamp(fwidth(alpha), 1e-4, 1.0) + 0.5, 0.0, 1.0);
    return mix(edge, alpha, level_to_one(map, uv));
}

// Hash of the triangle's number, so that surfaces behind each other cover different pixels.
int number_of_triangle() {
    uint mixed = uint(gl_PrimitiveID) * 747796405u;
    mixed = (mixed ^ (mixed >> 16)) * 2654435769u;
    return int(mixed >> 16);
}

// Threshold of a shadow map's texel, uniform over the 3 x 3 texels of a look-up.
float shadow_threshold() {
    ivec2 at = ivec2(gl_FragCoord.xy) % 3;
    return (float(((3 * at.y + at.x) * 4 + number_of_triangle()) % 9) + 0.5) / 9.0;
}
