#version 430
// A layer of clouds before a cube map of the sky: the twin of `look_at_clouds` in
// model/cloud_march_kernels.py, and of sky_under_clouds.py, which sums layers from the nearest on.

#include "cube.glsl"

layout(local_size_x = 8, local_size_y = 8) in;
// The clear sky, and from the last layer on the sum; radiance over the scale.
layout(rgba32f, binding = 0) uniform imageCube sky;
// Of the layers so far: light from air and clouds, and what passes; air's share of the clear light.
layout(rgba32f, binding = 2) uniform imageCube passed_so_far;
layout(rgba32f, binding = 3) uniform imageCube air_so_far;

//!clouds
// Air below the clouds: extinction of each kind at its densest (m^-1), and its scale height (m).
layout(std430, binding = 6) restrict readonly buffer CloudAir { vec4 air_kinds[]; };

uniform int is_first, is_last;
uniform vec3 air_lit;           // share of the clear sky's light on the air before the layer
uniform float inverse_scale;

const int TRANSPORT_DEPTHS = 20, TRANSPORT_VIEWS = 16;
#include "cloud_buffers.glsl"
#include "cloud_pieces.glsl"
#include "cloud_density.glsl"
#include "cloud_light.glsl"

// As in model/cloud_march_kernels.py.
const int MOST_STEPS = 256, STEPS_TO_COARSE = 8, SURFACE_HALVINGS = 4;
const float FINE = 0.02, LEAST_FINE = 0.06, FINE_OF_DISTANCE = 0.004, COARSE = 3.0;
const float FEWEST_STEPS = 40.0, SHORTEST_STEP_M = 1.0, DEEPEST_STEP = 1.0, OPAQUE = 0.005;
const uint R2 = 3242174889u, BLOCK = 4096u;

// 1 - exp(-x) of x >= 0, without cancellation.
float lost(float x) { return x < 1e-2 ? x * (1.0 - x * (0.5 - x / 6.0)) : 1.0 - exp(-x); }
vec3 lost(vec3 x) { return vec3(lost(x.r), lost(x.g), lost(x.b)); }

struct March {
    vec3 radiance;
    float transmittance, distance_m, weight;
    // Transmittance inside the share of the previous sample that is cloud.
    float in_share, share;
};

struct Sample {
    Place place;
    float envelope, density, share;
};

Sample sample_at(vec3 d, float along, float at_m, float fine_m) {
    Place place = place_at(d, along, at_m, fine_m);
    Column column = cloud_column(place.level, place.width_m);
    vec4 envelope = cloud_envelope(column,
                                   clamp(place.over_base_m / clouds.thickness_m, 0.0, 1.0));
    vec2 found = cloud_density(envelope, column.noise_range, place.level, place.over_base_m,
                               place.width_m);
    return Sample(place, envelope.w, found.x, found.y);
}

void march_piece(inout March march, CloudRay view, float along, vec2 piece, float dither) {
    float per_m = clouds.diffused * clouds.extinction_per_m;
    float t = piece.x, clear_m = piece.x;
    float fine = clamp(2.0 * clouds.pixel_rad, FINE, LEAST_FINE);
    float coarsest_m = max((piece.y - piece.x) / FEWEST_STEPS, SHORTEST_STEP_M);
    float of_distance = max(FINE_OF_DISTANCE, 0.5 * clouds.pixel_rad);
    int clear = STEPS_TO_COARSE;
    bool inside = false;
    for (int i = 0; i < MOST_STEPS && t < piece.y; ++i) {
        float fine_m = min(max(fine * clouds.thickness_m, of_distance * t), coarsest_m);
        bool coarse = clear >= STEPS_TO_COARSE;
        float step_m = coarse ? COARSE * fine_m : fine_m;
        if (inside) step_m = min(step_m, DEEPEST_STEP / per_m);
        step_m = min(step_m, piece.y - t);
        float at_m = t + (inside ? 0.5 : dither) * step_m;
        Sample found = sample_at(view.d, along, at_m, fine_m);
        if (coarse && found.envelope > 0.0) {
            clear = 0;
            continue;
        }
        if (found.density > 0.0 && !inside) {
            inside = true;
            clear = 0;
            float near = max(clear_m, t - fine_m), far = at_m;
            for (int k = 0; k < SURFACE_HALVINGS; ++k) {
                float middle = 0.5 * (near + far);
                if (sample_at(view.d, along, middle, fine_m).density > 0.0) far = middle;
                else near = middle;
            }
            t = far;
            continue;
        }
        march.in_share = entered(march.in_share, march.transmittance, march.share, found.share,
                                 billows_in(step_m, found.place.width_m));
        march.share = found.share;
        if (found.density > 0.0) {
            float seen = march.in_share * lost(per_m * found.density / found.share * step_m);
            march.radiance += seen * cloud_source(view, at_m, found.place.level,
                                                  found.place.over_base_m, found.place.width_m);
            march.distance_m += seen * at_m;
            march.weight += seen;
            march.transmittance -= seen;
            march.in_share -= seen;
            if (march.transmittance < OPAQUE) break;
        } else {
            clear_m = at_m;
            inside = false;
            ++clear;
        }
        t += step_m;
    }
}

