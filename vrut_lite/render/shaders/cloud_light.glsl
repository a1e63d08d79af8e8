// Light from a point in a cloud towards the eye.

layout(binding = 3) uniform sampler2D sun_aloft;  // the sun at base and top, by its height

const float CLOUD_PI = 3.141592653589793;
// Light scattered more than once, as isotropic terms (Wrenninge 2013's octaves): share, and
// extinction relative to the cloud's. How far from discrete ordinates: docs/clouds.md.
const vec2 OCTAVES[3] = vec2[3](vec2(2.0, 1.0), vec2(0.8, 0.03), vec2(0.28, 0.0066));
// 3/4 (1 - g) of Eddington's two streams: the transmittance of tau is 1 / (1 + this * tau).
const float DIFFUSION = 0.2;
// Of a cloud's full density, in the mean over the paths of light from the sky.
const float MEAN_DENSITY = 0.5;
const int SUN_STEPS = 6;
// All steps as a share of the layer's thickness, the first as a share of all; how others grow.
const float REACH = 1.6, FIRST_STEP = 0.01954572, STEP_GROWTH = 1.9;
// Sines of the sun's elevation that the table spans.
const float LOWEST_SUN = -0.1;

float henyey_greenstein(float beside, float g) {
    float spread = (1.0 - g) * (1.0 - g) + 2.0 * g * beside;
    return (1.0 - g * g) / (4.0 * CLOUD_PI * pow(spread, 1.5));
}

// `beside`: 1 - the cosine of the angle to the sun.
float cloud_phase(float beside) {
    return mix(henyey_greenstein(beside, clouds.phase.y), henyey_greenstein(beside, clouds.phase.x),
               clouds.phase.z);
}

// Towards the sun, until the layer ends.
float sun_optical_depth(vec2 level, float over_base_m, float width_m) {
    float rise = clouds.sun_direction.y;
    float room_m = rise > 0.0 ? clouds.thickness_m - over_base_m : over_base_m;
    float reach_m = min(REACH * clouds.thickness_m, max(room_m, 0.0) / max(abs(rise), 1e-6));
    float step_m = FIRST_STEP * reach_m, gone_m = 0.0, depth = 0.0;
    for (int i = 0; i < SUN_STEPS; ++i) {
        float at_m = gone_m + 0.5 * step_m;
        depth += step_m * cloud_density_at(level + clouds.sun_direction.xz * at_m,
                                           over_base_m + rise * at_m, max(width_m, 0.5 * step_m));
        gone_m += step_m;
        step_m *= STEP_GROWTH;
    }
    return depth * clouds.extinction_per_m;
}

// The sun sinks and rises with the way along the planet.
vec3 sun_at(vec2 level, float height) {
    float sine = clouds.sun_direction.y + dot(level, clouds.sun_direction.xz) / PLANET_RADIUS_M;
    float row = sqrt(clamp((sine - LOWEST_SUN) / (1.0 - LOWEST_SUN), 0.0, 1.0));
    vec2 size = vec2(textureSize(sun_aloft, 0));
    return textureLod(sun_aloft, (vec2(row, height) * (size - 1.0) + 0.5) / size, 0.0).rgb;
}

// Radiance per optical depth, W m^-2 sr^-1.
vec3 cloud_source(vec2 level, float over_base_m, Column column, float phase, float width_m) {
    float height = over_base_m / clouds.thickness_m;
    float depth = sun_optical_depth(level, over_base_m, width_m);
    float scattered = phase * exp(-depth);
    for (int k = 0; k < 3; ++k)
        scattered += OCTAVES[k].x * exp(-OCTAVES[k].y * depth) / (4.0 * CLOUD_PI);
    float full_depth = clouds.extinction_per_m * clouds.thickness_m * MEAN_DENSITY;
    float above = max(column.top - height, 0.0) * full_depth, below = height * full_depth;
    vec3 sky = 0.5 * (clouds.light_from_above / (1.0 + DIFFUSION * above)
                      + clouds.light_from_below / (1.0 + DIFFUSION * below));
    return sun_at(level, height) * scattered + sky;
}
