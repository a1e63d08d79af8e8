#version 430 core
// Radiance of a metallic-roughness surface (glTF 2.0, appendix B) under sun and sky,
// linear sRGB in W m^-2 sr^-1: nothing is exposed or tone-mapped here.

const float PI = 3.141592653589793;
const float LUMENS_PER_WATT = 683.0;
const float MOST_TILTED = 2.0;       // times the light, by what a normal map tilts
const float MOST_BEHIND = 10.0;      // and on the back of a sheet
const float SMALLEST_ALPHA = 0.005;  // the sun's own radius blurs a mirror image about so much

struct Material {
    vec3 emissive_factor;
    vec4 base_color_factor;
    float metallic_factor;
    float roughness_factor;
#ifdef HAS_NORMAL_TEX
    sampler2D normal_texture;
#endif
#ifdef HAS_OCCLUSION_TEX
    sampler2D occlusion_texture;
#endif
#ifdef HAS_EMISSIVE_TEX
    sampler2D emissive_texture;
#endif
#ifdef HAS_BASE_COLOR_TEX
    sampler2D base_color_texture;
#endif
#ifdef HAS_METALLIC_ROUGHNESS_TEX
    sampler2D metallic_roughness_texture;
#endif
};

uniform Material material;
uniform float alpha_cutoff;          // below it a fragment is dropped; 0 for opaque and blended
uniform float alpha_end;             // and from it on: what is solid is drawn before
uniform float opaque;                // 1: alpha is ignored
uniform int base_color_layer;        // of texture coordinates: 0 the first, 1 the second
uniform int metallic_roughness_layer;
uniform int normal_layer;
uniform int occlusion_layer;
uniform int emissive_layer;
uniform float normal_scale;
uniform float occlusion_strength;
uniform float dielectric_f0;         // reflectance at normal incidence of what is no metal
const float TABLE_F0 = 0.04;         // of the table's means

uniform vec3 sun_direction;          // towards the sun
uniform vec3 sun_irradiance;         // on a plane that faces it
uniform vec3 irradiance_sh[25];
layout(binding = 8) uniform samplerCube sky;
uniform float sky_scale;
layout(binding = 10) uniform samplerCube reflection;  // the sky over lobes, a mip level each
uniform float reflection_scale;
uniform vec4 level_roughness;
layout(binding = 11) uniform sampler2D reflectance;   // render/reflection.py's table
layout(binding = 9) uniform sampler2DShadow shadow_map;
uniform mat4 shadow_matrix;          // from positions relative to the eye
uniform float shadow_texel_m;
#ifdef NEAR_SHADOW
layout(binding = 15) uniform sampler2DShadow near_shadow_map;  // finer, around the eye
uniform mat4 near_shadow_matrix;
uniform float near_shadow_texel_m;
const float NEAR_RIM = 0.25;         // of its half width, where it goes over into the other
#endif

in vec3 eye_to_point;                // at the pixel's centre, for derivatives
centroid in vec3 eye_to_sample;      // inside the triangle, also at its edge
#ifdef NORMAL_LOC
centroid in vec3 world_normal;
#endif
#ifdef TEXCOORD_0_LOC
in vec2 first_uv;
#endif
#ifdef TEXCOORD_1_LOC
in vec2 second_uv;
#endif
#ifdef COLOR_0_LOC
centroid in vec4 vertex_color;
#endif
#ifdef LIGHT_MAP
centroid in vec2 place_px;
uniform vec2 light_corner_px;        // of its rectangle in the light map
#endif

#ifdef GLASS
layout(location = 0, index = 0) out vec4 frag_radiance;
layout(location = 0, index = 1) out vec4 share_of_behind;
#else
out vec4 frag_radiance;
#endif

#ifdef TEXCOORD_0_LOC
vec2 uv_of(int layer) {
#ifdef TEXCOORD_1_LOC
    return layer == 1 ? second_uv : first_uv;
#else
    return first_uv;
#endif
}
#endif

