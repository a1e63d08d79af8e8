#version 430 core
// The layer along each ray: radiance and transmittance before the sky, and before the meshes.

//!include cloud_block.glsl
//!include cloud_density.glsl
//!include cloud_light.glsl
#ifdef AIR
//!include air.glsl
#endif
#ifdef BEFORE_MESHES
layout(binding = 4) uniform sampler2D mesh_depth;
uniform float near_m;
uniform float mesh_pixels;
uniform vec3 view_axis;
#endif

in vec3 ray;
layout(location = 0) out vec4 before_sky;
layout(location = 1) out vec4 before_mesh;
layout(location = 2) out float cloud_distance_m;  // the mean of what is seen, 0 where there is none
#ifdef TAKE_OVER
//!include cloud_take_over.glsl
#endif

const int MOST_STEPS = 256;
// Fine steps, as shares of the layer's thickness and of the distance; coarse ones in clear air
// are so much longer.
const float FINE = 0.025, FINE_OF_DISTANCE = 0.006, COARSE = 3.0;
// Fine steps of a piece, at least, however far it is.
const float FEWEST_STEPS = 40.0, SHORTEST_STEP_M = 1.0;
const int STEPS_TO_COARSE = 5;
// Diffused optical depth of a step in a cloud's full density.
const float DEEPEST_STEP = 1.5;
const int SURFACE_HALVINGS = 4;
const float OPAQUE = 0.01;
const float NEVER = 1e30;

// Distances to where the ray enters and leaves a sphere, and half the chord; none if negative.
vec3 chord(float along, float perigee_m, float squares_m2) {
    float radius = sqrt(clouds.eye_radius_m * clouds.eye_radius_m + squares_m2);
    // Two equal forms of one square; this one has less cancellation.
    float squared = squares_m2 < 0.0 && perigee_m < 0.7 * radius
        ? (radius - perigee_m) * (radius + perigee_m) : along * along + squares_m2;
    if (squared <= 0.0) return vec3(NEVER, -NEVER, -1.0);
    float root = sqrt(squared);
    float far = along > 0.0 ? along + root : root - along;
    return along > 0.0 ? vec3(-far, squares_m2 / far, root)
                       : vec3(-squares_m2 / far, far, root);
}

float last_distance(float along, float perigee_m) {
    vec3 ground = chord(along, perigee_m, clouds.ground_squares_m2);
    return ground.z > 0.0 && along < 0.0 ? ground.x : NEVER;
}

// The one or two pieces of a ray that lie in the layer: (from, to) each, in m from the eye.
vec4 pieces(float along, float perigee_m, float last_m) {
    vec3 top = chord(along, perigee_m, clouds.top_squares_m2);
    vec3 base = chord(along, perigee_m, clouds.base_squares_m2);
    float first_m = max(top.x, 0.0), end_m = min(top.y, last_m);
    if (base.z < 0.0) return vec4(first_m, end_m, NEVER, -NEVER);
    return vec4(first_m, min(end_m, base.x), max(first_m, base.y), end_m);
}

struct March {
    vec3 radiance;
    float transmittance;
    float distance_m;   // summed, weighted by what is seen
    float weight;
    vec4 at_mesh;
};

// Delta-M takes what is scattered into the forward peak for passed: of this, the sky behind is seen
// as even light, and only what was not scattered as a picture.
vec4 through_air_of(March march, vec3 d) {
    float seen = pow(march.transmittance, 1.0 / clouds.diffused);
    vec3 behind = d.y > 0.0 ? clouds.light_from_above : clouds.light_from_below;
    vec3 radiance = march.radiance + (march.transmittance - seen) * behind;
#ifdef AIR
    if (march.weight > 0.0) {
        AirRay ray = air_ray(d);
        AirLight light = air_before(ray, march.distance_m / march.weight);
        radiance = radiance * light.transmittance
                 + (1.0 - seen) * (light.shaded + light.sunlit);
    }
#endif
    return vec4(radiance, seen);
}

struct Place {
    vec2 level;
    float over_base_m;
    float width_m;
    float envelope;
    Column column;
};

Place place_at(vec3 d, float along, float at_m, float fine_m) {
    vec2 level = d.xz * at_m;
    // Over the base, the difference of squares factored.
    float rise = at_m * (2.0 * along + at_m);
    float radius = sqrt(clouds.eye_radius_m * clouds.eye_radius_m + rise);
    float over_base_m = clouds.eye_altitude_m - clouds.base_m
                      + rise / (clouds.eye_radius_m + radius);
    float width_m = max(clouds.pixel_rad * at_m, 0.25 * fine_m);
    Column column = cloud_column(level, width_m);
    float height = clamp(over_base_m / clouds.thickness_m, 0.0, 1.0);
    return Place(level, over_base_m, width_m, cloud_envelope(column, height), column);
}

