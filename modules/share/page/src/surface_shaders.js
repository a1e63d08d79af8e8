// Programs of surfaces, GLSL ES 3.00: what a surface is, whatever the hour, and its light. Pictures at
// rest do both in one program; drafts keep what surfaces are in a target, and light that.
import { FINISH, HEAD, SKY, TONE } from './shaders.js';

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

// A surface where it is seen. Its normals point to the side that is seen.
const SURFACE = `
struct Surface {
    int light;                    // what light arrives by, one of the numbers below
    bool painted;                 // shown as paint on level ground, without facets
    vec2 map_px;                  // place in the light map
    float far;                    // share of open ground in the light of that place
    vec3 n, even, face;           // normal with the map of normals, without it, and of the triangle
    vec3 base, emission;          // emission in W m^-2 sr^-1
    vec3 dielectric_f0;
    float coat_f90, metallic, roughness, occlusion, transmission;
};
const int BY_OPEN_SKY = 1, BY_MAP = 2, BY_MAP_BENT = 3, BY_MAP_BEHIND = 4, BY_GROUND = 5, BY_PROBES = 6;
const float LUMENS_PER_WATT = 683.0;
float peak(vec3 v) { return max(v.r, max(v.g, v.b)); }
vec3 grazing(vec3 f0) { return vec3(clamp(50.0 * peak(f0), 0.0, 1.0)); }
`;

const FOUND = `
in vec3 world;
in vec3 smooth_normal;
in vec2 first_uv;
in vec2 second_uv;
in vec2 map_px;
in vec4 vertex_colour;
uniform vec4 base_factor;
uniform vec3 emission;
uniform float metallic_factor, roughness_factor, alpha_cutoff;
uniform vec3 dielectric_f0;
uniform float dielectric_f90, transmission_factor, unlit;
uniform sampler2D base_map, rough_map, normal_map, occlusion_map, emission_map;
uniform ivec4 layers;             // sets of coordinates: base, rough, normal, occlusion
uniform vec2 map_strength;        // of normal and occlusion

#ifdef GROUND
uniform vec4 chart;               // first texel across and down, steps, half width in m
uniform vec3 chart_place;         // middle (x, z), warp
const float GROUND_FADE = 0.7;
void chart_at(vec2 place, out vec2 px, out float far) {
    px = vec2(0.0);
    far = 1.0;
#ifdef CHART
    vec2 reach = (place - chart_place.xy) / chart.w, x = abs(reach) * sinh(chart_place.z);
    vec2 along = sign(reach) * log(x + sqrt(x * x + 1.0)) / chart_place.z;
    px = chart.xy + clamp(0.5 + 0.5 * along, 0.0, 1.0) * chart.z;
    far = smoothstep(GROUND_FADE, 1.0, max(abs(reach.x), abs(reach.y)));
#endif
}
#endif

vec2 uv_of(int layer) { return layer == 1 ? second_uv : first_uv; }
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
// The surface, and its opacity; discards what is cut out.
Surface found_surface(vec3 view, out float opacity) {
    Surface s;
    vec4 base = base_factor * clamp(vertex_colour, 0.0, 1.0);
#ifdef BASE_MAP
    base *= texture(base_map, uv_of(layers.x));
#endif
    if (base.a < alpha_cutoff) discard;
    opacity = base.a;
    s.base = base.rgb;
    s.face = normalize(cross(dFdx(world), dFdy(world)));
    if (dot(s.face, view) < 0.0) s.face = -s.face;
    s.even = normalize(smooth_normal);
    // Winding says which side is seen; normals may bend past the silhouette.
    bool behind = dot(s.even, s.face) < 0.0;
    if (behind) s.even = -s.even;
    s.n = mapped_normal(s.even, view);
    s.map_px = map_px;
    s.far = 0.0;
    s.occlusion = 1.0;
#if defined(OCCLUSION_MAP) && !defined(LIGHT_MAP)
    s.occlusion = mix(1.0, texture(occlusion_map, uv_of(layers.w)).r, map_strength.y);
#endif
#if defined(GROUND)
    s.light = BY_GROUND;
    chart_at(world.xz, s.map_px, s.far);
#elif defined(LIGHT_MAP)
    s.light = behind ? BY_MAP_BEHIND : BY_MAP;
#ifdef NORMAL_MAP
    if (!behind) s.light = BY_MAP_BENT;
#endif
#elif defined(PROBES)
    s.light = BY_PROBES;
#else
    s.light = BY_OPEN_SKY;
#endif
    s.painted = unlit > 0.5;
    s.metallic = metallic_factor;
    s.roughness = roughness_factor;
    s.emission = emission / LUMENS_PER_WATT;
#ifdef ROUGH_MAP
    vec4 rough = texture(rough_map, uv_of(layers.y));
    s.roughness *= rough.g;
    s.metallic *= rough.b;
#endif
#ifdef EMISSION_MAP
    s.emission *= texture(emission_map, uv_of(layers.x)).rgb;
#endif
    s.roughness = clamp(s.roughness, 0.0, 1.0);
    s.dielectric_f0 = dielectric_f0;
    s.coat_f90 = min(dielectric_f90, grazing(dielectric_f0).r);
    s.transmission = transmission_factor * (1.0 - s.metallic);
    return s;
}
`;

