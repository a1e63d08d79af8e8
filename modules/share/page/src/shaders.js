// Programs of the page, GLSL ES 3.00. Radiance is linear sRGB in W m^-2 sr^-1 times `pre`, which
// keeps it within half floats; terms are those of vrut_lite/render/shaders/mesh.frag.
import * as THREE from 'three';

const VERSION = { glslVersion: THREE.GLSL3 };

// Of linear sRGB's luminance.
const WEIGHTS = 'const vec3 WEIGHTS = vec3(0.2126390058715104, 0.7151686787677559, 0.07219231536073371);\n';

export const FULL_SCREEN = `
in vec3 position;
out vec2 at;
void main() { at = 0.5 + 0.5 * position.xy; gl_Position = vec4(position.xy, 0.0, 1.0); }`;

const HEAD = 'precision highp float;\nprecision highp sampler2DArray;\nprecision highp sampler2DShadow;\n';

export const LIGHT_FRAGMENT = `${HEAD}
uniform sampler2DArray basis;     // planes, four a layer: factor, cluster, sky's share, its components, terms
uniform sampler2D coefficients;   // of terms, a row a cluster
uniform float share_weights[COMPONENTS];
out vec4 light;
void main() {
    ivec2 p = ivec2(gl_FragCoord.xy);
    vec4 four = 255.0 * texelFetch(basis, ivec3(p, 0), 0);
    light = vec4(0.0);
    if (four.x < 0.5) return;
    float mean_share = four.z * four.z / (255.0 * 255.0), ratio = 1.0;
    float factor = exp2((floor(four.x + 0.5) - 255.0) / CODES);
    int cluster = int(four.y + 0.5);
    vec3 sum = vec3(0.0);
    for (int k = -COMPONENTS; k < TERMS; ++k) {
        int plane = k + COMPONENTS + 3, number = plane & 3;
        if (number == 0) four = 255.0 * texelFetch(basis, ivec3(p, plane >> 2), 0);
        float code = (number == 0 ? four.x : number == 1 ? four.y : number == 2 ? four.z : four.w);
        float share = (floor(code + 0.5) - 128.0) / 127.0;
        float value = sign(share) * pow(abs(share), POWER);
        if (k < 0) ratio += value * share_weights[k + COMPONENTS];
        else sum += value * texelFetch(coefficients, ivec2(k, cluster), 0).rgb;
    }
    light.a = mean_share * max(ratio, 0.0);
    light.rgb = max(sum * factor, 0.0);
}`;

// The sky of two bodies and of the night; share/sky_table.py has the table's layout.
export const SKY = `
const float PI = 3.141592653589793;
${WEIGHTS}struct Body { vec3 light; vec2 azimuth; float height; float layer; float share; };
uniform Body bodies[2];
uniform sampler2DArray sky_table;
uniform sampler2D glow_map;
uniform float glow;               // factor on the map's values
uniform vec3 below_horizon;       // radiance of open ground
// Column and row of a direction, at least on the horizon.
vec2 table_node(Body body, vec3 d) {
    float height = asin(clamp(d.y, 0.0, 1.0));
    float cosine = dot(d.xz, body.azimuth) / max(length(d.xz), 1e-6);
    // acos beside 1 loses the glow's middle; the chord keeps it.
    float chord = length(d.xz / max(length(d.xz), 1e-6) - body.azimuth);
    float angle = cosine > 0.5 ? 2.0 * asin(min(0.5 * chord, 1.0)) : acos(clamp(cosine, -1.0, 1.0));
    float column = sqrt(angle / PI) * (COLUMNS - 1.0);
    float row = height < body.height
        ? acos(1.0 - 2.0 * clamp(height / body.height, 0.0, 1.0)) / PI * (LOWER - 1.0)
        : LOWER + sqrt(clamp((height - body.height) / max(0.5 * PI - body.height, 1e-6), 0.0, 1.0))
            * (ROWS - LOWER - 1.0);
    return vec2(column, row);
}
vec3 sky_of(Body body, vec3 d) {
    vec2 uv = (table_node(body, d) + 0.5) / vec2(COLUMNS, ROWS);
    vec3 low = textureLod(sky_table, vec3(uv, body.layer), 0.0).rgb;
    vec3 high = textureLod(sky_table, vec3(uv, body.layer + 1.0), 0.0).rgb;
    return body.light * mix(low, high, body.share);
}
vec3 sky_radiance(vec3 d) {
    vec3 sum = vec3(0.0);
    for (int k = 0; k < 2; ++k)
        if (bodies[k].light.g > 0.0) sum += sky_of(bodies[k], d);
    if (glow > 0.0) {
        vec2 uv = vec2(atan(d.x, -d.z) / (2.0 * PI), asin(clamp(d.y, 0.0, 1.0)) / (0.5 * PI));
        sum += glow * textureLod(glow_map, uv, 0.0).rgb;
    }
    return sum;
}
// Mean radiance of the air before near surfaces and its share of sunlight scattered once, by
// share/air_table.py's layout.
uniform sampler2DArray air_table;
vec4 air_of(Body body, vec3 d) {
    vec2 node = table_node(body, d);
    node.y = d.y < 0.0 ? (BELOW - 1.0) * (1.0 - sqrt(asin(min(-d.y, 1.0)) / (0.5 * PI))) : BELOW + node.y;
    vec2 uv = (node + 0.5) / vec2(COLUMNS, BELOW + ROWS);
    vec4 low = textureLod(air_table, vec3(uv, body.layer), 0.0);
    vec4 high = textureLod(air_table, vec3(uv, body.layer + 1.0), 0.0);
    return vec4(body.light, 1.0) * mix(low, high, body.share);
}
uniform samplerCube near_air;     // that of the hour, and the share of the key light's own
uniform sampler2D optical_depth;  // along the scene's size, by the height of the view
uniform float scene_m, air_scale;
// Towards the sky a little above the horizon, in the same azimuth: air that no surface ends is as
// bright.
vec3 horizon(vec3 d) {
    float level = length(d.xz);
    return level > 1e-4 ? vec3(d.x, 0.05 * level, d.z) / level : vec3(0.0, 0.05, -1.0);
}
vec3 far_air(vec3 d);
// The air's light arrives by this share; this share of the key light's own is shaded.
vec3 through_air(vec3 radiance, vec3 d, float metres, float lit, float shaded) {
    float height = asin(clamp(d.y, -1.0, 1.0)) / (0.5 * PI), views = float(textureSize(optical_depth, 0).x);
    float at = 0.5 + 0.5 * sign(height) * sqrt(abs(height));
    vec3 depth = textureLod(optical_depth, vec2((at * (views - 1.0) + 0.5) / views, 0.5), 0.0).rgb;
    vec4 about = textureLod(near_air, d, 0.0);
    vec3 left = exp(-depth * (metres / scene_m)), near = about.rgb * (air_scale * (1.0 - about.a * shaded));
    vec3 air = mix(near, far_air(d), smoothstep(2.0, 8.0, metres / scene_m));
    return radiance * left + air * (lit * (1.0 - left));
}`;

