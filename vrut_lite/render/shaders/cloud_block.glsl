// The clouds of a frame, as render/clouds.py packs them. Positions count from the eye; "level" is
// world x and z.

layout(std140, binding = 1) uniform Clouds {
    vec3 sun_direction;
    float eye_radius_m;           // from the planet's middle
    float base_m;
    float thickness_m;
    float extinction_per_m;
    float threshold;
    vec4 weather_origin;          // the eye in the two views of the weather, in periods
    vec4 noise_origin;            // the eye in shape and detail
    vec3 phase;                   // g forward, g backward, share of the first
    float pixel_rad;
    float top_squares_m2;         // squared radius less the eye's, of the layer's top,
    float base_squares_m2;        // of its base
    float ground_squares_m2;      // and of the ground
    float eye_altitude_m;
    vec3 light_from_above;        // mean radiance of the upper hemisphere
    float scattered_share;        // of light from above that reaches the ground through clouds
    vec3 light_from_below;
    float covered_share;
    vec2 shadow_origin_m;         // the eye on the shadow map's plane
    float shadow_near_m;          // how far from the middle texels begin to grow
    float shadow_growth;
    vec3 ground_by_sun;           // shares of the light of open, level ground: what the sun
    float sun_slope;              // least sine of the sun's height that shadows are cast by
    vec3 ground_by_sky;           // gives in a gap, and what sky and clouds give
    float shadow_texels;          // along a side of the map
} clouds;