// Radiance of a surface at an hour, and that of the place `world`.
const LIT = `
uniform vec3 cameraPosition;
uniform sampler2D light_map, visible_sky, open_sky, reflectance;
uniform samplerCube mirrored_sky;
uniform vec3 open_up;             // the open sky's irradiance of level ground
uniform float light_scale, open_scale, mirror_scale, mirror_levels;
uniform vec2 light_size;
uniform vec3 key_direction, key_irradiance;
uniform highp sampler2D shadow_map;
uniform sampler2D glass_map;
uniform mat4 shadow_from_world;
uniform vec3 plane_scale;          // from the map's axes of a plane's normal to those of its depths
uniform float shadow_texel_depth; // a texel's width in the map's depth
uniform float values_shown;       // factor on lux, which are shown in place of radiance; 0: radiance
uniform bool diffuse_shown;       // all that a surface sends back is diffuse, as in the light map
// Texels, and shares of the map's depth, that a caster must stand before a plane.
const float OFF_PLANE = 0.15, ROUNDING = 1e-6;
const float SMALLEST_ALPHA = 0.005, TABLE_F0 = 0.04, FEWEST = 0.05;

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

#ifdef PROBES
uniform vec3 probe_lower, probe_per_m;
uniform ivec3 probe_counts;
uniform int probe_row;            // of the map at which they begin
vec4 probe(ivec3 at, int face) {
    int number = ((at.z * probe_counts.y + at.y) * probe_counts.x + at.x) * 6 + face;
    int width = int(light_size.x);
    return texelFetch(light_map, ivec2(number % width, probe_row + number / width), 0);
}
vec4 probe_light(vec3 n, bool needed) {
    vec3 at = clamp((world - probe_lower) * probe_per_m + 0.5 * n, vec3(0.0),
                    vec3(probe_counts - 1));
    ivec3 first = min(ivec3(at), probe_counts - 2);
    vec3 t = at - vec3(first), weight = n * n;
    vec4 sum = vec4(0.0);
    for (int k = 0; k < (needed ? 24 : 1); ++k) {
        int axis = k >> 3;
        ivec3 off = ivec3(k & 1, (k >> 1) & 1, (k >> 2) & 1);
        vec3 w = mix(1.0 - t, t, vec3(off));
        sum += weight[axis] * w.x * w.y * w.z * probe(first + off, 2 * axis + (n[axis] < 0.0 ? 1 : 0));
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
// Share of the key light: four texels around the place, each compared with the depth of the surface's
// own plane at its middle (Isidoro 2006, "Shadow mapping: GPU-based tips and techniques"), as in
// render/shaders/sun_shadow.glsl. A look-up before the surface would shade it early where light grazes.
float sun_lit(vec3 face) {
    vec3 p = (shadow_from_world * vec4(world, 1.0)).xyz * 0.5 + 0.5;
    if (any(lessThan(p.xy, vec2(0.0))) || any(greaterThan(p.xy, vec2(1.0)))) return 1.0;
    float edge = float(textureSize(shadow_map, 0).x);
    vec3 n = mat3(shadow_from_world) * face * plane_scale;
    vec2 steep = -n.xy / min(n.z, -1e-3 * length(n)) / edge;
    vec2 place = p.xy * edge - 0.5, within = fract(place);
    ivec2 first = ivec2(place - within), last = ivec2(edge) - 1;
    float depth = p.z - OFF_PLANE * (abs(steep.x) + abs(steep.y) + shadow_texel_depth) - ROUNDING, lit = 0.0;
    for (int k = 0; k < 4; ++k) {
        ivec2 off = ivec2(k & 1, k >> 1);
        float below = depth + dot(steep, vec2(off) - within);
        float found = texelFetch(shadow_map, clamp(first + off, ivec2(0), last), 0).r;
        vec2 share = mix(1.0 - within, within, vec2(off));
        lit += share.x * share.y * step(min(below, 1.0), found);
    }
    return lit;
}
// Share of a ray's sunlight that the scene shades, in the glow around the key light, where what
// hides it shades most of a ray: the mean of a few places, as modules/air/shaders/light_shafts.glsl.
uniform float picture_share;      // of the pictures of a still, for places of its own in each
#ifdef DRAFT
const int SHAFT_STEPS = 4;
#else
const int SHAFT_STEPS = 8;
#endif
float shaded_glow(vec3 d, float metres) {
    float glow = smoothstep(GLOW_BEGINS, GLOW_WHOLE, dot(d, key_direction));
    vec3 eye = (shadow_from_world * vec4(cameraPosition, 1.0)).xyz;
    vec3 end = (shadow_from_world * vec4(world, 1.0)).xyz;
    float dither = fract(52.9829189 * fract(dot(gl_FragCoord.xy, vec2(0.06711056, 0.00583715))) + picture_share);
    float dark = 0.0;
    int steps = glow > 0.0 && key_irradiance.g > 0.0 ? SHAFT_STEPS : 1;
    for (int k = 0; k < steps; ++k) {
        vec3 p = mix(eye, end, min((float(k) + dither) / float(SHAFT_STEPS), 0.99));
        if (any(greaterThan(abs(p.xy), vec2(1.0)))) continue;
        dark += 1.0 - step(min(p.z, 1.0) * 0.5 + 0.5, textureLod(shadow_map, p.xy * 0.5 + 0.5, 0.0).r);
    }
    return glow * dark / float(SHAFT_STEPS);
}
#ifdef GLASS_SHADOW
vec3 through_glass() {
    vec3 p = (shadow_from_world * vec4(world, 1.0)).xyz * 0.5 + 0.5;
    return texture(glass_map, p.xy).rgb;
}
#endif
// Irradiance, and what is seen of the sky; open is the irradiance of an open place.
void light_of(Surface s, vec3 open, out vec4 light, out vec4 sky) {
    sky = vec4(0.0, 0.0, 0.0, 1.0);
#ifdef PROBES
    bool by_probes = s.light == BY_PROBES || s.light == BY_MAP_BEHIND;
    vec4 probes = probe_light(s.n, by_probes);
#endif
    if (s.light == BY_GROUND) {
        light = mix(map_light(s.map_px), vec4(open_up, 1.0), s.far);
        sky = mix(map_sky(s.map_px), sky, s.far);
    }
    else if (s.light == BY_MAP || s.light == BY_MAP_BENT) {
        light = map_light(s.map_px);
        sky = map_sky(s.map_px);
        if (s.light == BY_MAP_BENT) light.rgb *= ratio(open, open_irradiance(s.even), 2.0);
    }
#ifdef PROBES
    else if (by_probes) {
        light = probes;
        sky.a = light.a;
    }
#else
    else if (s.light == BY_MAP_BEHIND) {
        light = map_light(s.map_px);
        light.rgb *= ratio(open, open_irradiance(-s.even), 10.0);
        sky.a = light.a;
    }
#endif
    else light = vec4(open, 1.0);
}
// Radiance through the air, or lux; left: the share of light from behind that passes the coat.
vec3 lit_surface(Surface s, vec3 view, float metres, out float left) {
    vec4 lit_by, sky;
    vec3 n = s.n, open = open_irradiance(n);
    light_of(s, open, lit_by, sky);
    vec3 reached = lit_by.rgb * s.occlusion;
    float arrives = clamp(lit_by.a, 0.0, 1.0);
    left = 1.0;
    float sky_in_all = max(sky.a + dot(sky.rgb, s.even) * 2.0 / 3.0, 1e-4);
    float nl = dot(n, key_direction), cos_face = dot(s.face, key_direction);
    vec3 sun = vec3(0.0);
    // Shadow maps leak sunlight where walls meet: what no sky reaches gets none.
    if (nl > 0.0 && cos_face > 0.0 && key_irradiance.g > 0.0 && lit_by.a > 0.0) {
        sun = key_irradiance * (before_terminator(nl, cos_face, dot(n, s.face)) * sun_lit(s.face));
#ifdef GLASS_SHADOW
        sun *= through_glass();
#endif
    }
    if (values_shown > 0.0) {
        float cosine = max(dot(s.even, key_direction), 0.0);
        return values_shown * LUMENS_PER_WATT * vec3(dot(reached + sun * cosine, WEIGHTS), 0.0, 0.0);
    }
    vec3 radiance = s.emission;
    float metallic = s.metallic, roughness = s.roughness, coat_f90 = s.coat_f90;
    float alpha = max(roughness * roughness, SMALLEST_ALPHA), nv = max(dot(n, view), 1e-4);
    float coat_peak = peak(s.dielectric_f0);
    vec3 f0 = mix(s.dielectric_f0, s.base, metallic);
    vec3 f90 = mix(vec3(coat_f90), grazing(f0), metallic);
    vec3 albedo = s.base * ((1.0 - metallic) * (1.0 - s.transmission));
    vec3 share = shares(nv, roughness);
    vec3 more = 1.0 + f0 * (1.0 / (share.x + share.y) - 1.0);
    float through = 1.0 - coat(share.xy, coat_peak, coat_f90);
    left = through;
    // Share of diffuse light that the coat sends back, as light_transport/surfaces/terms.py.
    float mean = share.z * coat_f90 + (coat_peak - TABLE_F0 * coat_f90) * (1.0 - share.z) / (1.0 - TABLE_F0);
    if (diffuse_shown) {
        vec3 paint = albedo * (1.0 - mean) + (1.0 - metallic) * mean * s.dielectric_f0 / max(coat_peak, 1e-6);
        return radiance + (paint + metallic * s.base) * (reached + sun * max(dot(s.even, key_direction), 0.0)) / PI;
    }
    vec3 diffuse = reached * through;
    if (sun.g > 0.0) {
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
        float r2 = roughness * roughness, straight = pow(1.0 - r2, 1.3);
        // A lobe as wide as the hemisphere has the colour of all that arrives, not of the zenith.
        vec3 wide = open / PI, direct, low;
        for (int k = 0; k < 2; ++k) {
            vec3 lobe = mix(reflected_sky(k == 0 ? about : cut, k == 0 ? roughness : narrower), wide, r2 * r2);
            if (k == 0) direct = lobe;
            else low = lobe;
        }
        vec3 around = max(reached / PI - arrives * wide, 0.0);
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
    float shaded = shaded_glow(-view, metres);
    if (s.painted) {
        radiance = s.base * (open_up + key_irradiance * max(key_direction.y, 0.0)) / PI;
        lit = left = 1.0;
        shaded = 0.0;
    }
    return through_air(radiance, -view, metres, lit, shaded);
}
`;