// The normal of the triangle itself, on the side that is seen.
vec3 face_normal(vec3 view) {
    vec3 n = cross(dFdx(eye_to_point), dFdy(eye_to_point));
    float squared = dot(n, n);
    if (!(squared > 0.0)) return view;
    n *= inversesqrt(squared);
    return dot(n, view) < 0.0 ? -n : n;
}

// The surface's own normal, and whether the surface is seen from behind.
vec3 smooth_normal(vec3 face, out bool behind) {
    vec3 n = face;
    behind = false;
#ifdef NORMAL_LOC
    float length_squared = dot(world_normal, world_normal);
    if (length_squared > 0.0) n = world_normal * inversesqrt(length_squared);
    // The back of a sheet is lit from its own side.
    behind = dot(n, face) < 0.0;
    if (behind) n = -n;
#endif
    return n;
}

// The normal that its map gives a surface. Flanks that lean away from the eye are not seen: those
// opposite show in their place.
vec3 mapped_normal(vec3 n, vec3 view) {
#ifdef HAS_NORMAL_TEX
#ifdef TEXCOORD_0_LOC
    // Tangents from screen derivatives (Schueler, "Normal mapping without precomputed
    // tangents", ShaderX 5): right for any mesh, and needs no tangents in the file.
    vec3 dpx = dFdx(eye_to_point), dpy = dFdy(eye_to_point);
    vec2 uv = uv_of(normal_layer);
    vec2 dux = dFdx(uv), duy = dFdy(uv);
    vec3 across_x = cross(n, dpx), across_y = cross(dpy, n);
    vec3 t = across_y * dux.x + across_x * duy.x;
    vec3 b = across_y * dux.y + across_x * duy.y;
    float longest = max(dot(t, t), dot(b, b));
    if (longest > 0.0) {
        vec3 m = 2.0 * texture(material.normal_texture, uv).rgb - 1.0;
        m.xy *= normal_scale;
        vec3 bent = normalize(mat3(t * inversesqrt(longest), b * inversesqrt(longest), n) * m);
        n = dot(bent, view) > 0.0 ? bent : 2.0 * dot(bent, n) * n - bent;
    }
#endif
#endif
    return n;
}

// E(n) = sum c_i Y_i(n), bands 0 to 4: the twin of geometry/spherical_harmonics.py.
vec3 sky_irradiance(vec3 n) {
    float x = n.x, y = n.y, z = n.z, x2 = x * x, y2 = y * y, z2 = z * z;
    vec3 e = irradiance_sh[0] * 0.28209479177387814;
    e += 0.4886025119029199 * (irradiance_sh[1] * y + irradiance_sh[2] * z + irradiance_sh[3] * x);
    e += 1.0925484305920792 * (irradiance_sh[4] * x * y + irradiance_sh[5] * y * z
                               + irradiance_sh[7] * x * z);
    e += irradiance_sh[6] * (0.31539156525252005 * (3.0 * z2 - 1.0));
    e += irradiance_sh[8] * (0.5462742152960396 * (x2 - y2));
    e += 0.5900435899266435 * (irradiance_sh[9] * y * (3.0 * x2 - y2)
                               + irradiance_sh[15] * x * (x2 - 3.0 * y2));
    e += irradiance_sh[10] * (2.890611442640554 * x * y * z);
    e += 0.4570457994644658 * (5.0 * z2 - 1.0) * (irradiance_sh[11] * y + irradiance_sh[13] * x);
    e += irradiance_sh[12] * (0.3731763325901154 * z * (5.0 * z2 - 3.0));
    e += irradiance_sh[14] * (1.445305721320277 * z * (x2 - y2));
    e += irradiance_sh[16] * (2.5033429417967046 * x * y * (x2 - y2));
    e += 1.7701307697799304 * (irradiance_sh[17] * y * z * (3.0 * x2 - y2)
                               + irradiance_sh[23] * x * z * (x2 - 3.0 * y2));
    e += irradiance_sh[18] * (0.9461746957575601 * x * y * (7.0 * z2 - 1.0));
    e += 0.6690465435572892 * z * (7.0 * z2 - 3.0) * (irradiance_sh[19] * y + irradiance_sh[21] * x);
    e += irradiance_sh[20] * (0.10578554691520431 * (35.0 * z2 * z2 - 30.0 * z2 + 3.0));
    e += irradiance_sh[22] * (0.47308734787878004 * (x2 - y2) * (7.0 * z2 - 1.0));
    e += irradiance_sh[24] * (0.6258357354491761 * (x2 * (x2 - 3.0 * y2) - y2 * (3.0 * x2 - y2)));
    return max(e, 0.0);
}

