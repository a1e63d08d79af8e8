#version 430 core
// Radiance of a metallic-roughness surface (glTF 2.0, appendix B) under sun and sky,
// linear sRGB in W m^-2 sr^-1: nothing is exposed or tone-mapped here.

const float PI = 3.141592653589793;
const float LUMENS_PER_WATT = 683.0;
const float MOST_TILTED = 2.0;       // largest change of reflected light by a normal map
const float FEWEST_THINGS = 0.05;    // share of all directions, regularises the density of things
const float SMALLEST_ALPHA = 0.005;  // about the blur of a mirror image by the sun's radius
const float HOLDS_RAD = 2.0;         // view angle over which a coat of roughness 1 looks alike
const float EDGE = 0.49;             // largest difference from half of the sun within a penumbra
const float GLINTS_COUNT = 7.0;      // additional weight of highlights in a coat's radiance

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
uniform float alpha_cutoff;          // fragments below are discarded; 0 for opaque and blended
uniform float alpha_end;             // and from it on: opaque texels are drawn before
uniform float opaque;                // 1: alpha is ignored
uniform int base_color_layer;        // set of texture coordinates, 0 or 1
uniform int metallic_roughness_layer;
uniform int normal_layer;
uniform int occlusion_layer;
uniform int emissive_layer;
uniform float normal_scale;
uniform float occlusion_strength;
uniform float dielectric_f0;         // reflectance of dielectrics at normal incidence
const float TABLE_F0 = 0.04;         // f0 of the table's means

uniform vec3 sun_direction;          // towards the sun
uniform vec3 sun_irradiance;         // on a plane that faces it
uniform int picture_number;          // of the pictures averaged into a still
uniform int picture_count;
// Share of a still's pictures drawn before this one: dithers move by it, and their grain averages out.
#define PICTURE_SHARE (float(picture_number) / float(picture_count))

#ifdef FROM_BUFFER
#undef TEXCOORD_0_LOC
#undef TEXCOORD_1_LOC
#define eye_to_sample eye_to_point
#else
in vec3 eye_to_point;                // at the pixel's centre, for derivatives
#ifdef ONE_SAMPLE
#define eye_to_sample eye_to_point
#else
centroid in vec3 eye_to_sample;      // inside the triangle, also at its edge
#endif
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
#ifdef TANGENT_LOC
centroid in vec2 place_px;           // in the mesh's chart
#endif
#endif

#ifdef TO_BUFFER
out uvec4 attributes;
#elif defined(GLASS)
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

#if defined(TO_BUFFER) || defined(FROM_BUFFER)
//!include surface_buffer.glsl
#endif

//!include normals.glsl
//!include sky_irradiance.glsl
//!include light_of_surface.glsl
//!include sun_shadow.glsl
//!include facets.glsl
//!include sky_reflection.glsl
//!include polarised_sky.glsl

#ifdef SUN_FACTOR
//!include sun_factor.glsl
#endif

#ifdef THROUGH_AIR
//!include through_air.glsl
#endif

#ifdef EXTRA_LIGHTS
//!include extra_lights.glsl
#endif

vec4 base_color() {
    vec4 base = material.base_color_factor;
#ifdef HAS_BASE_COLOR_TEX
#ifdef TEXCOORD_0_LOC
    base *= texture(material.base_color_texture, uv_of(base_color_layer));
#endif
#endif
#ifdef COLOR_0_LOC
    // Some rasterisers extrapolate beyond the triangle even for a centroid.
    base *= clamp(vertex_color, 0.0, 1.0);
#endif
    return base;
}

#ifdef ILLUMINANCE
//!include illuminance.glsl
#endif

#ifdef TERMS
//!include surface_terms.glsl
#endif

//!include direct_light.glsl

#ifdef CUT_OUT
//!include cover_samples.glsl
#endif

