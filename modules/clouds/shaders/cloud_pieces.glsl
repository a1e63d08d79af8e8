// A ray in a layer of clouds: its pieces, places on it, and the share of it that is cloud.

const float NEVER = 1e30;
// Width of billows in a period of the shape.
const float BILLOW = 0.3;
const float PARTED = 1e-6;

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

struct Place {
    vec2 level;
    float over_base_m;
    float width_m;
};

Place place_at(vec3 d, float along, float at_m, float fine_m) {
    // Over the base, the difference of squares factored.
    float rise = at_m * (2.0 * along + at_m);
    float radius = sqrt(clouds.eye_radius_m * clouds.eye_radius_m + rise);
    float over_base_m = clouds.eye_altitude_m - clouds.base_m
                      + rise / (clouds.eye_radius_m + radius);
    // Places keep their area (Lambert's projection).
    float upright = clouds.eye_radius_m + at_m * d.y;
    return Place(d.xz * (at_m * sqrt(2.0 * radius / (radius + upright))), over_base_m,
                 max(clouds.pixel_rad * at_m, 0.25 * fine_m));
}

// Billows of the shape in a step.
float billows_in(float step_m, float width_m) {
    return step_m / min(width_m, clouds.noise_periods_m.x * BILLOW);
}

// A wide ray is many, some in clouds and some beside them. From one sample to the next the fewest
// cross a side; with the way they are mixed (Hogan and Illingworth 2000, "Deriving cloud overlap
// statistics from radar"). Transmittance inside a share of clouds that follows another.
float entered(float in_share, float transmittance, float before, float share, float way) {
    float beside = transmittance - in_share, grown = share - before;
    in_share += grown * (grown > 0.0 ? beside / max(1.0 - before, PARTED)
                                     : in_share / max(before, PARTED));
    return mix(share * transmittance, in_share, 1.0 / (1.0 + way));
}
