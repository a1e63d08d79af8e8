#version 430 core
// Air in the direction of each node of a picture, over a distance that represents all near ones;
// sampled by near_air.glsl. The outer nodes lie on the picture's edges.

uniform float metres;

in vec3 ray;
layout(location = 0) out vec4 mean_radiance;   // mean along the ray, as in `AirVolume`
layout(location = 1) out vec4 mean_extinction; // m^-1

//!include air.glsl

void main() {
    AirRay seen = air_ray(normalize(ray));
    float inside_m = metres_in_air(seen, metres), slice = slice_at(seen, inside_m);
    vec3 light = shaded_mean(seen, slice) + sunlit_mean(seen, slice);
    mean_radiance = vec4(light * air.radiance_scale, 1.0);
    mean_extinction = vec4(optical_depth_of(seen, inside_m) / inside_m, 1.0);
}