// Display by AgX: the twin of vrut_lite/pictures/tone_map.py and night_eye.py.
export const TONE = `
uniform mat3 from_radiance;       // exposure, and AgX's inset
uniform mat3 outset;
uniform vec2 stops;               // darkest, 1 / range
uniform float curve[7];
uniform float contrast;
uniform float saturation;
uniform float night_field;        // adaptation by CIE Y in W m^-2 sr^-1; 0 by day
uniform mat3 xyz_from_srgb;
uniform vec3 rods_grey;
uniform vec3 rods_blue;
uniform vec2 rods_range;          // alone, and cones alone, W m^-2 sr^-1
float dither(vec2 p) {
    float a = fract(52.9829189 * fract(dot(p, vec2(0.06711056, 0.00583715))));
    float b = fract(52.9829189 * fract(dot(p + 47.0, vec2(0.00583715, 0.06711056))));
    return (a + b - 1.0) / 255.0;
}
vec3 seen_by_eye(vec3 rgb) {
    if (night_field <= 0.0) return rgb;
    vec3 xyz = max(xyz_from_srgb * rgb, 1e-20);
    float scotopic = xyz.y * max(1.33 * (1.0 + (xyz.y + xyz.z) / xyz.x) - 1.68, 0.0);
    float adapted = log(max(xyz.y, night_field) / rods_range.x);
    float rods = 1.0 - clamp(adapted / log(rods_range.y / rods_range.x), 0.0, 1.0);
    return mix(rgb, scotopic * mix(rods_grey, rods_blue, rods), rods);
}
vec3 displayed(vec3 radiance) {
    vec3 x = from_radiance * seen_by_eye(radiance);
    x = clamp((log2(max(x, exp2(stops.x))) - stops.x) * stops.y, 0.0, 1.0);
    vec3 c = vec3(curve[6]);
    for (int k = 5; k >= 0; --k) c = c * x + curve[k];
    c = pow(max(c, 0.0), vec3(contrast));
    float grey = dot(c, WEIGHTS);
    return clamp(outset * (grey + saturation * (c - grey)), 0.0, 1.0);
}`;

const FINISH = `
uniform float pre;                // factor on radiance in the target
out vec4 colour;
vec4 finished(vec3 radiance, float alpha) {
    return vec4(min(radiance * pre, 6e4), alpha);
}`;

export const SKY_VERTEX = `
in vec3 position;
uniform mat4 world_from_clip;
out vec3 ray;
void main() {
    vec4 far = world_from_clip * vec4(position.xy, 1.0, 1.0);
    vec4 near = world_from_clip * vec4(position.xy, -1.0, 1.0);
    ray = far.xyz / far.w - near.xyz / near.w;
    gl_Position = vec4(position.xy, 1.0, 1.0);
}`;

export const SKY_FRAGMENT = `${HEAD}precision highp samplerCube;
${SKY}${TONE}${FINISH}
in vec3 ray;
vec3 far_air(vec3 d) { return sky_radiance(normalize(horizon(d))); }
uniform vec3 disc_direction;
uniform vec3 disc_radiance;       // mean
uniform float disc_radius;
uniform vec3 limb[6];
uniform float eye_height;
uniform float values_shown;
uniform vec3 to_sun;              // from the moon; 0: the disc is the sun's
uniform float moon_level;         // one over the mean of shade on the disc
// Light on the moon's disc, over its mean, by Lommel and Seeliger, as night_sky/shaders/moon.frag.
float phase_of(vec3 d) {
    vec3 right = normalize(cross(disc_direction, vec3(0.0, 1.0, 0.0)) + vec3(1e-6, 0.0, 0.0));
    vec3 upper = cross(right, disc_direction);
    vec2 p = vec2(dot(d, right), dot(d, upper)) / sin(disc_radius);
    float mu = sqrt(max(1.0 - dot(p, p), 0.0));
    float mu_sun = max(dot(p.x * right + p.y * upper - mu * disc_direction, to_sun), 0.0);
    return moon_level * mu_sun / max(mu_sun + mu, 1e-4);
}
vec3 disc(vec3 d) {
    float angle = asin(min(length(cross(d, disc_direction)), 1.0));
    if (dot(d, disc_direction) <= 0.0) return vec3(0.0);
    float edge = max(fwidth(angle), 1e-6);
    float covered = clamp((disc_radius - angle) / edge + 0.5, 0.0, 1.0);
    float c = sqrt(max(0.0, 1.0 - pow(min(angle / disc_radius, 1.0), 2.0)));
    vec3 dark = limb[5];
    for (int k = 4; k >= 0; --k) dark = dark * c + limb[k];
    float lit = dot(to_sun, to_sun) > 0.0 ? phase_of(d) : 1.0;
    return disc_radiance * max(dark, 0.0) * (covered * lit);
}
void main() {
    vec3 d = normalize(ray);
    if (values_shown > 0.0) { colour = vec4(-1.0); return; }
    float above = clamp(d.y / max(fwidth(d.y), 1e-7) + 0.5, 0.0, 1.0);
    vec3 upper = sky_radiance(d) + disc(d), lower = upper;
    if (above < 1.0)
        lower = through_air(below_horizon, d, max(eye_height, 0.1) / max(-d.y, 1e-5), 1.0, 0.0);
    colour = finished(mix(lower, upper, above), 1.0);
}`;

