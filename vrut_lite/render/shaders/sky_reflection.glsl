// Reflection of the sky by glossy surfaces.

layout(binding = 8) uniform samplerCube sky;
uniform float sky_scale;
layout(binding = 10) uniform samplerCube reflection;  // the sky over lobes, a mip level each
uniform float reflection_scale;
uniform vec4 level_roughness;

//!include sky_lookup.glsl

// Mean radiance of the sky over the lobe of a roughness; a mirror's is the sky itself.
vec3 reflected_sky(vec3 d, float roughness) {
    float level = 0.0;
    for (int k = 0; k < 3; ++k)
        level += clamp((roughness - level_roughness[k])
                       / (level_roughness[k + 1] - level_roughness[k]), 0.0, 1.0);
    vec3 seen = textureLod(reflection, d, level).rgb * reflection_scale;
#ifndef BLURRED
    // A loop, since a software renderer executes both sides of an `if`.
    for (int once = roughness < level_roughness.x ? 1 : 0; once > 0; --once) {
        vec3 mirror = sky_on_side(sky, d, d.y > 0.0 ? 1.0 : -1.0) * sky_scale;
        // Near a mirror the light from afar grows with alpha squared, the blur with alpha.
        seen = mix(mirror, seen, pow(roughness / level_roughness.x, 3.0));
    }
#endif
    return seen;
}

// Mean radiance of the sky over a lobe, for the constant part of Fresnel's term and for its part at
// grazing angles.
struct SkyImage {
    vec3 direct, grazing;
};

// Rough facets are visible at all orientations: their lobe is centred on the normal, and no light
// comes from below the surface. At grazing angles a narrower lobe is centred on the mirror
// direction; the surface cuts part of it off, which moves its centre away from the surface.
// Directions and widths are fitted to the BRDF's integral under clear skies (test_reflection.py).
SkyImage sky_image(vec3 to_image, vec3 n, float nv, float roughness) {
    vec3 about = normalize(mix(to_image, n, roughness * roughness));
    float narrower = roughness * (0.8 - 0.36 * roughness);
    vec3 cut = normalize(to_image + 0.5 * narrower * max(0.0, 1.0 - nv / 0.7) * n);
    return SkyImage(reflected_sky(about, roughness), reflected_sky(cut, narrower));
}

#ifdef IRRADIANCE
// Visible shares of the sky in both lobes of `sky_image`: those of a lobe's mean direction, since
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
    // A lobe as wide as the hemisphere contains the whole sky; the linear estimate is too large.
    return clamp(mix(seen, vec2(in_all), r2 * r2), 0.0, 1.0);
}
#endif
