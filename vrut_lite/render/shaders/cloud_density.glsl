// Density of clouds: the twin of daylight/cloud_density.py, which explains it.

layout(binding = 0) uniform sampler2D cloud_weather;
layout(binding = 1) uniform sampler3D cloud_shape;
layout(binding = 2) uniform sampler3D cloud_detail;

const float PLANET_RADIUS_M = 6.36e6;
const vec2 WEATHER_PERIODS_M = vec2(37000.0, 23300.0);
const float SHAPE_PERIOD_M = 5300.0;
const float DETAIL_PERIOD_M = 830.0;
const vec2 WEATHER_SHARES = vec2(0.65, 0.35);
const float WEATHER_TURN_RAD = 0.65;
const float NOISE_TURN_RAD = 0.3;
const float GROWTH = 0.42;
const float LEAST_HEIGHT = 0.22;
const float BASE_FADE = 0.05;
const float TOP_FADE = 0.75;
const float SIDE_FADE = 0.16;
const float FRAYING = 0.32;
const float SHARPNESS = 5.0;

vec2 turned(vec2 p, float angle) {
    float c = cos(angle), s = sin(angle);
    return vec2(c * p.x - s * p.y, s * p.x + c * p.y);
}

struct Column {
    float strength;
    float top;
};

// `width_m`: width of a sample. Weather is never smoothed so far that the threshold
// would find other clouds in it.
const float SMOOTHEST_WEATHER = 2.0;

Column cloud_column(vec2 level, float width_m) {
    vec2 texels_m = WEATHER_PERIODS_M / float(textureSize(cloud_weather, 0).x);
    vec2 lod = min(log2(max(vec2(width_m) / texels_m, 1e-6)), SMOOTHEST_WEATHER);
    vec2 first = clouds.weather_origin.xy + level / WEATHER_PERIODS_M.x;
    vec2 second = clouds.weather_origin.zw + turned(level, WEATHER_TURN_RAD) / WEATHER_PERIODS_M.y;
    float weather = WEATHER_SHARES.x * textureLod(cloud_weather, first, lod.x).r
                  + WEATHER_SHARES.y * textureLod(cloud_weather, second, lod.y).r;
    float above = weather - clouds.threshold;
    float growth = clamp(above / GROWTH, 0.0, 1.0);
    return Column(clamp(above / SIDE_FADE, 0.0, 1.0),
                  LEAST_HEIGHT + (1.0 - LEAST_HEIGHT) * growth * (2.0 - growth));
}

// `height`: over the base, as a share of the layer's thickness.
float cloud_envelope(Column column, float height) {
    float base = clamp(height / BASE_FADE, 0.0, 1.0);
    float top = clamp((1.0 - height / column.top) / TOP_FADE, 0.0, 1.0);
    return column.strength * base * sqrt(top);
}

float cloud_noise(sampler3D volume, vec2 origin, float period_m, vec2 level, float over_base_m,
                  float width_m) {
    vec2 at = origin + turned(level, NOISE_TURN_RAD) / period_m;
    float lod = log2(max(width_m * float(textureSize(volume, 0).x) / period_m, 1e-6));
    return textureLod(volume, vec3(at, over_base_m / period_m), lod).r;
}

// Density in [0, 1]: the noise cut by the envelope; where the detail cannot change it,
// it is not looked up.
float cloud_density(float envelope, vec2 level, float over_base_m, float width_m) {
    if (envelope <= 0.0) return 0.0;
    float kept = cloud_noise(cloud_shape, clouds.noise_origin.xy, SHAPE_PERIOD_M, level,
                             over_base_m, width_m) + envelope - 1.0;
    if (kept <= 0.0) return 0.0;
    if (kept < FRAYING + 1.0 / SHARPNESS)
        kept -= FRAYING * cloud_noise(cloud_detail, clouds.noise_origin.zw, DETAIL_PERIOD_M, level,
                                      over_base_m, width_m);
    return clamp(SHARPNESS * kept, 0.0, 1.0);
}

float cloud_density_at(vec2 level, float over_base_m, float width_m) {
    float height = over_base_m / clouds.thickness_m;
    if (height < 0.0 || height > 1.0) return 0.0;
    return cloud_density(cloud_envelope(cloud_column(level, width_m), height), level, over_base_m,
                         width_m);
}
