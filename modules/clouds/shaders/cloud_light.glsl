// Light from a point in a cloud towards the eye: the twin of model/cloud_march_kernels.py. Tables
// come from cloud_light_textures.glsl or cloud_buffers.glsl.

// Near depths come from the density itself, the volume is coarse: steps in free paths of full
// density, of at most LONGEST_UNIT of the thickness.
const float NEAR_STEPS[2] = float[](1.0, 2.0), LONGEST_UNIT = 0.05;
// Of the plane layer; of a direction's light, of the fluence; of the tables' light, of the whole.
const float LEAST_DEPTH = 0.02, LEAST_SHARE = 0.1, LEAST_DIFFUSE = 0.2, LEAST_LIGHT = 1e-6;
const float DARK = 40.0;  // half of the volume's greatest depth
const float MEAN_COSINE = 0.74;  // of the phase function after delta-M
const float SPHERE = 12.566371;
// As model/cloud_transport.py has its nodes.
const float DEPTH_SCALE = 0.3, MOST_DEPTH = 60.0, LOWEST_RAD = 0.04, HALF_PI = 1.5707963;
const float DEPTHS = 20.0, SINES = 12.0, VIEWS = 16.0;
// Sines of the sun's elevation that the table of sunlight spans.
const float LOWEST_SUN = -0.1;

struct CloudRay {
    vec3 d;
    float nu;     // cosine of the angle to the sun
    vec3 wide;    // phase function of the droplets, over the share that diffuses
    vec3 peak;    // its forward peak
    float log_twice;  // logarithm of the phase function of light scattered twice
};

CloudRay cloud_ray(vec3 d) {
    vec3 chord = d - clouds.sun_direction;
    float squared = dot(chord, chord);
    float node = min(0.5 * sqrt(squared), 1.0) * (phase_angles() - 1.0);
    vec3 wide = phase_nodes(node, 0), peak = phase_nodes(node, 1);
    float log_twice = phase_nodes(node, 2).r;
    return CloudRay(d, 1.0 - 0.5 * squared, wide / clouds.diffused, peak / clouds.diffused,
                    log_twice);
}

vec2 depth_nodes(vec2 scaled) {
    float of_log = (DEPTHS - 1.0) / log(1.0 + MOST_DEPTH / DEPTH_SCALE);
    return min(log(1.0 + scaled / DEPTH_SCALE) * of_log, DEPTHS - 1.0);
}

vec4 transport_at(float sine_node, vec2 above_below, float mu) {
    vec2 depths = depth_nodes(above_below);
    float view = (asin(clamp(mu, -1.0, 1.0)) / HALF_PI * 0.5 + 0.5) * (VIEWS - 1.0);
    return transport_nodes(vec3(view, depths.x, sine_node * DEPTHS + depths.y));
}

// Of a sun of irradiance 1, sr^-1; `sine` and `mu` are cosines to the slab's normal.
float sun_source(vec2 above_below, float sine, float mu, CloudRay ray) {
    float over = (asin(clamp(sine, 0.0, 1.0)) - LOWEST_RAD) / (HALF_PI - LOWEST_RAD);
    float node = sqrt(max(over, 0.0)) * (SINES - 1.0), low = min(floor(node), SINES - 2.0);
    vec4 logs = mix(transport_at(low, above_below, mu), transport_at(low + 1.0, above_below, mu),
                    node - low);
    float level = sqrt(max((1.0 - mu * mu) * (1.0 - sine * sine), 1e-6));
    float wave = clamp((ray.nu - mu * sine) / level, -1.0, 1.0);
    return exp(logs.x + logs.y * wave + logs.z * (2.0 * wave * wave - 1.0)
               + logs.w * ray.log_twice);
}

vec3 in_volume(vec2 level, float height) {
    vec2 grid = level + clouds.shadow_origin_m;
    vec2 place = grid / (clouds.volume_near_m + clouds.volume_growth * abs(grid));
    float edges = volume_edges();
    float edge = clamp(height, 0.0, 1.0) * (edges - 1.0) + 0.5;
    return vec3(0.5 * place + 0.5, edge / edges);
}

// Share of the sun that is scattered above a place, and depths to the sun and up: lines within
// each cell of the grid, as what the grid holds is.
vec3 in_grid(vec2 level, float height) {
    float cells = volume_edges() - 1.0;
    float place = clamp(height, 0.0, 1.0) * cells, under = min(floor(place), cells - 1.0);
    vec2 low = depths_at(in_volume(level, under / cells)).rg;
    vec2 high = depths_at(in_volume(level, (under + 1.0) / cells)).rg;
    float share = place - under;
    float lit = mix(exp(-clouds.diffused * low.r), exp(-clouds.diffused * high.r), share);
    return vec3(1.0 - lit, mix(low, high, share));
}

