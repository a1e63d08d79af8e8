// Programs of the page, GLSL ES 3.00. Radiance is linear sRGB in W m^-2 sr^-1 times `pre`, which
// keeps it within half floats; terms are those of vrut_lite/render/shaders/mesh.frag. SwiftShader runs
// both sides of a branch, and a loop's first step always: what few pixels need are further steps.
import * as THREE from 'three';

const VERSION = { glslVersion: THREE.GLSL3 };

// Of linear sRGB's luminance.
const WEIGHTS = 'const vec3 WEIGHTS = vec3(0.2126390058715104, 0.7151686787677559, 0.07219231536073371);\n';

export const FULL_SCREEN = `
in vec3 position;
out vec2 at;
void main() { at = 0.5 + 0.5 * position.xy; gl_Position = vec4(position.xy, 0.0, 1.0); }`;

export const HEAD = 'precision highp float;\nprecision highp sampler2DArray;\nprecision highp sampler2DShadow;\n';

export const LIGHT_FRAGMENT = `${HEAD}precision highp isampler2DArray;
uniform sampler2DArray basis;     // planes, four a layer: factor, cluster, sky's share in two, its components
uniform isampler2DArray terms;    // whole steps, four a layer
uniform highp sampler2D coefficients;  // of terms, a row a cluster
uniform float share_weights[COMPONENTS];
out vec4 light;
void main() {
    ivec2 p = ivec2(gl_FragCoord.xy);
    vec4 four = 255.0 * texelFetch(basis, ivec3(p, 0), 0);
    light = vec4(0.0);
    if (four.x < 0.5) return;
    float root = (256.0 * floor(four.z + 0.5) + four.w) / 65535.0, mean_share = root * root, ratio = 1.0;
    float factor = exp2((floor(four.x + 0.5) - 255.0) / CODES);
    int cluster = int(four.y + 0.5);
    vec3 sum = vec3(0.0);
    for (int k = 0; k < COMPONENTS; ++k) {
        if ((k & 3) == 0) four = 255.0 * texelFetch(basis, ivec3(p, 1 + (k >> 2)), 0);
        float share = (floor(four[k & 3] + 0.5) - 128.0) / 127.0;
        ratio += sign(share) * pow(abs(share), POWER) * share_weights[k];
    }
    ivec4 wholes;
    for (int k = 0; k < TERMS; ++k) {
        if ((k & 3) == 0) wholes = texelFetch(terms, ivec3(p, k >> 2), 0);
        sum += float(wholes[k & 3]) * texelFetch(coefficients, ivec2(k, cluster), 0).rgb;
    }
    light.a = mean_share * max(ratio, LEAST_RATIO);
    light.rgb = max(sum * factor, 0.0);
}`;

