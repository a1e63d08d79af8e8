#version 430 core
// A rainbow: the twin of `radiance` in bow.py, which explains the model.
uniform vec3 antisolar, light_rgb;
uniform float step_deg;
uniform vec3 phase_rgb[256];         // sr^-1, at the middles of the bins
in vec3 ray;
out vec4 frag_radiance;
void main() {
    vec3 d = normalize(ray);
    float place = degrees(acos(clamp(dot(d, antisolar), -1.0, 1.0))) / step_deg - 0.5;
    int bin = int(clamp(floor(place), 0.0, 254.0));
    vec3 phase = mix(phase_rgb[bin], phase_rgb[bin + 1], clamp(place - bin, 0.0, 1.0));
    bool inside = place <= 255.0 && d.y > 0.0;
    frag_radiance = vec4(inside ? light_rgb * phase : vec3(0.0), 0.0);
}