// Fluence and downward flux in a plane layer between scaled depths, of which a share `there` of
// the sun is scattered above: model/cloud_diffusion.py.
vec2 plane_light(vec2 above_below, float there, float facing) {
    float hinders = 3.0 * (1.0 - MEAN_COSINE), whole = above_below.x + above_below.y;
    float gone = 1.0 - exp(-whole / facing);
    float at_top = facing * ((3.0 * facing - 2.0) * gone - hinders * whole)
                 / (4.0 + hinders * whole);
    return vec2(3.0 * facing * facing * there - 2.0 * at_top
                - hinders * (at_top + facing) * above_below.x, at_top + facing * there);
}

// The sun sinks and rises with the way along the planet.
vec3 sun_at(float sine, float height) {
    float row = sqrt(clamp((sine - LOWEST_SUN) / (1.0 - LOWEST_SUN), 0.0, 1.0));
    return sun_nodes(row, height);
}

// Radiance per diffused optical depth, W m^-2 sr^-1.
vec3 cloud_source(CloudRay ray, float at_m, vec2 level, float over_base_m, float width_m) {
    vec3 sun = clouds.sun_direction;
    float unit_m = min(1.0 / (clouds.diffused * clouds.extinction_per_m),
                       LONGEST_UNIT * clouds.thickness_m);
    float reach_m = 0.0, near = 0.0;
    for (int i = 0; i < NEAR_STEPS.length(); ++i) {
        float step_m = NEAR_STEPS[i] * unit_m, at = reach_m + 0.5 * step_m;
        near += step_m * cloud_density_at(level + sun.xz * at, over_base_m + sun.y * at,
                                          max(width_m, 0.5 * step_m));
        reach_m += step_m;
    }
    near *= clouds.extinction_per_m;
    vec3 depths = depths_at(in_volume(level + sun.xz * reach_m,
                                      (over_base_m + sun.y * reach_m) / clouds.thickness_m));
    float to_sun = near + depths.r, upright = depths.g + depths.b;
    float sine = sun.y + dot(level, sun.xz) / PLANET_RADIUS_M;
    float rise = ray.d.y + at_m / PLANET_RADIUS_M;
    // Light in the plane layer that is as deep, with as much before the sun as here, by the
    // tables; how much more or less of it there is than in that layer, by diffusion.
    float low = clamp(sine, clouds.sun_slope, 1.0);
    float over = clamp(depths.g + near * max(sun.y, 0.0), 0.0, upright);
    // Where no sun is left the volume does not count on.
    float counts = clamp(2.0 - clouds.diffused * to_sun / DARK, 0.0, 1.0);
    float above = mix(over, to_sun * low, counts);
    vec2 slab = clouds.diffused * vec2(above, max(upright - above, 0.0));
    float height = over_base_m / clouds.thickness_m;
    vec3 grid = in_grid(level, height);
    above = mix(grid.z, grid.y * low, counts);
    vec2 coarse = clouds.diffused * vec2(above, upright - above);
    vec2 level_flux = plane_light(max(coarse, LEAST_DEPTH), grid.x, low);
    vec4 light = diffuse_at(in_volume(level, height));
    float along = -dot(light.gba, vec3(ray.d.x, rise, ray.d.z));
    float here = max(light.r + 3.0 * MEAN_COSINE * along, LEAST_SHARE * light.r);
    float plane = max(level_flux.x + 3.0 * MEAN_COSINE * level_flux.y * rise,
                      LEAST_SHARE * level_flux.x);
    // Directions that diffusion has not are the plane layer's, as far as the light is like its.
    float alike = max(min(light.r, level_flux.x) / max(max(light.r, level_flux.x), LEAST_LIGHT),
                      0.0);
    float diffuse = max(alike * sun_source(slab, low, rise, ray) + (here - alike * plane) / SPHERE,
                        LEAST_DIFFUSE * here / SPHERE);
    float even = transport_at(SINES, clouds.diffused * vec2(over, upright - over), rise).r;
    vec3 scattered = ray.wide * exp(-clouds.diffused * to_sun) + ray.peak * exp(-to_sun) + diffuse;
    return sun_at(sine, height) * scattered
         + mix(clouds.light_from_below, clouds.light_from_above, even);
}
