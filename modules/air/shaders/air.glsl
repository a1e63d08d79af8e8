// Transmittance and radiance of the air between the eye and a point; the float32 twin of
// vrut_lite/sky/air_volume.py, which defines where the tables' nodes lie.

//!include air_block.glsl
// Shaded, direct, aerosol: slice on slice; then those of a second body.
//!sampler sampler3D air_radiance
// Its logarithm; rows by slices.
//!sampler sampler2D air_extinction
// Of aerosol, by the sine of half the angle.
//!sampler sampler2D air_phase

const float MISSES_AIR = 1e30;
const float AIR_PI = 3.14159265;

// A ray as seen from the sun or the moon, whose light the air scatters.
struct AirBody {
    float column;
    float phase;    // of molecules, sr^-1
    vec3 aerosol;   // that of aerosol
};

struct AirRay {
    float row;
    AirBody key;
#ifdef SECOND_LIGHT
    AirBody second;
#endif
    float entry_m;  // distance from the eye to the air
    float span_m;   // length of the ray that the slices cover
};

struct AirLight {
    vec3 transmittance;
    vec3 shaded;
    vec3 sunlit;    // sunlight scattered once, which shadows remove
};

// Distance from the eye to where the ray enters the air, and radius times mu there.
vec2 air_entry(vec3 d) {
    if (air.above_top_m <= 0.0) return vec2(0.0, air.observer_radius_m * d.y);
    float perigee_m = air.observer_radius_m * length(d.xz);
    float squared = (air.top_radius_m - perigee_m) * (air.top_radius_m + perigee_m);
    if (d.y >= 0.0 || squared <= 0.0) return vec2(MISSES_AIR, 0.0);
    float half_chord = sqrt(squared);
    return vec2(air.above_top_m * (air.observer_radius_m + air.top_radius_m)
                / (half_chord - air.observer_radius_m * d.y), -half_chord);
}

float air_span_m(float along, bool below) {
    float span = 0.0;
    if (below) {
        float root = sqrt(max(along * along - air.tangent_below_m2, 0.0));
        span = air.tangent_below_m2 / max(root - along, 1e-30);
    } else {
        float root = sqrt(along * along + air.tangent_above_m2);
        span = along > 0.0 ? air.tangent_above_m2 / (root + along) : root - along;
    }
    return clamp(span, air.shortest_span_m, air.reach_m);
}

// Row coordinate below the horizon; `down` is 0 at the horizon, 1 at the nadir, linear in mu.
float row_below(float down) {
    float c = air.rows_down.x, moved_x = air.rows_down.y, moved_place = air.rows_down.z;
    float x = sqrt(down / (c + (1.0 - c) * down));
    return x < moved_x ? x * moved_place / moved_x
        : 1.0 - (1.0 - x) * (1.0 - moved_place) / (1.0 - moved_x);
}

AirBody air_body(vec3 d, vec3 direction, vec2 body_azimuth) {
    float level = length(d.xz);
    vec2 azimuth = level > 1e-12 ? d.xz / level : vec2(0.0, -1.0);
    float column = min(0.5 * distance(azimuth, body_azimuth), 1.0) * (air.columns - 1.0);
    // 1 - nu as half the squared chord keeps its precision beside the body.
    vec3 chord = d - direction;
    float squared = dot(chord, chord), nu = 1.0 - 0.5 * squared;
    float phase = 3.0 / (16.0 * AIR_PI) * (1.0 + nu * nu);
    float angles = float(textureSize(air_phase, 0).x);
    float place = min(0.5 * sqrt(squared), 1.0) * (angles - 1.0) + 0.5;
    return AirBody(column, phase, textureLod(air_phase, vec2(place / angles, 0.5), 0.0).rgb);
}

AirRay air_ray(vec3 d) {
    // 1 + mu without cancellation near the nadir: a distant observer sees the planet only there.
    float one_plus = d.y < 0.0 ? dot(d.xz, d.xz) / (1.0 - d.y) : 1.0 + d.y;
    float above = one_plus - air.horizon_depth;
    // Rows above and below the horizon are separate blocks; filtering must not mix them.
    float squared = clamp(above / air.depth_above_horizon, 0.0, 1.0);
    if (air.above_top_m <= 0.0) squared /= 1.0 + sqrt(1.0 - squared);
    float row = above >= 0.0
        ? sqrt(squared) * (air.rows_above - 1.0)
        : air.rows_above + row_below(min(-above / air.horizon_depth, 1.0)) * (air.rows_below - 1.0);
    vec2 entry = air_entry(d);
    AirBody key = air_body(d, air.sun_direction, air.sun_azimuth);
    float span_m = air_span_m(entry.y, above < 0.0);
#ifdef SECOND_LIGHT
    return AirRay(row, key, air_body(d, air.second_direction, air.second_azimuth), entry.x, span_m);
#else
    return AirRay(row, key, entry.x, span_m);
#endif
}

// 1 - exp(-x) that keeps its relative precision for thin air.
vec3 absorbed(vec3 x) {
    return mix(1.0 - exp(-x), x * (1.0 - x * (0.5 - x / 6.0)), lessThan(x, vec3(0.02)));
}