// One face of the cube in which surfaces mirror the sky, or with AIR of the air before them.
export const CUBE_FRAGMENT = `${HEAD}precision highp samplerCube;
${SKY}
vec3 far_air(vec3 d) { return vec3(0.0); }
in vec2 at;
out vec4 colour;
uniform int face, key_body;
uniform float cube_scale;
void main() {
    vec2 c = 2.0 * at - 1.0;
    vec3 d = face == 0 ? vec3(1.0, -c.y, -c.x) : face == 1 ? vec3(-1.0, -c.y, c.x)
        : face == 2 ? vec3(c.x, 1.0, c.y) : face == 3 ? vec3(c.x, -1.0, -c.y)
        : face == 4 ? vec3(c.x, -c.y, 1.0) : vec3(-c.x, -c.y, -1.0);
    d = normalize(d);
#ifdef AIR
    vec3 radiance = vec3(0.0);
    float sunlit = 0.0;
    for (int k = 0; k < 2; ++k) {
        if (!(bodies[k].light.g > 0.0)) continue;
        vec4 air = air_of(bodies[k], d);
        radiance += air.rgb;
        if (k == key_body) sunlit = dot(air.rgb, WEIGHTS) * air.a;
    }
    float share = sunlit / max(dot(radiance, WEIGHTS), 1e-30);
#else
    vec3 radiance = d.y > 0.0 ? sky_radiance(d) : below_horizon;
    const float share = 1.0;
#endif
    colour = vec4(min(radiance * cube_scale, 6e4), share);
}`;

// Where surfaces are, and the height of the normal of the side that is seen, plus 2.
export const PLACE_VERTEX = `
in vec3 position;
uniform mat4 modelMatrix, viewMatrix, projectionMatrix;
out vec3 world;
void main() {
    world = (modelMatrix * vec4(position, 1.0)).xyz;
    gl_Position = projectionMatrix * viewMatrix * vec4(world, 1.0);
}`;

export const PLACE_FRAGMENT = `${HEAD}
in vec3 world;
out vec4 place;
void main() {
    vec3 face = normalize(cross(dFdx(world), dFdy(world)));
    // Derivatives run rightwards and upwards in the picture: the normal points to the eye.
    place = vec4(world, face.y + 2.0);
}`;

// Marks that a headset shows: display values, whatever the exposure.
export const MARK_VERTEX = `
in vec3 position;
in vec2 uv;
uniform mat4 modelMatrix, viewMatrix, projectionMatrix;
out vec2 at;
void main() {
    at = uv;
    gl_Position = projectionMatrix * viewMatrix * modelMatrix * vec4(position, 1.0);
}`;

export const MARK_FRAGMENT = `${HEAD}
uniform sampler2D picture;
uniform vec3 tint;
in vec2 at;
out vec4 colour;
// Radiance in the target of what the tone curve shows as white.
const float SHOWN_WHITE = 2.0;
void main() { colour = vec4(pow(texture(picture, at).rgb * tint, vec3(2.2)) * SHOWN_WHITE, 1.0); }`;

// A star's light is spread over the pixels around it, none lost; night_sky/shaders/star.vert.
export const STAR_VERTEX = `precision highp float;
in vec3 position;                 // fixed on the sky
in vec3 light;                    // irradiance above the air
uniform mat3 world_from_sky;
uniform mat4 viewMatrix, projectionMatrix;
uniform vec2 jitter, size_px;
uniform vec3 extinction;
uniform float night, refraction;
flat out vec3 radiance;           // of all its light in one pixel
flat out vec2 at_px;
const float DEGREE = 0.017453292519943295, EDGE_PX = 7.0;
void main() {
    vec3 d = world_from_sky * position;
    float height = asin(clamp(d.y, -1.0, 1.0)), degrees = height / DEGREE, held = max(degrees, -1.0);
    // Refraction and air mass: sun.js and share/page_stars.py.
    float raised = max(1.02 / tan((held + 10.3 / (held + 5.11)) * DEGREE), 0.0) * refraction / 60.0
        * smoothstep(-6.0, -1.0, degrees);
    float apparent = degrees + raised, sine = sin(apparent * DEGREE);
    d = vec3(d.xz * (cos(apparent * DEGREE) / max(cos(height), 1e-6)), sine).xzy;
    vec3 left = exp(-extinction / (sine + 0.50572 * pow(max(apparent, 0.0) + 6.07995, -1.6364)));
    vec4 clip = projectionMatrix * mat4(mat3(viewMatrix)) * vec4(d, 0.0);
    float cosine = max(clip.w, 1e-3);
    float per_sr = 0.25 * size_px.x * size_px.y * projectionMatrix[0][0] * projectionMatrix[1][1];
    radiance = light * left * (night * per_sr / (cosine * cosine * cosine));
    gl_Position = apparent > 0.0 && clip.w > 0.0
        ? vec4(clip.xy + jitter * clip.w, clip.w, clip.w) : vec4(2.0, 2.0, 2.0, 1.0);
    at_px = (gl_Position.xy / gl_Position.w * 0.5 + 0.5) * size_px;
    gl_PointSize = EDGE_PX;
}`;

