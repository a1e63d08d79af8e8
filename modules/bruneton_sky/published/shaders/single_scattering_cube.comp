#version 430
// Single scattering around one observer as a cube map in world axes, linear sRGB. Below the
// horizon the air in front of the ground, and the ground through it.

#include "single_scattering.glsl"
#include "cube.glsl"

layout(local_size_x = 8, local_size_y = 8) in;
layout(binding = 0) writeonly uniform imageCube sky;

uniform int faces[6];               // which face each layer of work groups writes
uniform vec3 sun;                   // unit vector
uniform float observer_altitude_m;
uniform vec3 sky_rgb_scale;         // from radiance at the three wavelengths to linear sRGB
uniform vec3 ground_rgb;            // radiance of the ground, linear sRGB
uniform bool half_precision;        // whether the texels are halves

vec3 radiance(vec3 direction) {
    float mu = clamp(direction.y, -1.0, 1.0);
    float nu = clamp(dot(direction, sun), -1.0, 1.0);
    vec3 rgb = sky_rgb_scale * single_scattering(observer_altitude_m, mu, sun.y, nu);
    Ray ray = make_ray(observer_altitude_m, mu);
    if (hits_ground(ray)) {
        rgb += ground_rgb * exp(-optical_depth_to(ray, end_of(ray)));
    }
    return rgb;
}

void main() {
    ivec2 at = ivec2(gl_GlobalInvocationID.xy);
    int size = imageSize(sky).x;
    if (any(greaterThanEqual(at, ivec2(size)))) {
        return;
    }
    int face = faces[gl_WorkGroupID.z];
    vec3 rgb = radiance(texel_direction(face, at, size));
    rgb = half_precision ? rounded_to_half(rgb) : rgb;
    imageStore(sky, ivec3(at, face), vec4(rgb, 1.0));
}
