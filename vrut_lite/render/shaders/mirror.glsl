// The surroundings of a glossy part as a cube map seen from its middle: radiance weighed by
// alpha, the share that is neither sky nor open ground. render/mirror_cubes.py uploads it.

layout(binding = 16) uniform samplerCube mirror;
layout(binding = 17) uniform samplerCube mirror_nearness;  // one over distances, 1/m
uniform vec3 mirror_eye_m;                                 // the eye, from the middle

const int MIRROR_STEPS = 3;  // they swing around the place: an odd number ends nearer to it
// Rougher than this, light comes from all around rather than from an image.
const vec2 MIRROR_FADES = vec2(0.4, 0.6);

float mirror_fade(float roughness) {
    return smoothstep(MIRROR_FADES.x, MIRROR_FADES.y, roughness);
}

// Radiance along a ray from a point relative to the eye, blurred by the lobe of an alpha.
vec4 mirror_image(vec3 point, vec3 d, float alpha) {
    // The ray ends where its distance from the middle equals the cube's in that direction: found
    // step by step (Szirmay-Kalos et al. 2005, "Approximate ray-tracing on the GPU with distance
    // impostors").
    vec3 p = mirror_eye_m + point, towards = d;
    float along = dot(p, d), missed = along * along - dot(p, p);
    for (int i = 0; i < MIRROR_STEPS; ++i) {
        float near = textureLod(mirror_nearness, towards, 0.0).r;
        float reach = sqrt(max(missed * near * near + 1.0, 0.0)) - along * near;
        towards = p * near + d * max(reach, 0.0);
    }
    // Texels across the lobe, whose solid angle is some 4 pi alpha^2, and across half a pixel.
    float edge = float(textureSize(mirror, 0).x);
    vec3 right = dFdx(d), down = dFdy(d);
    float pixel = 0.25 * edge * sqrt(max(dot(right, right), dot(down, down)));
    float lobe = sqrt(6.0) * edge * alpha;
    vec4 seen = textureLod(mirror, towards, log2(max(max(lobe, pixel), 1.0)));
    return vec4(seen.rgb * surface.radiance_scale, seen.a);
}
