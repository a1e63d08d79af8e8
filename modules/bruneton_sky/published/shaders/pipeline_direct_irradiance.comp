#version 430
// Algorithm 3: what the sun's disc sheds on a level surface. The sky has shed nothing as yet.

#include "pipeline_air.glsl"
#include "pipeline_lengths.glsl"
#include "pipeline_rays.glsl"
#include "pipeline_optical_depth.glsl"

layout(local_size_x = 8, local_size_y = 8) in;
layout(rgba32f, binding = 0) writeonly uniform image2D made;
layout(rgba32f, binding = 1) writeonly uniform image2D irradiance;

// Mean cosine over a disc of which a level surface cuts a part: a parabola between all and none.
float disc_cosine(float mu_s) {
    float a = sun_angular_radius;
    float rising = (mu_s + a) * (mu_s + a) / (4.0 * a);
    return mu_s < -a ? 0.0 : mu_s > a ? mu_s : rising;
}

void main() {
    const ivec2 size = ivec2(IRRADIANCE_MU_S, IRRADIANCE_ALTITUDE);
    ivec2 at = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(at, size))) {
        return;
    }
    vec2 unit = vec2(at) / vec2(size - 1);
    float altitude = unit.y * top_altitude_m;
    float mu_s = 2.0 * unit.x - 1.0;
    vec4 clear = value(transmittance_to_top(towards(altitude, mu_s)));
    imageStore(made, at, solar_irradiance * clear * disc_cosine(mu_s));
    imageStore(irradiance, at, vec4(0.0));
}
