// Reflection of light from one direction, the sun's or an extra light's.

// A visible surface. `more` is the gain by bounces between facets; `through` the share of light
// that leaves the paint through the coat, over the share of uniform light that enters.
struct Seen {
    vec3 n;
    vec3 smooth_n;
    vec3 view;
    float nv;
    float roughness;
    float alpha;
    vec3 f0;
    vec3 f90;
    vec3 more;
    float coat_peak;
    float coat_f90;
    float through;
    float clearcoat;
};

// Add light on the paint to `diffuse`, the coat's reflection to `radiance` and the clearcoat's to
// `highlights`. `light` is the irradiance of a plane that faces it, nl its cosine.
void add_light(vec3 light, vec3 towards, float nl, Seen seen, inout vec3 diffuse,
               inout vec3 radiance, inout vec3 highlights) {
#ifdef CLEARCOAT
    highlights += clearcoat_highlight(light, towards, seen.clearcoat, seen.smooth_n, seen.view);
    light *= below_clearcoat(seen.clearcoat, dot(seen.smooth_n, towards));
#endif
    light *= nl;
#ifdef MATTE
    diffuse += light;
#else
    vec2 share = shares(nl, seen.roughness).xy;
    diffuse += light * (seen.through * (1.0 - coat(share, seen.coat_peak, seen.coat_f90)));
    // Rounding takes cosines of unit vectors past 1: opposite the sun, where view and h are equal.
    vec3 h = normalize(towards + seen.view);
    float nh = clamp(dot(seen.n, h), 0.0, 1.0), vh = clamp(dot(seen.view, h), 0.0, 1.0);
#ifdef ANISOTROPY
    radiance += light * seen.more
        * stretched_brdf(seen.n, towards, seen.view, h, nl, seen.nv, vh, seen.alpha, seen.f0,
                         seen.f90);
#else
    radiance += light * seen.more
        * specular_brdf(nl, seen.nv, nh, vh, seen.alpha, seen.f0, seen.f90);
#endif
#ifdef SHEEN
    radiance += light * sheen_brdf(nl, seen.nv, nh);
#endif
#endif
}