// Nodes are at the middles of texels.
vec3 air_part(float part, float slice, float row, float column) {
    vec3 node = vec3(column, row, part * air.slices + slice);
    return textureLod(air_radiance, (node + 0.5) / vec3(textureSize(air_radiance, 0)), 0.0).rgb;
}

float metres_in_air(AirRay ray, float metres) {
    return clamp(metres - ray.entry_m, 0.0, ray.span_m);
}

float slice_at(AirRay ray, float inside_m) {
    float share = inside_m / ray.span_m, even = air.evenness;
    float root = sqrt(max(even * even + (1.0 - 2.0 * even) * share, 0.0));
    return clamp(share / max(even + root, 1e-30), 0.0, 1.0) * (air.slices - 1.0);
}

vec3 optical_depth_of(AirRay ray, float inside_m) {
    vec2 node = vec2(ray.row, slice_at(ray, inside_m));
    vec2 at = (node + 0.5) / vec2(textureSize(air_extinction, 0));
    return exp(textureLod(air_extinction, at, 0.0).rgb) * inside_m;
}

vec3 once_mean(AirBody body, float first, float slice, float row) {
    return air_part(first + 1.0, slice, row, body.column) * body.phase
        + air_part(first + 2.0, slice, row, body.column) * body.aerosol;
}

vec3 sunlit_mean(AirRay ray, float slice) {
    return once_mean(ray.key, 0.0, slice, ray.row);
}

// What stays in the scene's shadow: light scattered again, and all of the second body's.
vec3 shaded_mean(AirRay ray, float slice) {
    vec3 light = air_part(0.0, slice, ray.row, ray.key.column);
#ifdef SECOND_LIGHT
    light += air_part(3.0, slice, ray.row, ray.second.column)
        + once_mean(ray.second, 3.0, slice, ray.row);
#endif
    return light;
}

vec3 sunlit_before(AirRay ray, float metres) {
    float inside_m = metres_in_air(ray, metres);
    vec3 weight = absorbed(optical_depth_of(ray, inside_m)) * air.radiance_scale;
    return weight * sunlit_mean(ray, slice_at(ray, inside_m));
}

AirLight air_before(AirRay ray, float metres) {
    float inside_m = metres_in_air(ray, metres);
    vec3 optical_depth = optical_depth_of(ray, inside_m);
    vec3 weight = absorbed(optical_depth) * air.radiance_scale;
    float slice = slice_at(ray, inside_m);
    return AirLight(exp(-optical_depth), weight * shaded_mean(ray, slice),
                    weight * sunlit_mean(ray, slice));
}

#if defined(LIGHT_SHAFTS) || defined(SHADED_GLOW)
//!include light_shafts.glsl
#endif

// Radiance at the eye of a surface at distance `metres` in the unit direction d. The air between gets
// this share of the light in open air; light shafts know by themselves where the sun is.
vec3 through_air(vec3 radiance, vec3 d, float metres, float share) {
    AirRay ray = air_ray(d);
    AirLight light = air_before(ray, metres);
#ifdef LIGHT_SHAFTS
    light.sunlit = max(light.sunlit - shadowed_light(ray, d, metres), 0.0);
#else
#ifdef SHADED_GLOW
    float glow = smoothstep(air.glow_cosines.x, air.glow_cosines.y, dot(d, air.sun_direction));
    if (glow > 0.0) light.sunlit = max(light.sunlit - glow * shaded_by_scene(ray, d, metres), 0.0);
#endif
    light.sunlit *= share;
#endif
    return radiance * light.transmittance + light.shaded * share + light.sunlit;
}

// Distance to the spherical ground behind the scene; above its horizon, distance to the horizon.
float ground_distance_m(vec3 d) {
    float radius_m = air.ground_radius_m + air.above_ground_m;
    float down = -radius_m * d.y, perigee_m = radius_m * length(d.xz);
    float tangent = air.above_ground_m * (radius_m + air.ground_radius_m);
    // Two equal forms; each branch uses the one with less cancellation.
    float squared = d.y > -0.7 ? down * down - tangent
        : (air.ground_radius_m - perigee_m) * (air.ground_radius_m + perigee_m);
    return tangent / max(down + sqrt(max(squared, 0.0)), 1e-6);
}

// Sine of the elevation that divides the sky from the ground behind the scene.
float ground_horizon() {
    return air.horizon_height;
}

// Adds the air before the ground of a background (`lower`), unless the background includes it.
void background_through_air(vec3 d, inout vec3 lower, inout vec3 upper) {
    float ground_m = ground_distance_m(d);
#ifdef SUN_FACTOR
    if (air.ground_is_bare > 0.5) lower *= ground_factor(d * ground_m);
#endif
    if (air.ground_is_bare > 0.5) lower = through_air(lower, d, ground_m, 1.0);
#ifdef LIGHT_SHAFTS
    // A background that includes its air still contains light that the scene shades: remove it.
    AirRay shaded = air_ray(d);
    upper = max(upper - shadowed_light(shaded, d, MISSES_AIR), 0.0);
    if (air.ground_is_bare < 0.5)
        lower = max(lower - shadowed_light(shaded, d, ground_m), 0.0);
#endif
}
