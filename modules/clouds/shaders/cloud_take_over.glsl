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
// Clouds before a mesh are taken over where they are clearly nearer or clearly farther; a cloud is
// where the picture before says it to be within this share of its distance.
const float BESIDE = 0.1;

vec2 old_place(vec3 from_old_eye) {
    vec4 clip = old_clip_from_axes * vec4(from_old_eye, 1.0);
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

#ifndef INTERPOLATE
// Along the ray the layer is looked for in the picture before at so many distances, from where it
// begins, or where a cloud around the eye is thick. Where they lie far apart nothing is known, nor
// where the nearest has moved by more than this share of its distance from the sun: the light there
// does not move along.
const int SAMPLES = 4;
const float NEAREST_M = 50.0, FARTHEST_TEXELS = 6.0, TO_SUN = 0.04;

struct Known {
    vec2 place;
    float metres;  // of the cloud, 0 for none, negative where the picture before does not say
};

Known known(LayerRay ray, vec2 size) {
    float begins_m = ray.pieces.x < ray.pieces.y ? ray.pieces.x : ray.pieces.z;
    float nearest = 1.0 / max(begins_m, NEAREST_M);
    vec2 place = old_place(ray.d * FAR_M);
    vec2 first = old_place(ray.d / nearest + moved_m);
    float to_sun = distance(ray.d, clouds.sun_direction);
    if (length((first - place) * size) > FARTHEST_TEXELS
        || length(moved_m) * nearest > TO_SUN * to_sun) return Known(place, -1.0);
    for (int i = 0; i < SAMPLES; ++i) {
        vec3 at = ray.d / mix(nearest, 1.0 / FAR_M, float(i) / float(SAMPLES - 1)) + moved_m;
        float metres = metres_at(old_place(at)), old_m = length(at);
        if (metres > 0.0 && metres < old_m * (1.0 + BESIDE)) {
            // The ray passes a cloud, or behind it.
            float now_m = metres - dot(ray.d, moved_m);
            at = ray.d * now_m + moved_m;
            place = old_place(at);
            metres = metres_at(place);
            bool same = metres > 0.0 && abs(metres - length(at)) < BESIDE * metres;
            return Known(place, same ? now_m : -1.0);
        }
    }
    return Known(place, 0.0);
}
#endif

bool taken_over(LayerRay ray) {
    vec2 size = vec2(textureSize(old_before_sky, 0));
#ifdef INTERPOLATE
    vec2 place = old_place(ray.d);
    float metres = metres_at(place);
    ivec2 low = ivec2(floor(place * size - 0.5));
    if (!is_smooth(old_before_sky, low) || !is_smooth(old_before_mesh, low)) return false;
#else
    ivec2 block = ivec2(gl_FragCoord.xy) / BLOCK;
    if (((block.x + 2 * (block.y & 1) + (block.y >> 1)) & (TURNS - 1)) == turn) return false;
    Known cloud = known(ray, size);
    vec2 place = cloud.place;
    float metres = cloud.metres;
    vec2 margin = 0.5 / size;
    if (metres < 0.0 || any(lessThan(place, margin)) || any(greaterThan(place, 1.0 - margin)))
        return false;
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
