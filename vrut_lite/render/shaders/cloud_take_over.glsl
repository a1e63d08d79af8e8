// Clouds that another picture has already. While something moves, three quarters are taken over from
// the picture before, where they have moved to: each block of pixels is marched once in four
// pictures. A still interpolates a coarser picture, or that of other samples, where it is smooth.

layout(binding = 8) uniform sampler2D old_before_sky;
layout(binding = 10) uniform sampler2D old_before_mesh;
layout(binding = 11) uniform sampler2D old_distances_m;
uniform mat4 old_clip_from_axes;
uniform vec3 moved_m;  // from the eye then to the eye now, less the wind's drift
uniform int turn;

const int TURNS = 4, BLOCK = 4;  // a software renderer shades blocks at once
const float FAR_M = 1e7;
// Clouds before a mesh are taken over where they are clearly nearer or clearly farther.
const float BESIDE = 0.1;

vec2 old_place(vec3 d, float metres) {
    vec4 clip = old_clip_from_axes * vec4(d * metres + moved_m, 1.0);
    return clip.w > 0.0 ? 0.5 + 0.5 * clip.xy / clip.w : vec2(-1.0);
}

float metres_at(vec2 place) {
    float metres = textureLod(old_distances_m, place, 0.0).r;
    return metres < 0.0 ? -1.0 - metres : metres;
}

#ifdef INTERPOLATE
// Of four texels and their neighbours, how far a line misses one, and the range of the four: of
// radiance, of the greatest.
const float BENT = 0.3, RANGE = 0.5;

bool is_smooth(sampler2D picture, ivec2 low) {
    ivec2 most = textureSize(picture, 0) - 1;
    ivec2 a = max(low - 1, ivec2(0)), b = max(low, ivec2(0));
    ivec2 c = min(low + 1, most), d = min(low + 2, most);
    vec4 bb = texelFetch(picture, b, 0), cb = texelFetch(picture, ivec2(c.x, b.y), 0);
    vec4 bc = texelFetch(picture, ivec2(b.x, c.y), 0), cc = texelFetch(picture, c, 0);
    vec4 bent = abs(texelFetch(picture, ivec2(a.x, b.y), 0) + cb - 2.0 * bb);
    bent = max(bent, abs(texelFetch(picture, ivec2(d.x, b.y), 0) + bb - 2.0 * cb));
    bent = max(bent, abs(texelFetch(picture, ivec2(a.x, c.y), 0) + cc - 2.0 * bc));
    bent = max(bent, abs(texelFetch(picture, ivec2(d.x, c.y), 0) + bc - 2.0 * cc));
    bent = max(bent, abs(texelFetch(picture, ivec2(b.x, a.y), 0) + bc - 2.0 * bb));
    bent = max(bent, abs(texelFetch(picture, ivec2(b.x, d.y), 0) + bb - 2.0 * bc));
    bent = max(bent, abs(texelFetch(picture, ivec2(c.x, a.y), 0) + cc - 2.0 * cb));
    bent = max(bent, abs(texelFetch(picture, ivec2(c.x, d.y), 0) + cb - 2.0 * cc));
    vec4 least = min(min(bb, cc), min(cb, bc)), greatest = max(max(bb, cc), max(cb, bc));
    vec4 range = greatest - least;
    return all(lessThanEqual(bent.rgb, BENT * greatest.rgb)) && bent.a <= BENT
        && all(lessThanEqual(range.rgb, RANGE * greatest.rgb)) && range.a <= RANGE;
}
#endif

bool taken_over(LayerRay ray) {
    vec2 place = old_place(ray.d, FAR_M), size = vec2(textureSize(old_before_sky, 0));
    float metres = metres_at(place);
#ifdef INTERPOLATE
    ivec2 low = ivec2(floor(place * size - 0.5));
    if (!is_smooth(old_before_sky, low) || !is_smooth(old_before_mesh, low)) return false;
#else
    ivec2 block = ivec2(gl_FragCoord.xy) / BLOCK;
    if (((block.x + 2 * (block.y & 1) + (block.y >> 1)) & (TURNS - 1)) == turn) return false;
    if (metres > 0.0) place = old_place(ray.d, metres);
    vec2 margin = 0.5 / size;
    if (any(lessThan(place, margin)) || any(greaterThan(place, 1.0 - margin))) return false;
    metres = metres_at(place);
#endif
    if (metres > 0.0 && abs(ray.mesh_m - metres) < BESIDE * metres) return false;
    // What was behind a mesh was not marched.
    if (!ray.sky_hidden && any(lessThan(textureGather(old_distances_m, place), vec4(0.0))))
        return false;
    before_sky = textureLod(old_before_sky, place, 0.0);
    bool hidden = metres == 0.0 || ray.mesh_m < metres;
    before_mesh = hidden ? vec4(0.0, 0.0, 0.0, 1.0) : textureLod(old_before_mesh, place, 0.0);
    float first_m = textureLod(old_distances_m, place, 0.0).g;
    cloud_distances_m = ray.sky_hidden ? vec2(-1.0 - metres, 0.0) : vec2(metres, first_m);
    return true;
}