float density_in(Place place) {
    return cloud_density(place.envelope, place.level, place.over_base_m, place.width_m);
}

// From clear air into a cloud: finds its surface, so that no steps are visible.
float surface_between(vec3 d, float along, float clear_m, float cloudy_m, float fine_m) {
    for (int k = 0; k < SURFACE_HALVINGS; ++k) {
        float middle = 0.5 * (clear_m + cloudy_m);
        if (density_in(place_at(d, along, middle, fine_m)) > 0.0) cloudy_m = middle;
        else clear_m = middle;
    }
    return cloudy_m;
}

void march_piece(inout March march, CloudRay ray, vec2 piece, float along, float dither,
                 float mesh_m) {
    vec3 d = ray.d;
    float diffused_per_m = clouds.diffused * clouds.extinction_per_m;
    float t = piece.x, clear_m = piece.x;
    float coarsest_m = max((piece.y - piece.x) / FEWEST_STEPS, SHORTEST_STEP_M);
    int clear = STEPS_TO_COARSE;
    bool inside = false, passed = march.at_mesh.a >= 0.0;
    for (int i = 0; i < MOST_STEPS && t < piece.y; ++i) {
        float fine_m = min(max(FINE * clouds.thickness_m, FINE_OF_DISTANCE * t), coarsest_m);
        bool coarse = clear >= STEPS_TO_COARSE;
        float step_m = coarse ? COARSE * fine_m : fine_m;
        // What lies deeper is seen less: it is sampled less.
        if (inside) step_m = min(step_m * (2.5 - 1.5 * march.transmittance),
                                 DEEPEST_STEP / diffused_per_m);
        step_m = min(step_m, piece.y - t);
        // From a surface on, steps need no dither: they follow it.
        float at_m = t + (inside ? 0.5 : dither) * step_m;
        if (!passed && at_m > mesh_m) {
            march.at_mesh = through_air_of(march, d);
            passed = true;
        }
        Place place = place_at(d, along, at_m, fine_m);
        if (coarse && place.envelope > 0.0) {
            clear = 0;
            continue;
        }
        float density = density_in(place);
        if (density > 0.0 && !inside) {
            inside = true;
            clear = 0;
            t = surface_between(d, along, max(clear_m, t - fine_m), at_m, fine_m);
            continue;
        }
        if (density > 0.0) {
            // Light is constant over a step: its integral is exact (Hillaire 2016, "Physically
            // Based Sky, Atmosphere and Cloud Rendering in Frostbite").
            float kept = exp(-diffused_per_m * density * step_m);
            float seen = march.transmittance * (1.0 - kept);
            march.radiance += seen * cloud_source(ray, at_m, place.level, place.over_base_m,
                                                  density, place.width_m);
            march.distance_m += seen * at_m;
            march.weight += seen;
            march.transmittance *= kept;
            if (march.transmittance < OPAQUE) break;
        } else {
            clear_m = at_m;
            inside = false;
            ++clear;
        }
        t += step_m;
    }
}

void main() {
    vec3 d = normalize(ray);
    float along = clouds.eye_radius_m * d.y, perigee_m = clouds.eye_radius_m * length(d.xz);
    float mesh_m = NEVER;
#ifdef BEFORE_MESHES
    float depth = texelFetch(mesh_depth, ivec2(gl_FragCoord.xy * mesh_pixels), 0).r;
    if (depth > 0.0) mesh_m = near_m / depth / dot(d, view_axis);
#endif
#ifdef TAKE_OVER
    if (taken_over(d, mesh_m)) return;
#endif
    vec4 piece = pieces(along, perigee_m, last_distance(along, perigee_m));
    CloudRay view = cloud_ray(d);
    // A pattern fixed to the picture (Jimenez 2014, "interleaved gradient noise").
    float dither = fract(52.9829189 * fract(dot(gl_FragCoord.xy, vec2(0.06711056, 0.00583715))));
    March march = March(vec3(0.0), 1.0, 0.0, 0.0, vec4(0.0, 0.0, 0.0, -1.0));
    march_piece(march, view, piece.xy, along, dither, mesh_m);
    if (march.transmittance >= OPAQUE)
        march_piece(march, view, piece.zw, along, dither, mesh_m);
    // The rest behind an opaque cloud is rounding.
    float hidden = march.transmittance < OPAQUE ? 1.0 : 0.0;
    march.radiance /= 1.0 - hidden * march.transmittance;
    march.transmittance *= 1.0 - hidden;
    before_sky = through_air_of(march, d);
    before_mesh = march.at_mesh.a >= 0.0 ? march.at_mesh : before_sky;
    cloud_distance_m = march.weight > 0.0 ? march.distance_m / march.weight : 0.0;
}
