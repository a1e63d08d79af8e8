// The sun behind the clouds. The map holds the layer's optical depth along the sun for places at
// its base; texels grow away from the middle.

//!include cloud_block.glsl
//!sampler sampler2D cloud_shadow_map

const float CLOUD_PLANET_RADIUS_M = 6.36e6;

// Where rays to the sun that pass a point, from the eye, meet the base; and the point's height
// over it.
vec3 shadow_place(vec3 from_eye) {
    float over_base_m = clouds.eye_altitude_m - clouds.base_m + from_eye.y
                      + dot(from_eye.xz, from_eye.xz) / (2.0 * CLOUD_PLANET_RADIUS_M);
    float sine = max(clouds.sun_direction.y, clouds.sun_slope);
    vec2 level = from_eye.xz - clouds.sun_direction.xz * (over_base_m / sine);
    return vec3(level, over_base_m);
}

// Share of the sun that the clouds let through to a point, from the eye. A point in the layer has
// its share of the layer above it.
float sun_factor(vec3 from_eye) {
    vec3 place = shadow_place(from_eye);
    float share = clamp(1.0 - place.z / clouds.thickness_m, 0.0, 1.0);
    vec2 on_map = place.xy + clouds.shadow_origin_m;
    vec2 at = on_map / (clouds.shadow_near_m + clouds.shadow_growth * abs(on_map));
    float depth = textureLod(cloud_shadow_map, at * 0.5 + 0.5, 0.0).r;
    // Past the map's border, the mean.
    float inside = clamp(20.0 * (1.0 - max(abs(at.x), abs(at.y))), 0.0, 1.0);
    float mean = 1.0 - clouds.covered_share * min(share * 20.0, 1.0);
    return mix(mean, exp(-depth * share), inside);
}

// Share of the ground's radiance under an open sky that remains under the clouds.
vec3 ground_factor(vec3 from_eye) {
    return clouds.ground_by_sun * sun_factor(from_eye) + clouds.ground_by_sky;
}

// Distance along a ray from which on nothing is shaded: above the layer.
float sun_factor_end_m(vec3 d, float metres) {
    float top_m = clouds.base_m + clouds.thickness_m - clouds.eye_altitude_m;
    return d.y > 0.0 && top_m > 0.0 ? min(metres, top_m / max(d.y, 1e-4)) : metres;
}
