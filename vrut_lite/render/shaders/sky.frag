#version 430 core
// The sky, the ground below it, and the sun's disc with its limb darkening.

uniform samplerCube sky;
uniform float sky_scale;
uniform vec3 sun_direction;
uniform vec3 sun_disc_radiance;      // mean over the disc
uniform float sun_angular_radius;
uniform vec3 limb_darkening[6];      // polynomial in cos psi, constant first, mean 1

in vec3 ray;
out vec4 frag_radiance;

//!include sky_lookup.glsl

vec3 sun_disc(vec3 d) {
    // asin of the cross product keeps its precision where acos of the dot product has none.
    float angle = dot(d, sun_direction) > 0.0 ? asin(min(1.0, length(cross(d, sun_direction)))) : 3.0;
    float edge = max(fwidth(angle), 1e-6);
    float covered = clamp((sun_angular_radius - angle) / edge + 0.5, 0.0, 1.0);
    float ratio = min(angle / sun_angular_radius, 1.0);
    float c = sqrt(max(0.0, 1.0 - ratio * ratio));
    vec3 darkening = limb_darkening[5];
    for (int k = 4; k >= 0; --k) darkening = darkening * c + limb_darkening[k];
    return sun_disc_radiance * max(darkening, 0.0) * covered;
}

void main() {
    vec3 d = normalize(ray);
    float above = clamp(d.y / max(fwidth(d.y), 1e-7) + 0.5, 0.0, 1.0);
    vec3 upper = sky_on_side(sky, d, 1.0) * sky_scale + sun_disc(d);
    frag_radiance = vec4(mix(sky_on_side(sky, d, -1.0) * sky_scale, upper, above), 1.0);
}
