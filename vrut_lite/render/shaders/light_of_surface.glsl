// Light on a surface by a frame part, in place of the open sky's irradiance.

#ifdef IRRADIANCE
// Light without the direct sun: RGB irradiance in W m^-2, and in alpha the share of the open sky that
// arrives. `sky`: b and a of the share a + b . d of the sky that is seen in direction d. Where a part
// `mirrors`, also the mean radiance that a coat or metal mirrors, by both parts of Schlick's term.
struct Reached {
    vec4 light;
    vec4 sky;
    bool mirrors;
    vec3 direct, grazing;
};

vec3 ratio(vec3 wanted, vec3 had, float most) {
    return clamp((wanted + 1e-20) / (had + 1e-20), 1.0 / most, most);
}

// The part defines, with vectors in world axes:
// * Reached surface_light(vec3 face, vec3 smooth_n, vec3 n, bool behind, float occlusion): light of
//   the fragment, by the normals of triangle, vertices and normal map; whether its back is seen;
//   and what an occlusion map leaves of the light
// * vec3 open_irradiance(vec3 n): as sky_irradiance, which costs more
// * float light_in_air(float share_of_sky, float metres): share of the light in open air that is in
//   the air before a surface at this distance, which gets this share of the sky's
// * with the define MIRROR: vec4 mirror_image(vec3 point, vec3 d, vec3 n, float nv, float alpha),
//   radiance of the surroundings and their cover over a lobe from a point relative to the eye, and
//   float mirror_fade(float roughness), from 0 where that image shows to 1 where it does not
// * the macro LOBES, where `mirrors` may be true
// Derivatives across pixels may span two surfaces (FROM_BUFFER): change_of_ray and change_of_place of
// normals.glsl do not.
// With the define NO_SKY neither sky nor sun reaches the surface.
//!include irradiance.glsl
#endif
