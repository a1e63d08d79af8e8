#version 430 core
// The moon's disc after Lommel and Seeliger; see MoonDiscChanged.

uniform vec3 moon_direction;
uniform vec3 moon_right;             // along the horizon
uniform vec3 moon_upper;
uniform float sine_of_radius;
uniform float flattening;
uniform float horizon_sine;          // of its elevation
uniform vec3 to_sun;
uniform mat3 moon_axes;
uniform vec3 lit_radiance;
uniform vec3 dark_radiance;
uniform vec3 shadow_direction;       // of the Earth
uniform float umbra;                 // 0: none
uniform float penumbra;
uniform vec3 umbra_share;            // of sunlight, in its middle
uniform float edge_over_middle;
uniform vec3 through[9];             // the air, from the disc's lowest place to its highest
uniform sampler2D albedo;
uniform int steps;                   // of a pixel, right and up

in vec3 ray;
out vec4 frag_radiance;

const float PI = 3.14159265;

// The twin of shadow_share in sky/moon_disc.py.
vec3 sunlight_left(vec3 d) {
    if (umbra <= 0.0) return vec3(1.0);
    float beside = length(cross(d, shadow_direction));
    float x = clamp(2.0 * (beside - umbra) / (penumbra - umbra) - 1.0, -1.0, 1.0);
    float sun = 0.5 + (x * sqrt(1.0 - x * x) + asin(x)) / PI;
    float inner = min(beside / umbra, 1.0);
    vec3 copper = min(umbra_share * pow(edge_over_middle, inner * inner), 1.0);
    return sun + (1.0 - sun) * copper;
}

vec3 moon(vec3 d) {
    if (d.y <= horizon_sine || dot(d, moon_direction) <= 0.0) return vec3(0.0);
    vec2 p = vec2(dot(d, moon_right), dot(d, moon_upper) / flattening) / sine_of_radius;
    float beside = dot(p, p);
    if (beside >= 1.0) return vec3(0.0);
    float mu = sqrt(1.0 - beside);
    vec3 n = p.x * moon_right + p.y * moon_upper - mu * moon_direction;
    float mu_sun = max(dot(n, to_sun), 0.0);
    vec3 own = moon_axes * n;
    vec2 at = vec2(atan(own.y, own.x) / (2.0 * PI) + 0.5, 0.5 - asin(clamp(own.z, -1.0, 1.0)) / PI);
    float place = clamp(4.0 * (p.y + 1.0), 0.0, 7.999);
    vec3 air = mix(through[int(place)], through[int(place) + 1], fract(place));
    float shade = mu_sun / max(mu_sun + mu, 1e-4);
    vec3 light = lit_radiance * sunlight_left(d) * shade + dark_radiance;
    return textureLod(albedo, at, 0.0).r * air * light;
}

void main() {
    // A disc may be a few pixels wide: the mean of each pixel.
    vec3 right = dFdx(ray), upper = dFdy(ray), sum = vec3(0.0);
    for (int i = 0; i < steps; ++i)
        for (int j = 0; j < steps; ++j) {
            vec2 at = (vec2(i, j) + 0.5) / float(steps) - 0.5;
            sum += moon(normalize(ray + at.x * right + at.y * upper));
        }
    frag_radiance = vec4(sum / float(steps * steps), 0.0);
}