export const STAR_FRAGMENT = `${HEAD}
uniform float pre, values_shown;
flat in vec3 radiance;
flat in vec2 at_px;
out vec4 colour;
const float VARIANCE = 0.49;      // px^2
void main() {
    if (values_shown > 0.0) discard;
    vec2 away = gl_FragCoord.xy - at_px;
    float share = exp(-0.5 * dot(away, away) / VARIANCE) / (2.0 * 3.141592653589793 * VARIANCE);
    colour = vec4(min(radiance * (share * pre), 6e4), 0.0);
}`;

// Tiles with a number: alpha above 3.5 tells the tone pass of a share of the scale instead of radiance.
export const NUMBER_VERTEX = `
in vec3 position;
in float share;
uniform mat4 modelMatrix, viewMatrix, projectionMatrix;
uniform vec2 jitter;
out float at;
void main() {
    at = share;
    gl_Position = projectionMatrix * viewMatrix * modelMatrix * vec4(position, 1.0);
    gl_Position.xy += jitter * gl_Position.w;
    if (share < 0.0) gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
}`;

export const NUMBER_FRAGMENT = `${HEAD}
uniform float pre, neutral;
in float at;
out vec4 colour;
void main() { colour = vec4(vec3(neutral * pre), 4.0 + at); }`;

export const DEPTH_VERTEX = `
in vec3 position;
in vec2 uv;
uniform mat4 modelMatrix, clip_from_world;
out vec2 first_uv;
void main() {
    first_uv = uv;
    gl_Position = clip_from_world * modelMatrix * vec4(position, 1.0);
}`;

export const DEPTH_FRAGMENT = `${HEAD}
in vec2 first_uv;
#ifdef CUT_OUT
uniform sampler2D base_map;
uniform float alpha_cutoff;
uniform float base_alpha;
#endif
out vec4 colour;
void main() {
#ifdef CUT_OUT
    if (texture(base_map, first_uv).a * base_alpha < alpha_cutoff) discard;
#endif
    colour = vec4(1.0);
}`;

// What glass leaves of sunlight, multiplied into a white picture.
export const TINT_FRAGMENT = `${HEAD}
in vec2 first_uv;
uniform vec3 tint;
out vec4 colour;
void main() { colour = vec4(tint, 1.0); }`;

export const SURFACE_VERTEX = `
in vec3 position;
in vec3 normal;
in vec2 uv;
in vec2 uv1;
in vec2 light_px;
in vec4 color;
uniform mat4 modelMatrix, viewMatrix, projectionMatrix;
uniform vec2 jitter;              // of the picture in clip space
out vec3 world;
out vec3 smooth_normal;
out vec2 first_uv;
out vec2 second_uv;
out vec2 map_px;
out vec4 vertex_colour;
void main() {
    vec4 place = modelMatrix * vec4(position, 1.0);
    world = place.xyz;
    smooth_normal = normal;
    first_uv = uv;
    second_uv = uv1;
    map_px = light_px;
    vertex_colour = color;
    gl_Position = projectionMatrix * viewMatrix * place;
    gl_Position.xy += jitter * gl_Position.w;
}`;

