// Twilight's map of directions over the formula, and the night's even light: the twin of
// twilight_rows.py, where the formulas are explained. It stands before the formula's `main`.

layout(std430, binding = 1) restrict readonly buffer Twilight { vec4 twilight[]; };

uniform ivec2 twilight_shape;   // nodes in v, the elevation, and in a, the azimuth
uniform vec2 twilight_azimuth;  // the sun's, a unit vector of world x and z
uniform float night;            // radiance over the scale

vec3 radiance_in_twilight(vec3 direction) {
    float level = dot(direction.xz, direction.xz);
    float from_zenith = level / (1.0 + direction.y);
    vec2 chord = direction.xz * inversesqrt(max(level, 1e-30)) - twilight_azimuth;
    vec2 place = vec2(sqrt(direction.y / (1.0 + sqrt(from_zenith))), 0.5 * length(chord))
               * vec2(twilight_shape - 1);
    ivec2 low = min(ivec2(place), twilight_shape - 2);
    vec2 share = place - vec2(low);
    int node = low.x * twilight_shape.y + low.y, next = node + twilight_shape.y;
    vec4 found = mix(mix(twilight[node], twilight[node + 1], share.y),
                     mix(twilight[next], twilight[next + 1], share.y), share.x);
    return radiance(direction) * found.w + found.rgb + night;
}

#define radiance(direction) radiance_in_twilight(direction)
