#version 430
// Algorithm 6: what the sky's light of one order sheds on a level surface. A work group has one
// node of the table, and each of its threads one azimuth of the sky; azimuth 0 is the sun's.

#include "pipeline_air.glsl"
#include "pipeline_lengths.glsl"
#include "pipeline_scattering_look_up.glsl"

const int ZENITHS = IRRADIANCE_ZENITH_ANGLES;
const int AZIMUTHS = IRRADIANCE_AZIMUTHS;
const float STEP = PI / float(ZENITHS);

layout(local_size_x = IRRADIANCE_AZIMUTHS) in;
layout(binding = 1) uniform sampler3D light;        // of the order before
layout(binding = 2) uniform sampler3D single_mie;
layout(rgba32f, binding = 0) writeonly uniform image2D made;
layout(rgba32f, binding = 1) uniform image2D irradiance;
// Light scattered once comes in two tables that lack their phase functions.
uniform bool scattered_once;

shared vec4 from_azimuth[AZIMUTHS];

vec4 arriving(float h, float mu, float nu, float sun_place) {
    float along = mu_place(h, longest_to_top(h) - length_to_top(h, mu), false);
    vec4 place = vec4(sun_place, nu_place(nu), along, altitude_place(h));
    vec4 radiance = look_up(light, place);
    if (scattered_once) {
        radiance *= rayleigh_phase_at(nu);
        radiance += look_up(single_mie, place) * mie_phase_at(nu);
    }
    return radiance;
}

void main() {
    ivec2 at = ivec2(gl_WorkGroupID.xy);
    float h = float(at.y) / float(IRRADIANCE_ALTITUDE - 1) * top_altitude_m;
    float unit = float(at.x) / float(IRRADIANCE_MU_S - 1);
    float mu_s = 2.0 * unit - 1.0;
    float sun_sine = 2.0 * sqrt(unit * (1.0 - unit));
    uint me = gl_LocalInvocationIndex;
    float cos_azimuth = cos((float(me) + 0.5) * STEP);
    float sun_place = mu_s_place(mu_s);
    vec4 sum = vec4(0.0);
    for (int i = 0; i < ZENITHS / 2; ++i) {
        float theta = (float(i) + 0.5) * STEP;
        float mu = cos(theta);
        float sine = sin(theta);
        float nu = clamp(sine * cos_azimuth * sun_sine + mu * mu_s, -1.0, 1.0);
        sum += arriving(h, mu, nu, sun_place) * (mu * sine * STEP * STEP);
    }
    from_azimuth[me] = sum;
    for (uint width = AZIMUTHS / 2; width > 0u; width /= 2u) {
        barrier();
        if (me < width) {
            from_azimuth[me] += from_azimuth[me + width];
        }
    }
    if (me == 0u) {
        imageStore(made, at, from_azimuth[0]);
        imageStore(irradiance, at, imageLoad(irradiance, at) + from_azimuth[0]);
    }
}