export const SURFACE_FRAGMENT = `${HEAD}
precision highp samplerCube;
${SKY}${TONE}${FINISH}
in vec3 world;
in vec3 smooth_normal;
in vec2 first_uv;
in vec2 second_uv;
in vec2 map_px;
in vec4 vertex_colour;
uniform vec3 cameraPosition;
uniform vec4 base_factor;
uniform vec3 emission;
uniform float metallic_factor, roughness_factor, alpha_cutoff;
uniform vec3 dielectric_f0;
uniform float dielectric_f90, transmission_factor, unlit;
uniform sampler2D base_map, rough_map, normal_map, occlusion_map, emission_map;
uniform ivec4 layers;             // sets of coordinates: base, rough, normal, occlusion
uniform vec2 map_strength;        // of normal and occlusion
uniform sampler2D light_map, visible_sky, open_sky, reflectance;
uniform samplerCube mirrored_sky;
uniform float light_scale, open_scale, mirror_scale, mirror_levels;
uniform vec2 light_size;
uniform vec3 key_direction, key_irradiance;
uniform sampler2DShadow shadow_map;
uniform sampler2D glass_map;
uniform mat4 shadow_from_world;
uniform float shadow_texel_m, shadow_radius;
uniform float values_shown;       // factor on lux, which are shown in place of radiance; 0: radiance
const float LUMENS_PER_WATT = 683.0, SMALLEST_ALPHA = 0.005, TABLE_F0 = 0.04, FEWEST = 0.05;

vec2 uv_of(int layer) { return layer == 1 ? second_uv : first_uv; }

vec3 open_irradiance(vec3 n) {
    vec3 on = n / (abs(n.x) + abs(n.y) + abs(n.z));
    vec2 p = on.xz;
    if (n.y < 0.0) p = (1.0 - abs(p.yx)) * vec2(p.x < 0.0 ? -1.0 : 1.0, p.y < 0.0 ? -1.0 : 1.0);
    float nodes = float(textureSize(open_sky, 0).x);
    vec2 texel = (0.5 + 0.5 * p) * (nodes - 1.0);
    vec2 f = fract(texel);
    ivec2 i = min(ivec2(texel), int(nodes) - 2);
    f = texel - vec2(i);
    vec3 low = mix(texelFetch(open_sky, i, 0).rgb, texelFetch(open_sky, i + ivec2(1, 0), 0).rgb, f.x);
    vec3 high = mix(texelFetch(open_sky, i + ivec2(0, 1), 0).rgb,
                    texelFetch(open_sky, i + ivec2(1, 1), 0).rgb, f.x);
    return mix(low, high, f.y) * open_scale;
}
vec3 ratio(vec3 wanted, vec3 had, float most) {
    return clamp((wanted + 1e-20) / (had + 1e-20), 1.0 / most, most);
}
// Irradiance, and the share of the open sky's that arrives.
vec4 map_light(vec2 px) {
    return textureLod(light_map, px / light_size, 0.0) * vec4(vec3(light_scale), 1.0);
}
vec4 map_sky(vec2 px) { return textureLod(visible_sky, px / light_size, 0.0); }

#ifdef GROUND
uniform vec4 chart;               // first texel across and down, steps, half width in m
uniform vec3 chart_place;         // middle (x, z), warp
const float GROUND_FADE = 0.7;
void ground_light(out vec4 light, out vec4 sky) {
    light = vec4(open_irradiance(vec3(0.0, 1.0, 0.0)), 1.0);
    sky = vec4(0.0, 0.0, 0.0, 1.0);
#ifdef CHART
    vec2 reach = (world.xz - chart_place.xy) / chart.w, x = abs(reach) * sinh(chart_place.z);
    vec2 along = sign(reach) * log(x + sqrt(x * x + 1.0)) / chart_place.z;
    vec2 px = chart.xy + clamp(0.5 + 0.5 * along, 0.0, 1.0) * chart.z;
    float far = smoothstep(GROUND_FADE, 1.0, max(abs(reach.x), abs(reach.y)));
    light = mix(map_light(px), light, far);
    sky = mix(map_sky(px), sky, far);
#endif
}
#endif

#ifdef PROBES
uniform vec3 probe_lower, probe_per_m;
uniform ivec3 probe_counts;
uniform int probe_row;            // of the map at which they begin
vec4 probe(ivec3 at, int face) {
    int number = ((at.z * probe_counts.y + at.y) * probe_counts.x + at.x) * 6 + face;
    int width = int(light_size.x);
    return texelFetch(light_map, ivec2(number % width, probe_row + number / width), 0);
}
vec4 probe_light(vec3 n) {
    vec3 at = clamp((world - probe_lower) * probe_per_m + 0.5 * n, vec3(0.0),
                    vec3(probe_counts - 1));
    ivec3 first = min(ivec3(at), probe_counts - 2);
    vec3 t = at - vec3(first), weight = n * n;
    vec4 sum = vec4(0.0);
    for (int axis = 0; axis < 3; ++axis) {
        int face = 2 * axis + (n[axis] < 0.0 ? 1 : 0);
        for (int k = 0; k < 8; ++k) {
            ivec3 off = ivec3(k & 1, (k >> 1) & 1, k >> 2);
            vec3 w = mix(1.0 - t, t, vec3(off));
            sum += weight[axis] * w.x * w.y * w.z * probe(first + off, face);
        }
    }
    return sum * vec4(vec3(light_scale), 1.0);
}
#endif

// --- facets, as render/shaders/facets.glsl ---
vec3 shares(float mu, float roughness) {
    float last = float(textureSize(reflectance, 0).x - 1);
    vec2 p = vec2(sqrt(clamp(mu, 0.0, 1.0)), roughness) * last + 0.5;
    return texture(reflectance, p / (last + 1.0)).rgb;
}
vec3 specular_brdf(float nl, float nv, float nh, float vh, float alpha, vec3 f0, vec3 f90) {
    float a2 = alpha * alpha, d = nh * nh * (a2 - 1.0) + 1.0;
    float visibility = 0.5 / (nl * sqrt(nv * nv * (1.0 - a2) + a2)
                              + nv * sqrt(nl * nl * (1.0 - a2) + a2));
    return a2 / (PI * d * d) * visibility * (f0 + (f90 - f0) * pow(1.0 - vh, 5.0));
}
float coat(vec2 share, float f0, float f90) {
    return (f0 * share.x + f90 * share.y) * (1.0 + f0 * (1.0 / (share.x + share.y) - 1.0));
}
float peak(vec3 v) { return max(v.r, max(v.g, v.b)); }
vec3 grazing(vec3 f0) { return vec3(clamp(50.0 * peak(f0), 0.0, 1.0)); }
float before_terminator(float nl, float cos_face, float between) {
    float g = clamp(cos_face / max(nl * between, 1e-9), 0.0, 1.0);
    return g * (1.0 + g * (1.0 - g));
}
// The cube's levels halve its edge: a lobe of alpha spans about as many texels as its level's.
vec3 reflected_sky(vec3 d, float roughness) {
    float level = clamp(mirror_levels + log2(max(roughness * roughness, 1e-4)) + 0.3, 0.0, mirror_levels - 1.0);
#ifdef SMOOTH
    if (roughness < 0.15 && d.y > 0.0) return sky_radiance(d);
#endif
    return textureLod(mirrored_sky, d, level).rgb * mirror_scale;
}
#ifdef MIRROR
// --- images of the surroundings, as light_transport/drawing/shaders/mirror.glsl ---
uniform samplerCube mirror;          // radiance, and the share of surfaces
uniform samplerCube mirror_nearness; // one over distances, 1/m
uniform vec3 mirror_middle;
uniform float mirror_shown;
const int MIRROR_STEPS = 4;
const float MIRROR_FARTHEST = 4.0, MIRROR_NARROWEST = 0.35;
const float MIRROR_ASIDE[4] = float[4](-2.27, -0.52, 0.52, 2.27);
const vec2 MIRROR_FADES = vec2(0.4, 0.6);
vec4 mirrored_place(vec3 p, vec3 d) {
    float before = 0.0, behind = MIRROR_FARTHEST * scene_m;
    vec3 far = p + behind * d;
    float inside = length(p) * textureLod(mirror_nearness, p, 0.0).r - 1.0;
    float outside = length(far) * textureLod(mirror_nearness, far, 0.0).r - 1.0;
    if (outside <= 0.0) return vec4(d, 1.0);
    inside = min(inside, -1e-3);
    float t = 0.0;
    for (int i = 0; i <= MIRROR_STEPS; ++i) {
        t = mix(before, behind, clamp(inside / (inside - outside), 0.05, 0.95));
        if (i == MIRROR_STEPS) break;
        vec3 at = p + t * d;
        float past = length(at) * textureLod(mirror_nearness, at, 0.0).r - 1.0;
        if (past > 0.0) {
            behind = t; outside = past; inside *= 0.5;
        } else {
            before = t; inside = past; outside *= 0.5;
        }
    }
    return vec4(p + t * d, t);
}
vec4 mirror_image(vec3 d, vec3 n, float nv, float alpha) {
    vec4 place = mirrored_place(world - mirror_middle, d);
    float edge = float(textureSize(mirror, 0).x), away = place.w / length(place.xyz);
    vec3 right = dFdx(d), down = dFdy(d);
    float pixel = 0.25 * edge * sqrt(max(dot(right, right), dot(down, down)));
    float lobe = sqrt(6.0) * edge * alpha * away;
    vec3 along = n - dot(n, d) * d;
    along *= inversesqrt(max(dot(along, along), 1e-8)) * place.w * alpha;
    float level = log2(max(max(lobe * max(nv, MIRROR_NARROWEST), pixel), 1.0));
    vec4 seen = vec4(0.0);
    float all = 0.0;
    for (int i = 0; i < 4; ++i) {
        float there = dot(n, d) + MIRROR_ASIDE[i] * alpha > 0.0 ? 1.0 : 0.0;
        seen += there * textureLod(mirror, place.xyz + MIRROR_ASIDE[i] * along, level);
        all += there;
    }
    seen /= max(all, 1.0);
    return vec4(seen.rgb * mirror_scale, seen.a);
}
#endif
vec3 far_air(vec3 d) { return textureLod(mirrored_sky, horizon(d), 0.0).rgb * mirror_scale; }
float sun_lit(vec3 face) {
    float slope = 1.0 - max(dot(face, key_direction), 0.0);
    vec3 place = world + face * shadow_texel_m * (0.6 + 1.4 * slope);
    vec3 p = (shadow_from_world * vec4(place, 1.0)).xyz * 0.5 + 0.5;
    if (any(lessThan(p.xy, vec2(0.0))) || any(greaterThan(p, vec3(1.0)))) return 1.0;
    float texel = 1.0 / float(textureSize(shadow_map, 0).x), sum = 0.0;
    for (int k = 0; k < 4; ++k) {
        vec2 off = (vec2(k & 1, k >> 1) - 0.5) * shadow_radius * texel;
        sum += texture(shadow_map, vec3(p.xy + off, p.z));
    }
    return 0.25 * sum;
}
// Share of a ray's sunlight that the scene shades, in the glow around the key light, where what
// hides it shades most of a ray: the mean of a few places, as modules/air/shaders/light_shafts.glsl.
uniform float picture_share;      // of the pictures of a still, for places of its own in each
const int SHAFT_STEPS = 8;
float shaded_glow(vec3 d, float metres) {
    float glow = smoothstep(GLOW_BEGINS, GLOW_WHOLE, dot(d, key_direction));
    if (!(glow > 0.0 && key_irradiance.g > 0.0)) return 0.0;
    vec3 eye = (shadow_from_world * vec4(cameraPosition, 1.0)).xyz;
    vec3 end = (shadow_from_world * vec4(world, 1.0)).xyz;
    float dither = fract(52.9829189 * fract(dot(gl_FragCoord.xy, vec2(0.06711056, 0.00583715))) + picture_share);
    float dark = 0.0;
    for (int k = 0; k < SHAFT_STEPS; ++k) {
        vec3 p = mix(eye, end, min((float(k) + dither) / float(SHAFT_STEPS), 0.99));
        if (any(greaterThan(abs(p.xy), vec2(1.0)))) continue;
        dark += 1.0 - textureLod(shadow_map, vec3(p.xy, min(p.z, 1.0)) * 0.5 + 0.5, 0.0);
    }
    return glow * dark / float(SHAFT_STEPS);
}
#ifdef GLASS_SHADOW
vec3 through_glass() {
    vec3 p = (shadow_from_world * vec4(world, 1.0)).xyz * 0.5 + 0.5;
    return texture(glass_map, p.xy).rgb;
}
#endif
vec3 mapped_normal(vec3 n, vec3 view) {
#ifdef NORMAL_MAP
    vec2 uv = uv_of(layers.z);
    vec3 t = texture(normal_map, uv).xyz * 2.0 - 1.0;
    vec3 px = dFdx(world), py = dFdy(world);
    vec2 ux = dFdx(uv), uy = dFdy(uv);
    vec3 across = cross(py, n) * ux.x + cross(n, px) * uy.x;
    vec3 up = cross(py, n) * ux.y + cross(n, px) * uy.y;
    float scale = inversesqrt(max(max(dot(across, across), dot(up, up)), 1e-30));
    // Texture coordinates run downwards in the file.
    vec3 bent = normalize(scale * map_strength.x * (across * t.x - up * t.y) + n * t.z);
    // Flanks that lean away from the eye are not seen: the opposite ones are.
    return dot(bent, view) > 0.0 ? bent : 2.0 * dot(bent, n) * n - bent;
#else
    return n;
#endif
}

void main() {
    vec4 base = base_factor * clamp(vertex_colour, 0.0, 1.0);
#ifdef BASE_MAP
    base *= texture(base_map, uv_of(layers.x));
#endif
    if (base.a < alpha_cutoff) discard;
    vec3 to_eye = cameraPosition - world;
    float metres = length(to_eye);
    vec3 view = to_eye / metres, face = normalize(cross(dFdx(world), dFdy(world)));
    if (dot(face, view) < 0.0) face = -face;
    vec3 n = normalize(smooth_normal);
    // Winding says which side is seen; normals may bend past the silhouette.
    bool behind = dot(n, face) < 0.0;
    if (behind) n = -n;
    vec3 even = n;
    n = mapped_normal(n, view);

    vec4 lit_by;
    vec4 sky = vec4(0.0, 0.0, 0.0, 1.0);
#if defined(GROUND)
    ground_light(lit_by, sky);
#elif defined(LIGHT_MAP)
    lit_by = map_light(map_px);
    sky = map_sky(map_px);
    if (behind) {
#ifdef PROBES
        lit_by = probe_light(n);
#else
        lit_by.rgb *= ratio(open_irradiance(n), open_irradiance(-even), 10.0);
#endif
        sky = vec4(0.0, 0.0, 0.0, lit_by.a);
    }
#ifdef NORMAL_MAP
    else lit_by.rgb *= ratio(open_irradiance(n), open_irradiance(even), 2.0);
#endif
#elif defined(PROBES)
    lit_by = probe_light(n);
    sky = vec4(0.0, 0.0, 0.0, lit_by.a);
#else
    lit_by = vec4(open_irradiance(n), 1.0);
#endif
    vec3 reached = lit_by.rgb;
    float arrives = clamp(lit_by.a, 0.0, 1.0);
    float occlusion = 1.0;
#ifdef OCCLUSION_MAP
    occlusion = mix(1.0, texture(occlusion_map, uv_of(layers.w)).r, map_strength.y);
#ifndef LIGHT_MAP
    reached *= occlusion;
#endif
#endif
    float sky_in_all = max(sky.a + dot(sky.rgb, even) * 2.0 / 3.0, 1e-4);
    float nl = dot(n, key_direction), cos_face = dot(face, key_direction);
    vec3 sun = vec3(0.0);
    // Shadow maps leak sunlight where walls meet: what no sky reaches gets none.
    if (nl > 0.0 && cos_face > 0.0 && key_irradiance.g > 0.0 && lit_by.a > 0.0) {
        sun = key_irradiance * (before_terminator(nl, cos_face, dot(n, face)) * sun_lit(face));
#ifdef GLASS_SHADOW
        sun *= through_glass();
#endif
    }
    if (values_shown > 0.0) {
        float cosine = max(dot(even, key_direction), 0.0);
        colour = vec4(values_shown * LUMENS_PER_WATT * dot(reached + sun * cosine, WEIGHTS));
        return;
    }
    float metallic = metallic_factor, roughness = roughness_factor;
    vec3 radiance = emission / LUMENS_PER_WATT;
#ifdef ROUGH_MAP
    vec4 rough = texture(rough_map, uv_of(layers.y));
    roughness *= rough.g;
    metallic *= rough.b;
#endif
#ifdef EMISSION_MAP
    radiance *= texture(emission_map, uv_of(layers.x)).rgb;
#endif
    if (unlit > 0.5) {
        vec3 on_ground = open_irradiance(vec3(0.0, 1.0, 0.0)) + key_irradiance * max(key_direction.y, 0.0);
        colour = finished(through_air(base.rgb * on_ground / PI, -view, metres, 1.0, 0.0), 1.0);
        return;
    }
    roughness = clamp(roughness, 0.0, 1.0);
    float alpha = max(roughness * roughness, SMALLEST_ALPHA), nv = max(dot(n, view), 1e-4);
    float coat_f90 = min(dielectric_f90, grazing(dielectric_f0).r), coat_peak = peak(dielectric_f0);
    vec3 f0 = mix(dielectric_f0, base.rgb, metallic);
    vec3 f90 = mix(vec3(coat_f90), grazing(f0), metallic);
    vec3 albedo = base.rgb * (1.0 - metallic);
    float transmission = transmission_factor * (1.0 - metallic);
    albedo *= 1.0 - transmission;
    vec3 share = shares(nv, roughness);
    vec3 more = 1.0 + f0 * (1.0 / (share.x + share.y) - 1.0);
    float through = 1.0 - coat(share.xy, coat_peak, coat_f90);
    vec3 diffuse = reached * through;
    if (sun.g > 0.0) {
        float mean = share.z * coat_f90 + (coat_peak - TABLE_F0 * coat_f90) * (1.0 - share.z) / (1.0 - TABLE_F0);
        vec3 light = sun * nl;
        vec2 towards = shares(nl, roughness).xy;
        diffuse += light * (through / (1.0 - min(mean, 0.999))
                            * (1.0 - coat(towards, coat_peak, coat_f90)));
        vec3 h = normalize(key_direction + view);
        radiance += light * more * specular_brdf(nl, nv, clamp(dot(n, h), 0.0, 1.0),
            clamp(dot(view, h), 0.0, 1.0), alpha, f0, f90);
    }
    radiance += albedo * diffuse / PI;
    if (coat_f90 + metallic > 0.0) {
        vec3 once = f0 * share.x, at_grazing = f90 * share.y;
        vec3 to_image = reflect(-view, n);
        vec3 about = normalize(mix(to_image, n, roughness * roughness));
        float narrower = roughness * (0.8 - 0.36 * roughness);
        vec3 cut = normalize(to_image + 0.5 * narrower * max(0.0, 1.0 - nv / 0.7) * n);
        vec3 direct = reflected_sky(about, roughness), low = reflected_sky(cut, narrower);
        vec3 around = max(reached - arrives * open_irradiance(n), 0.0) / PI;
        float r2 = roughness * roughness, straight = pow(1.0 - r2, 1.3);
        vec3 across = nv * n - view;
        float flat_0 = 0.62 * r2 / (r2 + 0.05), flat_1 = 0.35 * r2 / (r2 + 0.04);
        vec2 up = sqrt(vec2(flat_0 * flat_0, flat_1 * flat_1)
            + nv * nv * vec2(straight * straight, (1.0 - roughness) * (1.0 - roughness)));
        vec2 seen = sky.a + vec2(dot(sky.rgb, up.x * n + straight * across),
                                 dot(sky.rgb, up.y * n + (1.0 - 0.18 * roughness) * across));
        seen = clamp(mix(seen, vec2(sky_in_all), r2 * r2), 0.0, 1.0);
        // The visible part of the sky may be brighter than the lobe's image of the whole sky.
        float brighter = mix(1.0, min(arrives / sky_in_all, 4.0), r2);
        vec2 things = (1.0 - seen + FEWEST) / (1.0 - min(sky_in_all, 1.0) + FEWEST);
        vec3 coats = once * (brighter * seen.x * direct + things.x * around)
            + at_grazing * (brighter * seen.y * low + things.y * around);
#ifdef MIRROR
        vec4 image = mirror_image(to_image, n, nv, alpha);
        vec3 imaged = (once + at_grazing) * image.rgb + (1.0 - image.a) * (once * direct + at_grazing * low);
        float unseen = smoothstep(MIRROR_FADES.x, MIRROR_FADES.y, roughness);
        coats = mix(imaged, coats, max(unseen, 1.0 - mirror_shown));
#endif
        radiance += more * coats;
    }
    float lit = mix(smoothstep(0.0, 0.5, arrives), 1.0, smoothstep(1.0, 2.0, metres / scene_m));
    radiance = through_air(radiance, -view, metres, lit, shaded_glow(-view, metres));
#ifdef GLASS
    // The tint of what is behind is one number here: the page blends by alpha.
    float left = dot(base.rgb, WEIGHTS) * transmission * through;
    vec4 done = finished(radiance * base.a, 1.0);
    colour = vec4(done.rgb, 1.0 - mix(1.0, left, base.a));
#else
    colour = finished(radiance, 1.0);
#endif
}`;

