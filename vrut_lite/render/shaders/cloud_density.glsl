// Density of clouds: the twin of daylight/cloud_density.py, which explains it.

layout(binding = 0) uniform sampler2D cloud_weather;
layout(binding = 1) uniform sampler3D cloud_shape;
layout(binding = 2) uniform sampler3D cloud_detail;

const float PLANET_RADIUS_M = 6.36e6;
const float WEATHER_TURN_RAD = 0.65;
const float NOISE_TURN_RAD = 0.3;
const float WARP = 0.3;
const vec2 WARP_WAVES = vec2(0.306, 0.414);
const float ANVIL_FROM = 0.72, ANVIL_BASE_FADE = 0.1, ANVIL_TOP_FADE = 0.12;
const float WHOLE_TURN = 6.283185307179586;

vec2 turned(vec2 p, float angle) {
    float c = cos(angle), s = sin(angle);
    return vec2(c * p.x - s * p.y, s * p.x + c * p.y);
}

struct Column {
    float side;
    float top;
};

// `width_m`: width of a sample. Weather is never smoothed so far that the threshold
// would find other clouds in it.
const float SMOOTHEST_WEATHER = 2.0;

Column cloud_column(vec2 level, float width_m) {
    vec2 texels_m = clouds.weather_periods_m / float(textureSize(cloud_weather, 0).x);
    vec2 lod = min(log2(max(vec2(width_m) / texels_m, 1e-6)), SMOOTHEST_WEATHER);
    vec2 first = clouds.weather_origin.xy + level / clouds.weather_periods_m.x;
    vec2 second = clouds.weather_origin.zw
                + turned(level, WEATHER_TURN_RAD) / clouds.weather_periods_m.y;
    float weather = mix(textureLod(cloud_weather, first, lod.x).r,
                        textureLod(cloud_weather, second, lod.y).r, clouds.second_share);
    float above = weather - clouds.threshold;
    float growth = clamp(above / clouds.growth, 0.0, 1.0);
    return Column(above / clouds.side_fade,
                  clouds.least_height + (1.0 - clouds.least_height) * growth * (2.0 - growth));
}

// `height`: over the base, as a share of the layer's thickness.
float cloud_envelope(Column column, float height) {
    float base = clamp(height / clouds.base_fade, 0.0, 1.0);
    float top = clamp((1.0 - height / column.top) / clouds.top_fade, 0.0, 1.0);
    float cloud = clamp(column.side, 0.0, 1.0) * base * sqrt(top);
    if (clouds.anvil == 0.0) return cloud;
    float from_base = clamp((height - ANVIL_FROM) / ANVIL_BASE_FADE, 0.0, 1.0);
    float to_top = clamp((1.0 - height) / ANVIL_TOP_FADE, 0.0, 1.0);
    return max(cloud, clamp(column.side + clouds.anvil, 0.0, 1.0) * from_base * to_top);
}

float cloud_noise(sampler3D volume, vec3 at, float period_m, float width_m) {
    float lod = log2(max(width_m * float(textureSize(volume, 0).x) / period_m, 1e-6));
    return textureLod(volume, at, lod).r;
}

// Density in [0, 1]: the noise cut by the envelope; where the detail cannot change it,
// it is not looked up.
float cloud_density(float envelope, vec2 level, float over_base_m, float width_m) {
    if (envelope <= 0.0) return 0.0;
    vec2 at_base = turned(level, NOISE_TURN_RAD) / vec2(clouds.stretch, 1.0);
    vec2 at = at_base - vec2(clouds.lean * over_base_m / clouds.stretch, 0.0);
    float period_m = clouds.noise_periods_m.x;
    vec2 waves = sin(WHOLE_TURN * (clouds.warp_origin + WARP_WAVES * at_base.yx / period_m));
    vec3 in_shape = vec3(clouds.noise_origin.xy + at / period_m + WARP * waves,
                         over_base_m / period_m);
    float kept = cloud_noise(cloud_shape, in_shape, period_m, width_m) + envelope - 1.0;
    if (kept <= 0.0) return 0.0;
    if (kept < clouds.fraying + 1.0 / clouds.sharpness) {
        period_m = clouds.noise_periods_m.y;
        vec3 in_detail = vec3(clouds.noise_origin.zw + at / period_m, over_base_m / period_m);
        kept -= clouds.fraying * cloud_noise(cloud_detail, in_detail, period_m, width_m);
    }
    return clamp(clouds.sharpness * kept, 0.0, 1.0);
}

float cloud_density_at(vec2 level, float over_base_m, float width_m) {
    float height = over_base_m / clouds.thickness_m;
    if (height < 0.0 || height > 1.0) return 0.0;
    return cloud_density(cloud_envelope(cloud_column(level, width_m), height), level, over_base_m,
                         width_m);
}