// Corrects interpolation at the centroid on the edge of a triangle. Some rasterisers take 1 / w
// at the pixel's centre for the centroid too, which moves the point along its ray off the plane.
float centroid_factor(vec3 face) {
    float reached = dot(face, eye_to_sample);
    return abs(reached) > 0.0 ? dot(face, eye_to_point) / reached : 1.0;
}

// The shaded point of this triangle, also at its edge.
vec3 point_in_triangle(vec3 face) {
    float distance_to_plane = dot(face, eye_to_point), reached = dot(face, eye_to_sample);
    return abs(reached) > 0.0 ? eye_to_sample * (distance_to_plane / reached) : eye_to_point;
}

#if defined(LIGHT_MAP) || defined(LIGHT_PROBES) || defined(GROUND_LIGHT)
#define SURFACE_LIGHT
//!include surface_light.glsl

// Light of a surface with this normal, and with its normal map's normal.
Reached surface_light(vec3 face, vec3 smooth_n, vec3 n, bool behind) {
#if defined(GROUND_LIGHT)
    return ground_light(eye_to_point);
#elif defined(LIGHT_MAP)
#ifdef TWO_SIDED
    // The map has the light of the front alone.
    if (behind) {
#ifdef LIGHT_PROBES
        if (has_probes(eye_to_point)) return probe_light(eye_to_point, n);
#endif
        vec4 front = map_light(light_corner_px + place_px * centroid_factor(face)).light;
        front.rgb *= tilted(n, -smooth_n, MOST_BEHIND);
        return Reached(front, vec4(0.0, 0.0, 0.0, front.a));
    }
#endif
    Reached front = map_light(light_corner_px + place_px * centroid_factor(face));
#ifdef HAS_NORMAL_TEX
    front.light.rgb *= tilted(n, smooth_n, MOST_TILTED);
#endif
    return front;
#else
    return probe_light(eye_to_point, n);
#endif
}
#endif

// Share of the sun at a place in a shadow map: 3 x 3 taps of a linearly filtered comparison.
float lit_share(sampler2DShadow map, vec3 at) {
    at = at * 0.5 + 0.5;
    if (any(lessThan(at.xy, vec2(0.0))) || any(greaterThan(at.xy, vec2(1.0)))) return 1.0;
    float depth = min(at.z, 1.0);
    vec2 texel = 1.0 / vec2(textureSize(map, 0));
    float lit = 0.0;
    for (int i = -1; i <= 1; ++i)
        for (int j = -1; j <= 1; ++j)
            lit += texture(map, vec3(at.xy + vec2(i, j) * texel, depth));
    return lit / 9.0;
}

