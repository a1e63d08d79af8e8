// Reflection by a surface's facets, of light from one direction and of uniform light.

layout(binding = 11) uniform sampler2D reflectance;   // render/reflection.py's table

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
