#version 430 core
// The layer along each ray that cloud_known.frag leaves: radiance and transmittance before the sky,
// and before the meshes.

//!include cloud_block.glsl
//!include cloud_ray.glsl
//!include cloud_textures.glsl
//!include cloud_density.glsl
//!include cloud_light_textures.glsl
//!include cloud_light.glsl
#ifdef THROUGH_AIR
//!include through_air.glsl
#endif
#ifdef GUIDED
// A picture of the same rays, or of rays between which they lie.
layout(binding = 11) uniform sampler2D old_distances_m;
uniform vec2 picture_px;
const float BEFORE_FIRST = 0.95;  // clouds between rays may be a little nearer
#endif

const int MOST_STEPS = 512;
// Fine steps, as shares of the layer's thickness and of the distance, in thick layers no longer
// than the billows that they must find; coarse ones in clear air are so much longer.
const float FINE = 0.025, FINEST_M = 80.0, FINE_OF_DISTANCE = 0.008, COARSE = 3.0;
// Fine steps of a piece, at least, however far it is.
const float FEWEST_STEPS = 40.0, SHORTEST_STEP_M = 1.0;
const int STEPS_TO_COARSE = 5;
// Diffused optical depth of a step in a cloud's full density.
const float DEEPEST_STEP = 1.5;
const int SURFACE_HALVINGS = 3;
const float OPAQUE = 0.01;
// Share of the visible cloud in a part, whose light is looked up once.
const float PART = 0.15;
const int MOST_PARTS = 10;

// What a ray has met so far.
struct Seen {
    float transmittance;
    float distance_m;   // summed, weighted by visibility
    float weight;
};

struct March {
    Seen seen;
    Seen at_mesh;
    int parts, parts_at_mesh;
    float first_m;      // NEVER where no cloud is met
    // Cloud share of the previous sample, and the transmittance inside that share.
    float share, in_share;
    // Weight and summed distance of each part of the visible cloud. Light changes little in
    // a part: it is looked up once for each, after the march, since a software renderer runs
    // all code of a loop in each of its turns.
    vec2 gathered[MOST_PARTS];
};

// Delta-M counts light scattered into the forward peak as unscattered. Through that part the sky
// behind shows as even light; only unscattered light shows it as a picture.
vec4 through_air_of(vec3 gathered, Seen cloud, vec3 d) {
    // The rest behind an opaque cloud is rounding.
    float hidden = cloud.transmittance < OPAQUE ? 1.0 : 0.0;
    float passed = cloud.transmittance * (1.0 - hidden);
    float seen = pow(passed, 1.0 / clouds.diffused);
    vec3 behind = d.y > 0.0 ? clouds.light_from_above : clouds.light_from_below;
    vec3 radiance = gathered / (1.0 - hidden * cloud.transmittance) + (passed - seen) * behind;
#ifdef THROUGH_AIR
    if (cloud.weight > 0.0)
        radiance = through_air(radiance, d, cloud.distance_m / cloud.weight, 1.0 - seen);
#endif
    return vec4(radiance, seen);
}

float fine_step_m(float t) {
    return max(min(FINE * clouds.thickness_m, FINEST_M), FINE_OF_DISTANCE * t);
}

void end_part(inout March march) {
    if (march.gathered[march.parts].x > 0.0) march.parts = min(march.parts + 1, MOST_PARTS - 1);
}

