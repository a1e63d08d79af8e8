// Light of the open sky by orientation, by which light is divided while it is smoothed.

layout(std430, binding = 4) readonly buffer OpenSky { float open_sky_of[]; };
uniform uint texels;
uniform float least_of_sky;

float bends(uint orientation) {
    return max(open_sky_of[orientation], least_of_sky);
}