#ifdef TO_BUFFER
// Attributes of an opaque surface without maps; its light follows FROM_BUFFER.
void main() {
    vec3 view = normalize(-eye_to_point), face = face_normal(view);
    bool behind;
    vec3 n = smooth_normal(face, behind);
    vec2 in_chart_px = vec2(0.0);
#ifdef TANGENT_LOC
    in_chart_px = place_px;
#endif
    // Without these defines nothing reads them.
    float ray_change = 0.0, place_change = 0.0;
#ifdef MIRROR
    ray_change = change_of_ray(reflect(-view, n));
#endif
#ifdef VIEW_LIGHT
    place_change = change_of_place(in_chart_px);
#endif
    vec2 changes = vec2(ray_change, place_change);
    attributes = packed_surface(behind ? -n : n, face, in_chart_px, changes);
}
#else
void main() {
#ifdef FROM_BUFFER
    read_surface();
#endif
    vec4 base = base_color();
#if defined(CUT_OUT) && defined(TEXCOORD_0_LOC)
    float alpha_of_map = texture(material.base_color_texture, uv_of(base_color_layer)).a;
#ifdef COLOR_0_LOC
    alpha_of_map *= clamp(vertex_color.a, 0.0, 1.0);
#endif
    cover(alpha_of_map);
#endif
#ifndef SOLID
    // Without discard a software renderer rejects hidden fragments at a third of the cost.
    if (base.a < alpha_cutoff || base.a >= alpha_end) discard;
#endif
#ifdef ILLUMINANCE
    vec3 towards_eye = normalize(-eye_to_sample), seen_face = face_normal(towards_eye);
    bool from_behind;
    vec3 seen_n = smooth_normal(seen_face, from_behind);
    frag_radiance = vec4(irradiance_of(seen_face, seen_n, from_behind), 1.0);
    return;
#endif
#ifdef UNLIT
    // Radiance of level ground of this colour in the open.
    vec3 on_ground = sky_irradiance(vec3(0.0, 1.0, 0.0)) + sun_irradiance * max(sun_direction.y, 0.0);
    vec3 shown = base.rgb * on_ground / PI;
#ifdef THROUGH_AIR
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
    if (transmission <= 0.0) discard;  // drawn with opaque surfaces
#endif
#elif defined(HAS_TRANSMISSION_TEX)
    if (transmission > 0.0) discard;   // drawn after opaque surfaces
#endif

    float holds_rad = 1.0;  // view angle over which the radiance is valid
    bool at_edge = false;   // of a shadow: stored in the sign of alpha

    vec3 view = normalize(-eye_to_sample);
    vec3 face = face_normal(view);
    bool behind;
    vec3 smooth_n = smooth_normal(face, behind);
    vec3 n = mapped_normal(smooth_n, view);
    float nv = max(dot(n, view), 1e-4);
    float nl = dot(n, sun_direction);
    float cos_face = dot(face, sun_direction);

#ifdef MATTE
    vec3 share = vec3(0.0), more = vec3(1.0);
    float through = 1.0;
#else
#ifdef IRIDESCENCE
    f0 = under_film(f0, nv);
    coat_peak = peak(under_film(coat_f0, nv));
#endif
    vec3 share = shares(nv, roughness);
    vec3 more = bounces(f0, share.xy);
    // The coat transmits the rest to the paint below it (Kelemen and Szirmay-Kalos
    // 2001): reciprocal, and a white surface loses no energy.
    float through = 1.0 - coat(share.xy, coat_peak, coat_f90);
#endif
#ifdef SHEEN
    // Light reflected by fibres is lost to all layers below.
    float below_sheen = 1.0 - peak(terms.sheen_rgb) * sheen_share(nv);
    through *= below_sheen;
    more *= below_sheen;
#endif
#ifdef IRRADIANCE
    Reached found = surface_light(face, smooth_n, n, behind, occlusion);
    vec4 reached = found.light;
    vec3 diffuse = reached.rgb * through;
#else
    vec3 diffuse = sky_irradiance(n) * (occlusion * through);
#endif
    vec3 radiance = emission / LUMENS_PER_WATT;  // glTF gives emission in cd/m^2
    float mean = share.z * coat_f90;
#ifdef TERMS
    // Linear in f0: 1 at an f0 of 1, the table's mean at the table's f0.
    mean += (coat_peak - TABLE_F0 * coat_f90) * (1.0 - share.z) / (1.0 - TABLE_F0);
    mean = min(mean, 0.999);
#endif
    Polarised by = polarised_reflection(n, view, coat_peak, metallic, roughness);
    Seen seen = Seen(n, smooth_n, view, nv, roughness, alpha, f0, f90, more * by.passed, coat_peak,
                     coat_f90, through / (1.0 - mean), 0.0);
    vec3 highlights = vec3(0.0);  // of a second coat
#ifdef CLEARCOAT
    seen.clearcoat = clearcoat;
#endif
#ifdef NO_SKY
    // Shadow maps leak sunlight where walls meet.
    nl = 0.0;
#endif
    if (nl > 0.0 && cos_face > 0.0) {
        float terminator = before_terminator(nl, cos_face, dot(n, face));
        float lit = sun_visibility(face);
        at_edge = abs(lit - 0.5) < EDGE;
        vec3 sun = sun_irradiance * (terminator * lit);
#ifdef GLASS_SHADOW
        sun *= sun_through_glass(face);
#endif
#ifdef SUN_FACTOR
        sun *= sun_factor(eye_to_sample);
#endif
        add_light(sun, sun_direction, nl, seen, diffuse, radiance, highlights);
    }
#ifdef EXTRA_LIGHTS
    for (int number = 0; number < extra_light_count(); ++number) {
        vec3 towards, extra = extra_light(number, point_in_triangle(face), face, towards);
        float cosine = dot(n, towards);
        if (cosine > 0.0 && extra != vec3(0.0)) {
            extra *= before_terminator(cosine, dot(face, towards), dot(n, face));
            add_light(extra, towards, cosine, seen, diffuse, radiance, highlights);
        }
    }
#endif
    vec3 of_paint = albedo * diffuse / PI, glints = radiance - emission / LUMENS_PER_WATT;
    radiance += of_paint;
#ifndef MATTE
    vec3 once = f0 * share.x, at_grazing = f90 * share.y;
    vec3 mirror_n = n;
#ifdef ANISOTROPY
    mirror_n = bent_normal(n, view, roughness);
#endif
    vec3 to_image = reflect(-view, mirror_n);
#ifdef IRRADIANCE
    if (coat_f90 + metallic > 0.0) {
        SkyImage far = sky_image(to_image, mirror_n, nv, roughness);
        vec3 far_light = once * far.direct + at_grazing * far.grazing;
        // Visible share of the sky in each lobe; all other light arrives evenly from directions
        // without sky.
        vec3 around = max(reached.rgb - reached.a * open_irradiance(n), 0.0) / PI;
        float sky_in_all = max(found.sky.a + dot(found.sky.rgb, n) * 2.0 / 3.0, 1e-4);
        vec2 of_sky = sky_seen(found.sky, sky_in_all, n, view, nv, roughness);
        // The visible part of the sky may be brighter than the lobe's image of the whole sky.
        float brighter = mix(1.0, min(reached.a / sky_in_all, 4.0), roughness * roughness);
        vec2 things = (1.0 - of_sky + FEWEST_THINGS) / (1.0 - min(sky_in_all, 1.0) + FEWEST_THINGS);
        vec2 seen = of_sky * brighter;
        vec3 mirrored = once * (seen.x * far.direct + things.x * around);
        mirrored += at_grazing * (seen.y * far.grazing + things.y * around);
#ifdef LOBES
        if (found.mirrors) {
#ifdef HAS_NORMAL_TEX
            // Lobes ignore normal maps: a tilt changes them as it changes the sky's image.
            float even_nv = max(dot(smooth_n, view), 1e-4);
            SkyImage even = sky_image(reflect(-view, smooth_n), smooth_n, even_nv, roughness);
            found.direct *= mix(vec3(1.0), ratio(far.direct, even.direct, MOST_TILTED), of_sky.x);
            found.grazing *= mix(vec3(1.0), ratio(far.grazing, even.grazing, MOST_TILTED), of_sky.y);
#endif
            mirrored = once * found.direct + at_grazing * found.grazing;
        }
#endif
        mirrored = polarised(by, mirrored, once * of_sky.x + at_grazing * of_sky.y);
#ifdef MIRROR
        vec4 image = mirror_image(eye_to_sample, to_image, mirror_n, nv, alpha);
        vec3 imaged = (once + at_grazing) * image.rgb + (1.0 - image.a) * far_light;
        imaged = polarised(by, imaged, (once + at_grazing) * (1.0 - image.a));
        mirrored = mix(imaged, mirrored, mirror_fade(roughness));
#endif
        radiance += more * mirrored;
    }
#else
    SkyImage far = sky_image(to_image, mirror_n, nv, roughness);
    radiance += more * occlusion
        * polarised(by, once * far.direct + at_grazing * far.grazing, once + at_grazing);
#endif
    // A wide lobe changes slowly with the view and blurs all but sun and extra lights.
    vec3 of_coat = radiance - of_paint - emission / LUMENS_PER_WATT + GLINTS_COUNT * glints;
    float share_of_coat = dot(of_coat, vec3(1.0)) / max(dot(radiance, vec3(1.0)), 1e-30);
    holds_rad = min(HOLDS_RAD * roughness * roughness * roughness / max(share_of_coat, 1e-3), 1.0);
#endif
#ifdef SHEEN
#ifdef IRRADIANCE
    vec3 on_sheen = reached.rgb;
#else
    vec3 on_sheen = sky_irradiance(n) * occlusion;
#endif
    radiance += terms.sheen_rgb * sheen_share(nv) * on_sheen / PI;
#endif
#ifdef GLASS
    // The coat reflects; the rest transmits the background, tinted by the base colour.
    vec3 tint = base.rgb * (transmission * through);
#ifdef BACKDROP
    radiance += tint * seen_through(eye_to_sample, n, view, roughness);
    tint = vec3(0.0);
#endif
#endif
#ifdef CLEARCOAT
    vec3 on_coat = reflected_sky(reflect(-view, smooth_n), terms.clearcoat_roughness);
    Polarised by_coat =
        polarised_reflection(smooth_n, view, TABLE_F0, 0.0, terms.clearcoat_roughness);
#ifdef IRRADIANCE
    vec3 beside_sky = max(reached.rgb - reached.a * open_irradiance(smooth_n), 0.0) / PI;
    on_coat = polarised(by_coat, reached.a * on_coat + beside_sky, vec3(reached.a));
#else
    on_coat = occlusion * polarised(by_coat, on_coat, vec3(1.0));
#endif
    radiance = under_clearcoat(radiance, clearcoat, smooth_n, view, highlights * by_coat.passed,
                               on_coat);
#ifdef GLASS
    tint *= 1.0 - clearcoat * clearcoat_share(max(dot(smooth_n, view), 1e-4));
#endif
#endif
#ifdef THROUGH_AIR
    float metres = length(eye_to_sample), lit_air = 1.0;
#ifdef IRRADIANCE
    lit_air = light_in_air(reached.a, metres);
#endif
    radiance = through_air(radiance, -view, metres, lit_air);
#endif
#ifdef GLASS
    // Alpha is the coverage of a blended pane.
    frag_radiance = vec4(radiance * base.a, 1.0);
    share_of_behind = vec4(mix(vec3(1.0), tint, base.a), 1.0);
#else
    frag_radiance = vec4(radiance, mix(base.a, at_edge ? -holds_rad : holds_rad, opaque));
#endif
}
#endif