export const TONE_FRAGMENT = `${HEAD}${WEIGHTS}${TONE}
uniform sampler2D radiance;
uniform float pre;
uniform float values_shown;
uniform float pictures;           // that are summed in the target
uniform vec2 range;               // log of lux at the ends of the scale
uniform sampler2D colours;
in vec2 at;
out vec4 display;
void main() {
    vec4 texel = texelFetch(radiance, ivec2(at * vec2(textureSize(radiance, 0))), 0);
    vec3 found = texel.rgb;
    float number = texel.a / pictures - 4.0;
    if (number > -0.5) {
        display = vec4(texture(colours, vec2(clamp(number, 0.0, 1.0), 0.5)).rgb, 1.0);
        return;
    }
    if (values_shown > 0.0) {
        if (found.r < 0.0) { display = vec4(0.08, 0.08, 0.08, 1.0); return; }
        float share = (log(max(found.r / (pre * values_shown), 1e-6)) - range.x) / (range.y - range.x);
        display = vec4(texture(colours, vec2(clamp(share, 0.0, 1.0), 0.5)).rgb, 1.0);
        return;
    }
    display = vec4(displayed(found / pre) + dither(gl_FragCoord.xy), 1.0);
}`;

export const COPY_FRAGMENT = `${HEAD}
uniform sampler2D from;
uniform float factor;
in vec2 at;
out vec4 colour;
void main() { colour = texture(from, at) * factor; }`;

