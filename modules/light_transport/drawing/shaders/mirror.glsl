// The surroundings of a glossy part as a cube map seen from its middle: radiance weighed by
// alpha, the share that is neither sky nor open ground. reflection_probes.py uploads it.

//!sampler samplerCube mirror
// One over distances, 1/m.
//!sampler samplerCube mirror_nearness
uniform vec3 mirror_eye_m;  // the eye, from the middle

const int MIRROR_STEPS = 4;
const float MIRROR_FARTHEST = 4.0;  // ground reaches beyond the scene
// Middles of the four quarters of a GGX lobe in the plane of the view, in alpha, and how narrow a
// quarter is, of its width across.
const float MIRROR_ASIDE[4] = float[4](-2.27, -0.52, 0.52, 2.27);
const float MIRROR_NARROWEST = 0.35;
// Rougher than this, light comes from all around rather than from an image.
const vec2 MIRROR_FADES = vec2(0.4, 0.6);

float mirror_fade(float roughness) {
    return smoothstep(MIRROR_FADES.x, MIRROR_FADES.y, roughness);
}

// Where a ray from p in direction d ends, as seen from the middle, and in w how far it goes: there
// the distance from the middle is the cube's. A place before and one behind are brought together
// by false position, which halves the value of an end that stays (Dowell and Jarratt 1971,
// "Illinois"): fixed-point steps (Szirmay-Kalos et al. 2005) never arrive in long rooms.
vec4 mirrored_place(vec3 p, vec3 d) {
    float before = 0.0, behind = MIRROR_FARTHEST * surface.scene_m;
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

// Radiance along a ray from a point relative to the eye, blurred by the lobe of an alpha about it.
// n is the normal that mirrors it, nv its cosine with the view.
vec4 mirror_image(vec3 point, vec3 d, vec3 n, float nv, float alpha) {
    vec4 place = mirrored_place(mirror_eye_m + point, d);
    // Texels across half a pixel, and across the lobe there: some 3.5 alpha along the plane of the
    // view, and across it by the cosine less.
    float edge = float(textureSize(mirror, 0).x), away = place.w / length(place.xyz);
    float pixel = 0.25 * edge * sqrt(change_of_ray(d));
    float lobe = sqrt(6.0) * edge * alpha * away;
    vec3 along = n - dot(n, d) * d;
    along *= inversesqrt(max(dot(along, along), 1e-8)) * place.w * alpha;
    float level = log2(max(max(lobe * max(nv, MIRROR_NARROWEST), pixel), 1.0));
    vec4 seen = vec4(0.0);
    float all = 0.0;
    for (int i = 0; i < 4; ++i) {
        // A quarter of the lobe each; the surface itself hides the rest.
        float aside = MIRROR_ASIDE[i];
        float there = dot(n, d) + aside * alpha > 0.0 ? 1.0 : 0.0;
        seen += there * textureLod(mirror, place.xyz + aside * along, level);
        all += there;
    }
    seen /= max(all, 1.0);
    return vec4(seen.rgb * surface.radiance_scale, seen.a);
}