// Share of the sun that reaches this point.
float sun_visibility(vec3 face) {
    // The receiver is moved off its own surface by what the taps can span, more where the
    // light grazes it: along each axis of the map one texel, and one of the filter. Measured in
    // texels it is free of acne at any scale; farther off, light would leak under what overhangs.
    vec3 slope = normalize(mat3(shadow_matrix) * face);  // both maps have the sun's axes
    vec3 p = point_in_triangle(face);
    vec3 off = face * (0.5 + 2.0 * (abs(slope.x) + abs(slope.y)));
    vec3 at = (shadow_matrix * vec4(p + off * shadow_texel_m, 1.0)).xyz;
#ifdef NEAR_SHADOW
    vec3 near_at = (near_shadow_matrix * vec4(p + off * near_shadow_texel_m, 1.0)).xyz;
    vec3 from_middle = abs(near_at);
    float to_rim = 1.0 - max(from_middle.x, max(from_middle.y, from_middle.z));
    float share = clamp(to_rim / NEAR_RIM, 0.0, 1.0);
    if (share <= 0.0) return lit_share(shadow_map, at);
    float near_lit = lit_share(near_shadow_map, near_at);
    return share >= 1.0 ? near_lit : mix(lit_share(shadow_map, at), near_lit, share);
#else
    return lit_share(shadow_map, at);
#endif
}

#ifdef GLASS_SHADOW
layout(binding = 23) uniform sampler2D glass_shadow;  // of the nearest of the maps
const float GLASS_DEPTH = 2e-3;                      // half floats tell no less apart

// What glass before this point leaves of the sun; off its own surface as in `sun_visibility`.
vec3 sun_through_glass(vec3 face) {
    vec3 slope = normalize(mat3(shadow_matrix) * face);
    vec3 off = face * (0.5 + 2.0 * (abs(slope.x) + abs(slope.y)));
#ifdef NEAR_SHADOW
    vec3 p = point_in_triangle(face) + off * near_shadow_texel_m;
    vec3 at = (near_shadow_matrix * vec4(p, 1.0)).xyz * 0.5 + 0.5;
#else
    vec3 p = point_in_triangle(face) + off * shadow_texel_m;
    vec3 at = (shadow_matrix * vec4(p, 1.0)).xyz * 0.5 + 0.5;
#endif
    if (any(lessThan(at.xy, vec2(0.0))) || any(greaterThan(at.xy, vec2(1.0)))) return vec3(1.0);
    vec2 texel = 1.0 / vec2(textureSize(glass_shadow, 0));
    vec3 left = vec3(0.0);
    for (int i = -1; i <= 1; ++i) {
        for (int j = -1; j <= 1; ++j) {
            vec4 glass = textureLod(glass_shadow, at.xy + vec2(i, j) * texel, 0.0);
            left += at.z > glass.a + GLASS_DEPTH ? glass.rgb : vec3(1.0);
        }
    }
    return left / 9.0;
}
#endif

// Share of the sun on a triangle of a rounded surface that turns away from it, so that
// no edge of a triangle shows there; 1 where triangle and normal agree (Chiang et al. 2019,
// "Taming the shadow terminator").
float before_terminator(float nl, float cos_face, float cos_between) {
    float g = clamp(cos_face / max(nl * cos_between, 1e-9), 0.0, 1.0);
    return g * (1.0 + g * (1.0 - g));
}

// Reflectance at grazing angles: 1, but less where that at normal incidence is below any real
// surface's 2 %; a matte surface reflects nothing.
vec3 grazing(vec3 f0) {
    return vec3(clamp(50.0 * max(f0.r, max(f0.g, f0.b)), 0.0, 1.0));
}

// GGX distribution times height-correlated Smith visibility (Heitz 2014), with Schlick's
// Fresnel term: glTF 2.0, appendix B.3.
vec3 specular_brdf(float nl, float nv, float nh, float vh, float alpha, vec3 f0, vec3 f90) {
    float a2 = alpha * alpha;
    float d = nh * nh * (a2 - 1.0) + 1.0;
    float distribution = a2 / (PI * d * d);
    float visibility = 0.5 / (nl * sqrt(nv * nv * (1.0 - a2) + a2)
                              + nv * sqrt(nl * nl * (1.0 - a2) + a2));
    return distribution * visibility * (f0 + (f90 - f0) * pow(1.0 - vh, 5.0));
}

//!include sky_lookup.glsl