// The sky of two bodies and of the night; share/sky_table.py has the table's layout.
export const SKY = `
const float PI = 3.141592653589793;
${WEIGHTS}struct Body { vec3 light; vec2 azimuth; float height; float layer; float share; };
uniform Body bodies[2];           // those that shine
uniform int body_count;
uniform sampler2DArray sky_table;
uniform sampler2DArray glow_map;  // what stands over the horizon; what turns with the stars, above the air
uniform mat3 sky_from_world;
uniform vec3 star_extinction;     // optical depth towards the zenith
uniform float glow;               // factor on the maps' values
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
#ifdef CLOUDS
// Frozen clouds; share/cloud_maps.py.
uniform sampler2D cloud_about;    // transmittance, share of the clear sky's light, factor of cloud_light
uniform sampler2D cloud_light;    // that clouds send, but for the glow around the sun, over cloud_scale
uniform sampler2D cloud_glow;     // by the root of the angle from the sun
uniform float cloud_scale;
uniform vec3 cloud_suns[2], cloud_rays[2];  // towards bodies, and their irradiance in a clear sky
vec3 behind_clouds(vec3 sky, vec3 d) {
    vec2 p = 0.5 + 0.5 * vec2(d.x + d.z, d.x - d.z) / (abs(d.x) + max(d.y, 0.0) + abs(d.z));
    vec3 about = textureLod(cloud_about, (p * (CLOUD_FINE - 1.0) + 0.5) / CLOUD_FINE, 0.0).rgb;
    vec3 light = textureLod(cloud_light, (p * (CLOUD_COARSE - 1.0) + 0.5) / CLOUD_COARSE, 0.0).rgb;
    vec3 sum = sky * about.y + light * (about.z * cloud_scale);
    float passed = max(about.x, 1e-9), bends = -pow(passed, CLOUD_POWER) * log(passed);
    for (int k = 0; k < body_count; ++k) {
        float angle = 2.0 * asin(min(0.5 * length(d - cloud_suns[k]), 1.0));
        float node = sqrt(min(angle / CLOUD_GLOW_RAD, 1.0)) * (CLOUD_NODES - 1.0);
        sum += bends * cloud_rays[k] * textureLod(cloud_glow, vec2((node + 0.5) / CLOUD_NODES, 0.5), 0.0).rgb;
    }
    return max(sum, 0.0);
}
#endif
vec3 sky_radiance(vec3 d) {
    vec3 sum = vec3(0.0);
    for (int k = 0; k < body_count; ++k) sum += sky_of(bodies[k], d);
    if (glow > 0.0) {
        vec2 uv = vec2(atan(d.x, -d.z) / (2.0 * PI), asin(clamp(d.y, 0.0, 1.0)) / (0.5 * PI));
        vec3 own = sky_from_world * d;
        vec2 at = vec2(atan(own.y, own.x) / (2.0 * PI), asin(clamp(own.z, -1.0, 1.0)) / PI + 0.5);
        float degrees = asin(clamp(d.y, 0.0, 1.0)) * 180.0 / PI;
        vec3 left = exp(-star_extinction / (max(d.y, 0.0) + 0.50572 * pow(degrees + 6.07995, -1.6364)));
        sum += glow * (textureLod(glow_map, vec3(uv, 0.0), 0.0).rgb
            + left * textureLod(glow_map, vec3(at, 1.0), 0.0).rgb);
    }
#ifdef CLOUDS
    sum = behind_clouds(sum, d);
#endif
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

export const FINISH = `
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
vec3 beyond;                      // the sky a little above the horizon
vec3 far_air(vec3 d) { return beyond; }
uniform vec3 disc_direction;
uniform vec3 disc_radiance;       // mean
uniform float disc_radius;
uniform vec3 limb[6];
uniform float eye_height;
uniform float values_shown;
uniform bool diffuse_shown;       // far ground without the air before it, as in the light map
uniform vec3 to_sun;              // from the moon; 0: the disc is the sun's
uniform float moon_level;         // one over the mean of shade and albedo on the disc
uniform sampler2D moon_albedo;    // rows from the moon's south, columns from longitude -180 degrees
uniform mat3 moon_from_world;
// Light on the moon's disc, over its mean, by Lommel and Seeliger, as night_sky/shaders/moon.frag.
float phase_of(vec3 d) {
    vec3 right = normalize(cross(disc_direction, vec3(0.0, 1.0, 0.0)) + vec3(1e-6, 0.0, 0.0));
    vec3 upper = cross(right, disc_direction);
    vec2 p = vec2(dot(d, right), dot(d, upper)) / sin(disc_radius);
    float mu = sqrt(max(1.0 - dot(p, p), 0.0));
    vec3 n = p.x * right + p.y * upper - mu * disc_direction, own = moon_from_world * n;
    float mu_sun = max(dot(n, to_sun), 0.0);
    vec2 at = vec2(atan(own.y, own.x) / (2.0 * PI) + 0.5, 0.5 + asin(clamp(own.z, -1.0, 1.0)) / PI);
    return moon_level * textureLod(moon_albedo, at, 0.0).r * mu_sun / max(mu_sun + mu, 1e-4);
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
    vec3 upper = vec3(0.0);
    for (int k = above > 0.0 ? 0 : 1; k < (above < 1.0 ? 2 : 1); ++k) {
        vec3 sky = sky_radiance(k == 0 ? d : normalize(horizon(d)));
        if (k == 0) upper = sky;
        else beyond = sky;
    }
    upper += disc(d);
    vec3 lower = upper;
    if (above < 1.0 && diffuse_shown) lower = below_horizon;
    else if (above < 1.0)
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
#ifdef CLOUDS
uniform float cloud_passed[2];    // share of bodies' rays
uniform float cloud_lit;          // share of the light of a clear sky
#endif
void main() {
    vec2 c = 2.0 * at - 1.0;
    vec3 d = face == 0 ? vec3(1.0, -c.y, -c.x) : face == 1 ? vec3(-1.0, -c.y, c.x)
        : face == 2 ? vec3(c.x, 1.0, c.y) : face == 3 ? vec3(c.x, -1.0, -c.y)
        : face == 4 ? vec3(c.x, -c.y, 1.0) : vec3(-c.x, -c.y, -1.0);
    d = normalize(d);
#ifdef AIR
    vec3 radiance = vec3(0.0);
    float sunlit = 0.0;
    for (int k = 0; k < body_count; ++k) {
        vec4 air = air_of(bodies[k], d);
#ifdef CLOUDS
        float by_rays = air.a * cloud_passed[k], by_sky = (1.0 - air.a) * cloud_lit;
        air = vec4(air.rgb * (by_rays + by_sky), by_rays / max(by_rays + by_sky, 1e-6));
#endif
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
precision highp sampler2D;
in vec3 position;                 // fixed on the sky
in vec3 light;                    // irradiance above the air
uniform mat3 world_from_sky;
uniform mat4 viewMatrix, projectionMatrix;
uniform vec2 jitter, size_px;
uniform vec3 extinction;
uniform float night, refraction;
#ifdef CLOUDS
uniform sampler2D cloud_about;
#endif
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
#ifdef CLOUDS
    vec2 p = 0.5 + 0.5 * vec2(d.x + d.z, d.x - d.z) / (abs(d.x) + max(d.y, 0.0) + abs(d.z));
    left *= textureLod(cloud_about, (p * (CLOUD_FINE - 1.0) + 0.5) / CLOUD_FINE, 0.0).r;
#endif
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