/** A pass over all texels of a target.
 * @param {string} fragment @param {Record<string, THREE.IUniform>} uniforms
 * @param {Record<string, any>} [defines] @param {Partial<THREE.ShaderMaterialParameters>} [more] */
export function fullScreen(fragment, uniforms, defines = {}, more = {}) {
  const material = new THREE.RawShaderMaterial({
    ...VERSION, vertexShader: FULL_SCREEN, fragmentShader: fragment, uniforms, defines,
    depthTest: false, depthWrite: false, ...more,
  });
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute('position', new THREE.BufferAttribute(
    new Float32Array([-1, -1, 0, 3, -1, 0, -1, 3, 0]), 3));
  const mesh = new THREE.Mesh(geometry, material);
  mesh.frustumCulled = false;
  const scene = new THREE.Scene(), camera = new THREE.Camera();
  scene.add(mesh);
  return {
    mesh, material,
    /** @param {THREE.WebGLRenderer} renderer @param {THREE.WebGLRenderTarget | null} target
     * @param {number} [face] */
    draw(renderer, target, face) {
      renderer.setRenderTarget(target, face);
      renderer.render(scene, camera);
    },
  };
}

/** @param {string} vertex @param {string} fragment @param {Record<string, THREE.IUniform>} uniforms
 * @param {Record<string, any>} defines @param {Partial<THREE.ShaderMaterialParameters>} [more] */
export function program(vertex, fragment, uniforms, defines, more = {}) {
  return new THREE.RawShaderMaterial({
    ...VERSION, vertexShader: vertex, fragmentShader: fragment, uniforms, defines, ...more,
  });
}