// Shares a and b of a uniform white sky, and a dielectric's mean: render/reflection.py.
vec3 shares(float mu, float roughness) {
    float last = float(textureSize(reflectance, 0).x - 1);
    vec2 at = vec2(sqrt(clamp(mu, 0.0, 1.0)), roughness) * last + 0.5;
    return texture(reflectance, at / (last + 1.0)).rgb;
}

// Gain by light that bounces between facets (Turquin 2019).
vec3 bounces(vec3 f0, vec2 share) {
    return 1.0 + f0 * (1.0 / (share.x + share.y) - 1.0);
}

// Share of the light that the coat of a dielectric reflects, all bounces.
float coat(vec2 share, float f0, float f90) {
    return (f0 * share.x + f90 * share.y) * (1.0 + f0 * (1.0 / (share.x + share.y) - 1.0));
}

// Mean radiance of the sky over the lobe of a roughness; a mirror's is the sky itself.
vec3 reflected_sky(vec3 d, float roughness) {
    if (roughness < level_roughness.x) {
        vec3 mirror = sky_on_side(sky, d, d.y > 0.0 ? 1.0 : -1.0) * sky_scale;
        vec3 blurred = textureLod(reflection, d, 0.0).rgb * reflection_scale;
        // Near a mirror the light from afar grows with alpha squared, the blur with alpha.
        return mix(mirror, blurred, pow(roughness / level_roughness.x, 3.0));
    }
    float level = 0.0;
    for (int k = 0; k < 3; ++k)
        level += clamp((roughness - level_roughness[k])
                       / (level_roughness[k + 1] - level_roughness[k]), 0.0, 1.0);
    return textureLod(reflection, d, level).rgb * reflection_scale;
}

// What a lobe shows of the sky: by the share of Fresnel's term that is the same from everywhere,
// and by that of grazing angles.
struct SkyImage {
    vec3 direct, grazing;
};

// Rough facets are seen from wherever they lie: their lobe stands about the normal, and no light
// comes from below the surface. At grazing angles another, narrower one stands about the mirror
// direction, and what the surface cuts off it moves its middle away from the surface. Directions
// and widths are fitted to the BRDF's integral under clear skies (test_reflection.py).
SkyImage sky_image(vec3 to_image, vec3 n, float nv, float roughness) {
    vec3 about = normalize(mix(to_image, n, roughness * roughness));
    float narrower = roughness * (0.8 - 0.36 * roughness);
    vec3 cut = normalize(to_image + 0.5 * narrower * max(0.0, 1.0 - nv / 0.7) * n);
    return SkyImage(reflected_sky(about, roughness), reflected_sky(cut, narrower));
}

#ifdef SURFACE_LIGHT
// Which share of the sky both lobes of `sky_image` see: that of the mean of a lobe's directions, for
// shares grow linearly with direction. The means are fitted to GGX lobes, to 0.1 (test_surface_light.py).
vec2 sky_seen(vec4 visible, float in_all, vec3 n, vec3 view, float nv, float roughness) {
    float r2 = roughness * roughness, straight = pow(1.0 - r2, 1.3);
    vec3 across = nv * n - view;
    float low = 0.62 * r2 / (r2 + 0.05), low_at_grazing = 0.35 * r2 / (r2 + 0.04);
    vec2 up = sqrt(vec2(low * low, low_at_grazing * low_at_grazing)
                   + nv * nv * vec2(straight * straight, (1.0 - roughness) * (1.0 - roughness)));
    vec3 direct = up.x * n + straight * across;
    vec3 at_grazing = up.y * n + (1.0 - 0.18 * roughness) * across;
    vec2 seen = visible.a + vec2(dot(visible.rgb, direct), dot(visible.rgb, at_grazing));
    // A lobe as wide as the hemisphere has all in it, of which a line says too much.
    return clamp(mix(seen, vec2(in_all), r2 * r2), 0.0, 1.0);
}
#endif