void march_piece(inout March march, LayerRay ray, vec2 piece, float dither) {
    float diffused_per_m = clouds.diffused * clouds.extinction_per_m;
    float t = piece.x, clear_m = piece.x, cloudy_m = piece.x;
    float coarsest_m = max((piece.y - piece.x) / FEWEST_STEPS, SHORTEST_STEP_M);
    int clear = STEPS_TO_COARSE, halvings = 0;
    bool inside = false;
    for (int i = 0; i < MOST_STEPS && t < piece.y; ++i) {
        float fine_m = min(fine_step_m(t), coarsest_m);
        bool coarse = clear >= STEPS_TO_COARSE;
        float step_m = coarse ? COARSE * fine_m : fine_m;
        // What lies deeper is seen less: it is sampled less.
        if (inside) step_m = min(step_m * (2.5 - 1.5 * march.seen.transmittance),
                                 DEEPEST_STEP / diffused_per_m);
        step_m = min(step_m, piece.y - t);
        // From a surface on, steps need no dither: they follow it.
        float at_m = halvings > 0 ? 0.5 * (clear_m + cloudy_m)
                                  : t + (inside ? 0.5 : dither) * step_m;
        if (march.parts_at_mesh < 0 && halvings == 0 && at_m > ray.mesh_m) {
            end_part(march);
            march.parts_at_mesh = march.parts;
            march.at_mesh = march.seen;
        }
        Place place = place_at(ray.d, ray.along, at_m, fine_m);
        float height = clamp(place.over_base_m / clouds.thickness_m, 0.0, 1.0);
        Column column = cloud_column(place.level, place.width_m);
        vec4 envelope = cloud_envelope(column, height);
        if (coarse && envelope.w > 0.0) {
            clear = 0;
            continue;
        }
        vec2 found = cloud_density(envelope, column.noise_range, place.level, place.over_base_m,
                                   place.width_m);
        float density = found.x, share = found.y;
        if (halvings > 0) {
            // From clear air into a cloud: finds its surface, so that no steps are visible.
            if (density > 0.0) cloudy_m = at_m;
            else clear_m = at_m;
            --halvings;
            if (halvings == 0) t = cloudy_m;
            continue;
        }
        if (density > 0.0 && !inside) {
            inside = true;
            clear = 0;
            march.first_m = min(march.first_m, at_m);
            clear_m = max(clear_m, t - fine_m);
            cloudy_m = at_m;
            halvings = SURFACE_HALVINGS;
            continue;
        }
        march.in_share = entered(march.in_share, march.seen.transmittance, march.share, share,
                                 billows_in(step_m, place.width_m));
        march.share = share;
        if (density > 0.0) {
            // Light is constant over a step: its integral is exact (Hillaire 2016, "Physically
            // Based Sky, Atmosphere and Cloud Rendering in Frostbite").
            float kept = exp(-diffused_per_m * density / share * step_m);
            float seen = march.in_share * (1.0 - kept);
            march.in_share *= kept;
            march.gathered[march.parts] += seen * vec2(1.0, at_m);
            if (march.gathered[march.parts].x > PART) end_part(march);
            march.seen.distance_m += seen * at_m;
            march.seen.weight += seen;
            march.seen.transmittance -= seen;
            if (march.seen.transmittance < OPAQUE) break;
        } else {
            if (inside) end_part(march);
            clear_m = at_m;
            inside = false;
            ++clear;
        }
        t += step_m;
    }
}

#ifdef GUIDED
// Where the first of the rays around meets a cloud.
float first_around_m() {
    vec2 texel = 1.0 / vec2(textureSize(old_distances_m, 0));
    vec2 middle = gl_FragCoord.xy / picture_px;
    vec4 first = vec4(NEVER);
    for (int i = 0; i < 4; ++i) {
        vec2 beside = vec2(i & 1, i >> 1) * 2.0 - 1.0;
        first = min(first, textureGather(old_distances_m, middle + beside * texel, 1));
    }
    return min(min(first.x, first.y), min(first.z, first.w));
}
#endif

void main() {
    LayerRay seen = layer_ray();
#ifdef GUIDED
    seen.pieces.xz = max(seen.pieces.xz, BEFORE_FIRST * first_around_m());
#endif
    // A pattern fixed to the picture (Jimenez 2014, "interleaved gradient noise").
    float dither = fract(52.9829189 * fract(dot(gl_FragCoord.xy, vec2(0.06711056, 0.00583715))));
    March march;
    march.seen = march.at_mesh = Seen(1.0, 0.0, 0.0);
    march.parts = 0;
    march.share = march.in_share = 0.0;
    march.parts_at_mesh = -1;
    march.first_m = NEVER;
    for (int i = 0; i < MOST_PARTS; ++i) march.gathered[i] = vec2(0.0);
    march_piece(march, seen, seen.pieces.xy, dither);
    if (march.seen.transmittance >= OPAQUE)
        march_piece(march, seen, seen.pieces.zw, dither);
    CloudRay view = cloud_ray(seen.d);
    vec3 radiance = vec3(0.0), radiance_at_mesh = vec3(0.0);
    for (int i = 0; i < MOST_PARTS && march.gathered[i].x > 0.0; ++i) {
        vec2 part = march.gathered[i];
        float at_m = part.y / part.x;
        Place place = place_at(seen.d, seen.along, at_m, fine_step_m(at_m));
        radiance += part.x * cloud_source(view, at_m, place.level, place.over_base_m,
                                          place.width_m);
        if (i < march.parts_at_mesh) radiance_at_mesh = radiance;
    }
    // One loop serves both, as a software renderer runs both sides of a branch.
    for (int i = 0; i < (march.parts_at_mesh < 0 ? 1 : 2); ++i) {
        before_mesh = through_air_of(i > 0 ? radiance_at_mesh : radiance,
                                     i > 0 ? march.at_mesh : march.seen, seen.d);
        if (i == 0) before_sky = before_mesh;
    }
    float mean_m = march.seen.weight > 0.0 ? march.seen.distance_m / march.seen.weight : 0.0;
    cloud_distances_m = seen.sky_hidden ? vec2(-1.0 - mean_m, 0.0) : vec2(mean_m, march.first_m);
}
