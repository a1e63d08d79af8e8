// Density of clouds: the twin of model/cloud_density.py, which explains it, and within the width
// of a sample of model/cloud_density_kernels.py. Noises come from cloud_textures.glsl or
// cloud_buffers.glsl.

const float PLANET_RADIUS_M = 6.36e6;
const float WEATHER_TURN_RAD = 0.65;
const float NOISE_TURN_RAD = 0.3;
const float WARP = 0.3, WEATHER_WARP = 0.216;
const vec2 WARP_WAVES = vec2(0.306, 0.414);
const mat2 WEATHER_WAVES = mat2(0.184, 0.205, -0.214, 0.411);
const float ANVIL_ROOT = 0.5, ANVIL_FROM = 0.5, ANVIL_RISE = 0.4, ANVIL_FADE = 0.12;

// Nearly a sine, of period 1: parabolas.
vec2 wave(vec2 at) {
    vec2 place = at - floor(at + 0.5);
    return 8.0 * place * (1.0 - 2.0 * abs(place));
}

vec2 turned(vec2 p, float angle) {
    float c = cos(angle), s = sin(angle);
    return vec2(c * p.x - s * p.y, s * p.x + c * p.y);
}

const float NARROWEST = 1e-3;

// Clouds over a sample's width, from the least weather in it to the most, in even steps: how far a
// place lies within a cloud's side, and the cloud's top, as a share of the layer's thickness.
struct Column {
    vec4 side;
    vec4 top;
    float noise_range;  // half of it, within the sample
};

Column cloud_column(vec2 level, float width_m) {
    float log_width = log2(max(width_m, 1.0));
    vec2 texels_m = clouds.weather_periods_m / weather_edge();
    vec2 lod = max(log_width - log2(texels_m), 0.0);
    vec2 along = clouds.warp_origin.zw + level * WEATHER_WAVES / clouds.weather_periods_m.x;
    vec2 waves = WEATHER_WARP * wave(along);
    vec2 first = clouds.weather_origin.xy + level / clouds.weather_periods_m.x + waves;
    vec2 second = clouds.weather_origin.zw
                + turned(level, WEATHER_TURN_RAD) / clouds.weather_periods_m.y + waves;
    float weather = mix(weather_at(first, lod.x),
                        weather_at(second, lod.y), clouds.second_share);
    vec2 narrow = exp2(clouds.spread_power * (clouds.spread_log_half - log_width));
    vec2 ranges = clouds.spread_most / (1.0 + narrow);
    vec4 above = weather - clouds.threshold + weather_steps(ranges.x);
    vec4 growth = clamp(above / clouds.growth, 0.0, 1.0);
    return Column(above / clouds.side_fade,
                  clouds.least_height + (1.0 - clouds.least_height) * growth * (2.0 - growth),
                  ranges.y);
}

// `height`: over the base, as a share of the layer's thickness.
vec4 cloud_envelope(Column column, float height) {
    float base = clamp(height / clouds.base_fade, 0.0, 1.0);
    vec4 top = clamp((1.0 - height / column.top) / clouds.top_fade, 0.0, 1.0);
    vec4 cloud = clamp(column.side, 0.0, 1.0) * base * sqrt(top);
    if (clouds.anvil == 0.0 || height <= ANVIL_FROM) return cloud;
    float rise = min((height - ANVIL_FROM) / ANVIL_RISE, 1.0);
    float within = clamp(min(height - ANVIL_FROM, 1.0 - height) / ANVIL_FADE, 0.0, 1.0);
    float reach = (clouds.anvil + ANVIL_ROOT) * rise * rise - ANVIL_ROOT;
    return max(cloud, clamp(column.side + reach, 0.0, 1.0) * within);
}

float noise_lod(float edge, float period_m, float width_m) {
    return log2(max(width_m * edge / period_m, 1e-6));
}

// Integral from 0 of a density that rises to 1 at x = 1.
vec3 filled(vec3 x) {
    vec3 part = clamp(x, 0.0, 1.0);
    return 0.5 * part * part + max(x - 1.0, 0.0);
}

// Mean density in [0, 1] of a sample, and the share of it that is cloud: the noise cut by the
// envelope. Where the detail cannot change it, it is not looked up.
vec2 cloud_density(vec4 envelope, float noise_range, vec2 level, float over_base_m,
                   float width_m) {
    if (envelope.w <= 0.0) return vec2(0.0);
    vec2 at_base = turned(level, NOISE_TURN_RAD) / vec2(clouds.stretch, 1.0);
    vec2 at = at_base - vec2(clouds.lean * over_base_m / clouds.stretch, 0.0);
    float period_m = clouds.noise_periods_m.x;
    vec2 waves = wave(clouds.warp_origin.xy + WARP_WAVES * at_base.yx / period_m);
    vec3 in_shape = vec3(clouds.noise_origin.xy + at / period_m + WARP * waves,
                         over_base_m / period_m);
    float kept = shape_at(in_shape, noise_lod(shape_edge(), period_m, width_m)) - 1.0;
    if (envelope.w + kept + noise_range <= 0.0) return vec2(0.0);
    if (envelope.x + kept - noise_range < clouds.fraying + 1.0 / clouds.sharpness) {
        period_m = clouds.noise_periods_m.y;
        vec3 in_detail = vec3(clouds.noise_origin.zw + at / period_m, over_base_m / period_m);
        float lod = noise_lod(detail_edge(), period_m, width_m);
        kept -= clouds.fraying * detail_at(in_detail, lod);
    }
    vec3 middle = 0.5 * (envelope.xyz + envelope.yzw) + kept, rise = envelope.yzw - envelope.xyz;
    vec3 half_range = max(sqrt(0.25 * rise * rise + noise_range * noise_range), NARROWEST);
    vec3 most = middle + half_range, least = middle - half_range;
    vec3 counts = vec3(greaterThan(envelope.yzw, vec3(0.0))) / (6.0 * half_range);
    vec3 full = filled(clouds.sharpness * most) - filled(clouds.sharpness * least);
    return vec2(dot(counts / clouds.sharpness, full),
                min(dot(counts, clamp(most, vec3(0.0), 2.0 * half_range)), 1.0));
}

// Mean density over a width.
float cloud_density_at(vec2 level, float over_base_m, float width_m) {
    float height = over_base_m / clouds.thickness_m;
    if (height < 0.0 || height > 1.0) return 0.0;
    Column column = cloud_column(level, width_m);
    return cloud_density(cloud_envelope(column, height), column.noise_range, level, over_base_m,
                         width_m).x;
}