#ifdef MIRROR
//!include mirror.glsl
#endif

#ifdef CLOUD_SHADOWS
//!include cloud_block.glsl
//!include cloud_shadow.glsl
#endif

#ifdef AIR
//!include air.glsl
#endif

#ifdef LAMPS
//!include lamps.glsl
#endif

vec4 base_color() {
    vec4 base = material.base_color_factor;
#ifdef HAS_BASE_COLOR_TEX
#ifdef TEXCOORD_0_LOC
    base *= texture(material.base_color_texture, uv_of(base_color_layer));
#endif
#endif
#ifdef COLOR_0_LOC
    // Some rasterisers reach beyond the triangle for the centroid too.
    base *= clamp(vertex_color, 0.0, 1.0);
#endif
    return base;
}

#ifdef TERMS
//!include surface_terms.glsl
#endif

//!include direct_light.glsl

#ifdef CUT_OUT
//!include cut_out.glsl

// Leave out of the pixel's samples what is cut away.
void cover(float alpha) {
    float share = covered_share(material.base_color_texture, uv_of(base_color_layer), alpha);
    int samples = int(float(gl_NumSamples) * share + threshold());
    if (samples == 0) discard;
    // Another one first in each pixel.
    int first = (int(gl_FragCoord.x) + 2 * int(gl_FragCoord.y)) % gl_NumSamples;
    int mask = (1 << samples) - 1;
    gl_SampleMask[0] = (mask << first) | (mask >> (gl_NumSamples - first));
}
#endif