// Among the texels above the horizon, face by face, this one's number; their dithers differ.
uint number_of(int face, ivec2 at, int size) {
    int side = size / 2 * size, before[6] = int[6](0, side, 2 * side, 0, 2 * side + size * size,
                                                   3 * side + size * size);
    return uint(before[face] + at.y * size + at.x);
}

float mean_density(float from_m, float to_m, float scale_m) {
    float rise = (max(to_m, 0.0) - from_m) / scale_m;
    float mean = abs(rise) < 1e-3 ? 1.0 - 0.5 * rise : (1.0 - exp(-rise)) / rise;
    return exp(-from_m / scale_m) * mean;
}

// Optical depths of the air to a distance; its share of the way's, and what passes of it.
void air_before(float mu, float distance_m, out vec3 share, out vec3 through) {
    float eye_m = clouds.eye_altitude_m;
    float level_m = distance_m * sqrt(max(1.0 - mu * mu, 0.0));
    float far_m = eye_m + distance_m * mu + level_m * level_m / (2.0 * PLANET_RADIUS_M);
    vec3 before = vec3(0.0), whole = vec3(0.0);
    for (int i = 0; i < air_kinds.length(); ++i) {
        float scale_m = air_kinds[i].w;
        before += air_kinds[i].rgb * (distance_m * mean_density(eye_m, far_m, scale_m));
        // Along the horizon there is as much as along so many scale heights.
        float least_mu = 1.0 / sqrt(HALF_PI * PLANET_RADIUS_M / scale_m);
        whole += air_kinds[i].rgb * (scale_m * exp(-eye_m / scale_m) / max(mu, least_mu));
    }
    through = exp(-before);
    share = clamp(lost(before) / max(lost(whole), vec3(1e-9)), 0.0, 1.0);
}

void main() {
    ivec3 at = ivec3(gl_GlobalInvocationID);
    int size = imageSize(sky).x;
    if (any(greaterThanEqual(at.xy, ivec2(size)))) return;
    vec3 d = texel_direction(at.z, at.xy, size);
    // The ground is not behind clouds of an eye below them.
    if (d.y <= 0.0) return;
    float dither = float(number_of(at.z, at.xy, size) % BLOCK * R2 + 0x80000000u) / 4294967296.0;
    float along = clouds.eye_radius_m * d.y, perigee_m = clouds.eye_radius_m * length(d.xz);
    vec4 piece = pieces(along, perigee_m, last_distance(along, perigee_m));
    CloudRay view = cloud_ray(d);
    March march = March(vec3(0.0), 1.0, 0.0, 0.0, 0.0, 0.0);
    march_piece(march, view, along, piece.xy, dither);
    if (march.transmittance >= OPAQUE) march_piece(march, view, along, piece.zw, dither);
    // The rest behind an opaque cloud is rounding.
    float hidden = march.transmittance < OPAQUE ? march.transmittance : 0.0;
    float passed = march.transmittance - hidden, through = pow(passed, 1.0 / clouds.diffused);
    vec3 own = march.radiance / (1.0 - hidden) + (passed - through) * clouds.light_from_above;
    float distance_m = march.weight > 0.0 ? march.distance_m / march.weight : 0.0;

    vec3 share, before_it;
    air_before(d.y, distance_m, share, before_it);
    vec3 clear = imageLoad(sky, at).rgb, nearer_air = vec3(0.0);
    vec4 nearer = vec4(0.0, 0.0, 0.0, 1.0);
    if (is_first == 0) {
        nearer = imageLoad(passed_so_far, at);
        nearer_air = imageLoad(air_so_far, at).rgb;
    }
    // Rays that meet no cloud have a distance of 0, which changes nothing.
    share = max(share, nearer_air);
    vec3 light = nearer.rgb + nearer.a * (clear * (share - nearer_air) * air_lit
                                          + inverse_scale * own * before_it);
    float left = nearer.a * through;
    if (is_last != 0) {
        imageStore(sky, at, vec4(light + clear * left * (1.0 - share), 1.0));
        return;
    }
    imageStore(passed_so_far, at, vec4(light, left));
    imageStore(air_so_far, at, vec4(share, 1.0));
}
