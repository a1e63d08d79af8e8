// Looking up a sky-view table: the twin of sky_view_fill.py, where the formulas are explained.

// Two of each node, fourth roots of radiance: that with its phase function, and four bands of
// aerosol's without.
layout(std430, binding = 1) restrict readonly buffer BackgroundNodes { vec4 background_nodes[]; };

// The colours of the four bands, then their phase functions, uniform in the sine of half the angle.
layout(std430, binding = 3) restrict readonly buffer BackgroundBands { vec4 background_bands[]; };

uniform ivec3 background_shape;      // rows above the horizon, rows below it, columns
uniform vec2 background_horizon;     // 1 + mu of the ground's horizon and of the air's end
uniform vec3 background_sun;         // unit vector
uniform vec2 background_sun_azimuth; // its level part, a unit vector

vec4 background_phases(vec3 direction) {
    int last = background_bands.length() - 5;
    float place = min(0.5 * distance(direction, background_sun), 1.0) * float(last);
    int i = min(int(place), last - 1);
    return mix(background_bands[4 + i], background_bands[5 + i], place - float(i));
}

vec4 background_blended(int node, vec2 far, int kind) {
    int at = 2 * node + kind;
    int next = at + 2 * background_shape.z;
    vec4 near_row = mix(background_nodes[at], background_nodes[at + 2], far.x);
    return mix(near_row, mix(background_nodes[next], background_nodes[next + 2], far.x), far.y);
}

vec3 background_fourth_power(vec3 root) {
    vec3 square = root * root;
    return square * square;
}

vec3 background_aerosol(vec3 direction, vec4 root) {
    vec4 square = root * root, light = background_phases(direction) * square * square;
    mat4 colours = mat4(background_bands[0], background_bands[1], background_bands[2],
                        background_bands[3]);
    return (colours * light).rgb;
}

// 1 + mu above that of the ground's horizon, without cancellation at the nadir, where a far
// observer has all of the planet.
float background_height(vec3 direction) {
    float sum = 1.0 + abs(direction.y);
    float depth = direction.y < 0.0 ? dot(direction.xz, direction.xz) / sum : sum;
    return depth - background_horizon.x;
}

// Radiance on one side of the horizon, `up` or down; directions beyond it take the edge's.
vec3 background_on_side(vec3 direction, float height, bool up) {
    float span = up ? background_horizon.y - background_horizon.x : background_horizon.x;
    int rows = up ? background_shape.x : background_shape.y;
    float share = clamp((up ? height : -height) / span, 0.0, 1.0);
    // Dense toward the zenith too, or toward the edge of the air from above it: sky_view_rows.py.
    float turn = !up ? 1.0 : background_horizon.y > 1.0 ? 0.85 : 0.5;
    float x = share < turn ? sqrt(share * turn) : 1.0 - sqrt((1.0 - share) * (1.0 - turn));
    float row = x * float(rows - 1);
    int i = min(int(row), rows - 2);
    // Half the chord between the level directions is the sine of half the azimuth.
    float level = dot(direction.xz, direction.xz);
    vec2 chord = direction.xz * inversesqrt(max(level, 1e-30)) - background_sun_azimuth;
    float column = 0.5 * length(chord) * float(background_shape.z - 1);
    int k = min(int(column), background_shape.z - 2);
    int node = (up ? i : i + background_shape.x) * background_shape.z + k;
    vec2 far = vec2(column - float(k), row - float(i));
    vec3 phased = background_fourth_power(background_blended(node, far, 0).rgb);
    return max(phased + background_aerosol(direction, background_blended(node, far, 1)), 0.0);
}