void main() {
    vec4 base = base_color();
#if defined(CUT_OUT) && defined(TEXCOORD_0_LOC)
    float alpha_of_map = texture(material.base_color_texture, uv_of(base_color_layer)).a;
#ifdef COLOR_0_LOC
    alpha_of_map *= clamp(vertex_color.a, 0.0, 1.0);
#endif
    cover(alpha_of_map);
#endif
    if (base.a < alpha_cutoff || base.a >= alpha_end) discard;
#ifdef UNLIT
    // As bright as level ground of its colour in the open.
    vec3 on_ground = sky_irradiance(vec3(0.0, 1.0, 0.0)) + sun_irradiance * max(sun_direction.y, 0.0);
    vec3 shown = base.rgb * on_ground / PI;
#ifdef AIR
    shown = through_air(shown, normalize(eye_to_sample), length(eye_to_sample), 1.0);
#endif
    frag_radiance = vec4(shown, mix(base.a, 1.0, opaque));
    return;
#endif
    float metallic = material.metallic_factor, roughness = material.roughness_factor;
    vec3 emission = material.emissive_factor;
    float occlusion = 1.0;
#ifdef TEXCOORD_0_LOC
#ifdef HAS_METALLIC_ROUGHNESS_TEX
    vec2 rough_metal = texture(material.metallic_roughness_texture, uv_of(metallic_roughness_layer)).rg;
    roughness *= rough_metal.r;
    metallic *= rough_metal.g;
#endif
#ifdef HAS_OCCLUSION_TEX
    float open = texture(material.occlusion_texture, uv_of(occlusion_layer)).r;
    occlusion = mix(1.0, open, occlusion_strength);
#endif
#ifdef HAS_EMISSIVE_TEX
    emission *= texture(material.emissive_texture, uv_of(emissive_layer)).rgb;
#endif
#endif
    roughness = clamp(roughness, 0.0, 1.0);
    float alpha = max(roughness * roughness, SMALLEST_ALPHA);
    vec3 coat_f0 = vec3(dielectric_f0);
    float coat_peak = dielectric_f0, coat_f90 = grazing(coat_f0).r;
#ifdef TERMS
    float clearcoat, transmission;
    look_up_terms(coat_f0, coat_f90, clearcoat, transmission);
    coat_peak = peak(coat_f0);
#endif
    vec3 f0 = mix(coat_f0, base.rgb, metallic);
    vec3 f90 = grazing(f0);
#ifdef TERMS
    f90 = mix(vec3(coat_f90), f90, metallic);
#endif
    vec3 albedo = base.rgb * (1.0 - metallic);
#ifdef GLASS
    transmission *= 1.0 - metallic;
    albedo *= 1.0 - transmission;
#ifdef HAS_TRANSMISSION_TEX
    if (transmission <= 0.0) discard;  // drawn among what is solid
#endif
#elif defined(HAS_TRANSMISSION_TEX)
    if (transmission > 0.0) discard;   // drawn after all that is solid
#endif

    vec3 view = normalize(-eye_to_sample);
    vec3 face = face_normal(view);
    bool behind;
    vec3 smooth_n = smooth_normal(face, behind);
    vec3 n = mapped_normal(smooth_n, view);
    float nv = max(dot(n, view), 1e-4);
    float nl = dot(n, sun_direction);
    float cos_face = dot(face, sun_direction);

#ifdef IRIDESCENCE
    f0 = under_film(f0, nv);
    coat_peak = peak(under_film(coat_f0, nv));
#endif
    vec3 share = shares(nv, roughness);
    vec3 more = bounces(f0, share.xy);
    // The coat transmits the rest to the paint below it (Kelemen and Szirmay-Kalos
    // 2001): reciprocal, and a white surface gives back all of any light.
    float through = 1.0 - coat(share.xy, coat_peak, coat_f90);
#ifdef SHEEN
    // Fibres take their light from all that is below them.
    float below_sheen = 1.0 - peak(terms.sheen_rgb) * sheen_share(nv);
    through *= below_sheen;
    more *= below_sheen;
#endif
#ifdef SURFACE_LIGHT
    Reached found = surface_light(face, smooth_n, n, behind);
    vec4 reached = found.light;
#ifndef LIGHT_MAP
    reached *= occlusion;  // of folds that are too fine for the light's own texels or probes
#endif
    vec3 diffuse = reached.rgb * through;
#else
    vec3 diffuse = sky_irradiance(n) * (occlusion * through);
#endif
    vec3 radiance = emission / LUMENS_PER_WATT;  // glTF gives emission in cd/m^2
    float mean = share.z * coat_f90;
#ifdef TERMS
    // In proportion: all at an f0 of 1, and the table's own at that of the table.
    mean += (coat_peak - TABLE_F0 * coat_f90) * (1.0 - share.z) / (1.0 - TABLE_F0);
    mean = min(mean, 0.999);
#endif
    Seen seen = Seen(n, smooth_n, view, nv, roughness, alpha, f0, f90, more, coat_peak, coat_f90,
                     through / (1.0 - mean), 0.0);
    vec3 highlights = vec3(0.0);  // of a second coat
#ifdef CLEARCOAT
    seen.clearcoat = clearcoat;
#endif
#ifdef NO_SKY
    // Shadow maps let the sun through where walls meet.
    nl = 0.0;
#endif
    if (nl > 0.0 && cos_face > 0.0) {
        float terminator = before_terminator(nl, cos_face, dot(n, face));
        vec3 sun = sun_irradiance * (terminator * sun_visibility(face));
#ifdef GLASS_SHADOW
        sun *= sun_through_glass(face);
#endif
#ifdef CLOUD_SHADOWS
        sun *= cloud_transmittance(eye_to_sample);
#endif
        add_light(sun, sun_direction, nl, seen, diffuse, radiance, highlights);
    }
#ifdef LAMPS
    for (int number = 0; number < int(lamps.count); ++number) {
        vec3 towards, lamp = lamp_irradiance(number, point_in_triangle(face), face, towards);
        float cosine = dot(n, towards);
        if (cosine > 0.0 && lamp != vec3(0.0)) {
            lamp *= before_terminator(cosine, dot(face, towards), dot(n, face));
            add_light(lamp, towards, cosine, seen, diffuse, radiance, highlights);
        }
    }
#endif
    radiance += albedo * diffuse / PI;
    vec3 once = f0 * share.x, at_grazing = f90 * share.y;
    vec3 mirror_n = n;
#ifdef ANISOTROPY
    mirror_n = bent_normal(n, view, roughness);
#endif
    vec3 to_image = reflect(-view, mirror_n);
#ifdef SURFACE_LIGHT
    if (coat_f90 + metallic > 0.0) {
        SkyImage far = sky_image(to_image, mirror_n, nv, roughness);
        vec3 far_light = once * far.direct + at_grazing * far.grazing;
        // Of the sky the share that is seen where each lobe looks; all else that arrives comes
        // evenly from where the sky is not.
        vec3 around = max(reached.rgb - reached.a * open_irradiance(n), 0.0) / PI;
        float sky_in_all = max(found.sky.a + dot(found.sky.rgb, n) * 2.0 / 3.0, 1e-4);
        vec2 seen = sky_seen(found.sky, sky_in_all, n, view, nv, roughness);
        // What is seen of the sky may be brighter than the lobe's own image of all of it.
        float brighter = mix(1.0, min(reached.a / sky_in_all, 4.0), roughness * roughness);
        vec2 things = (1.0 - seen + FEWEST_THINGS) / (1.0 - min(sky_in_all, 1.0) + FEWEST_THINGS);
        seen *= brighter;
        vec3 mirrored = once * (seen.x * far.direct + things.x * around);
        mirrored += at_grazing * (seen.y * far.grazing + things.y * around);
#ifdef MIRROR
        vec4 image = mirror_image(eye_to_sample, to_image, alpha);
        vec3 imaged = (once + at_grazing) * image.rgb + (1.0 - image.a) * far_light;
        mirrored = mix(imaged, mirrored, mirror_fade(roughness));
#endif
        radiance += more * mirrored;
    }
#else
    SkyImage far = sky_image(to_image, mirror_n, nv, roughness);
    radiance += more * occlusion * (once * far.direct + at_grazing * far.grazing);
#endif
#ifdef SHEEN
#ifdef SURFACE_LIGHT
    vec3 on_sheen = reached.rgb;
#else
    vec3 on_sheen = sky_irradiance(n) * occlusion;
#endif
    radiance += terms.sheen_rgb * sheen_share(nv) * on_sheen / PI;
#endif
#ifdef GLASS
    // The coat reflects; of what it lets in, what is behind is seen, tinted by the base colour.
    vec3 tint = base.rgb * (transmission * through);
#ifdef BACKDROP
    radiance += tint * seen_through(eye_to_sample, n, view, roughness);
    tint = vec3(0.0);
#endif
#endif
#ifdef CLEARCOAT
    radiance = under_clearcoat(
        radiance, clearcoat, smooth_n, view, highlights,
#ifdef SURFACE_LIGHT
        reached.a * reflected_sky(reflect(-view, smooth_n), terms.clearcoat_roughness)
            + max(reached.rgb - reached.a * open_irradiance(smooth_n), 0.0) / PI
#else
        occlusion * reflected_sky(reflect(-view, smooth_n), terms.clearcoat_roughness)
#endif
    );
#ifdef GLASS
    tint *= 1.0 - clearcoat * clearcoat_share(max(dot(smooth_n, view), 1e-4));
#endif
#endif
#ifdef AIR
    float metres = length(eye_to_sample), lit_air = 1.0;
#ifdef SURFACE_LIGHT
    lit_air = light_in_air(reached.a, metres);
#endif
    radiance = through_air(radiance, -view, metres, lit_air);
#endif
#ifdef GLASS
    // A blended pane is there by the share alpha.
    frag_radiance = vec4(radiance * base.a, 1.0);
    share_of_behind = vec4(mix(vec3(1.0), tint, base.a), 1.0);
#else
    frag_radiance = vec4(radiance, mix(base.a, 1.0, opaque));
#endif
}