export const SURFACE_FRAGMENT = `${HEAD}precision highp samplerCube;
${SKY}${TONE}${FINISH}${SURFACE}${FOUND}${LIT}
void main() {
    vec3 to_eye = cameraPosition - world;
    float metres = length(to_eye), opacity, left;
    vec3 view = to_eye / metres;
    Surface s = found_surface(view, opacity);
    vec3 radiance = lit_surface(s, view, metres, left);
    if (values_shown > 0.0) { colour = vec4(radiance, 1.0); return; }
#ifdef GLASS
    // The tint of what is behind is one number here: the page blends by alpha.
    vec4 done = finished(radiance * opacity, 1.0);
    colour = vec4(done.rgb, 1.0 - mix(1.0, dot(s.base, WEIGHTS) * s.transmission * left, opacity));
#else
    colour = finished(radiance, 1.0);
#endif
}`;

// What drafts keep of opaque surfaces: four targets of integers.
const KEPT = `
uint halves(float a, float b) { return packHalf2x16(vec2(a, b)); }
// A direction on the octahedron's unfolded surface.
vec2 unfolded(vec3 n) {
    vec2 p = n.xz / (abs(n.x) + abs(n.y) + abs(n.z));
    return n.y < 0.0 ? (1.0 - abs(p.yx)) * vec2(p.x < 0.0 ? -1.0 : 1.0, p.y < 0.0 ? -1.0 : 1.0) : p;
}
vec3 folded(uint bits) {
    vec2 p = unpackSnorm2x16(bits);
    float y = 1.0 - abs(p.x) - abs(p.y);
    if (y < 0.0) p = (1.0 - abs(p.yx)) * vec2(p.x < 0.0 ? -1.0 : 1.0, p.y < 0.0 ? -1.0 : 1.0);
    return normalize(vec3(p.x, y, p.y));
}
`;

export const KEEP_FRAGMENT = `${HEAD}${SURFACE}${FOUND}${KEPT}
uniform vec3 cameraPosition;
layout(location = 0) out uvec4 first;
layout(location = 1) out uvec4 second;
layout(location = 2) out uvec4 third;
layout(location = 3) out uvec4 fourth;
void main() {
    float opacity;
    Surface s = found_surface(normalize(cameraPosition - world), opacity);
    uint more = s.painted ? 8u : 0u;
#ifdef MIRROR
    more |= 16u;
#endif
    first = uvec4(floatBitsToUint(world), uint(s.light) | more);
    second = uvec4(floatBitsToUint(s.map_px), halves(s.far, s.occlusion), halves(s.metallic, s.roughness));
    third = uvec4(packSnorm2x16(unfolded(s.n)), packSnorm2x16(unfolded(s.even)), packSnorm2x16(unfolded(s.face)),
                  halves(s.coat_f90, s.dielectric_f0.r));
    fourth = uvec4(halves(s.dielectric_f0.g, s.dielectric_f0.b), halves(s.base.r, s.base.g),
                   halves(s.base.b, s.emission.r), halves(s.emission.g, s.emission.b));
}`;

export const RELIGHT_FRAGMENT = `${HEAD}precision highp samplerCube;
precision highp usampler2D;
${SKY}${TONE}${FINISH}${SURFACE}${KEPT}
uniform usampler2D first, second, third, fourth;
uniform mat4 projectionMatrix, viewMatrix;
vec3 world;
${LIT}
void main() {
    ivec2 p = ivec2(gl_FragCoord.xy);
    uvec4 kept = texelFetch(first, p, 0);
    // Surfaces with an image of what is around them are drawn by themselves.
    if (kept.w == 0u || (kept.w & 16u) != 0u) discard;
    world = uintBitsToFloat(kept.xyz);
    Surface s;
    s.light = int(kept.w & 7u);
    s.painted = (kept.w & 8u) != 0u;
    kept = texelFetch(second, p, 0);
    s.map_px = uintBitsToFloat(kept.xy);
    vec2 two = unpackHalf2x16(kept.z);
    s.far = two.x;
    s.occlusion = two.y;
    two = unpackHalf2x16(kept.w);
    s.metallic = two.x;
    s.roughness = two.y;
    s.transmission = 0.0;
    kept = texelFetch(third, p, 0);
    s.n = folded(kept.x);
    s.even = folded(kept.y);
    s.face = folded(kept.z);
    two = unpackHalf2x16(kept.w);
    s.coat_f90 = two.x;
    s.dielectric_f0.r = two.y;
    kept = texelFetch(fourth, p, 0);
    s.dielectric_f0.gb = unpackHalf2x16(kept.x);
    s.base.rg = unpackHalf2x16(kept.y);
    two = unpackHalf2x16(kept.z);
    s.base.b = two.x;
    s.emission.r = two.y;
    s.emission.gb = unpackHalf2x16(kept.w);
    vec3 to_eye = cameraPosition - world;
    float metres = length(to_eye), left;
    vec3 radiance = lit_surface(s, to_eye / metres, metres, left);
    colour = values_shown > 0.0 ? vec4(radiance, 1.0) : finished(radiance, 1.0);
    vec4 clip = projectionMatrix * viewMatrix * vec4(world, 1.0);
    gl_FragDepth = 0.5 + 0.5 * clip.z / clip.w;
}`;
