// What lights clouds, as textures; places are in [0, 1], nodes in units of nodes.

layout(binding = 3) uniform sampler2D sunlight_at_altitude;       // the sun at base and top, by its height
layout(binding = 5) uniform sampler3D light_volume;    // depths to the sun, up, down
// Fluence; flux along x, up and z.
//!sampler sampler3D light_diffuse
layout(binding = 6) uniform sampler3D cloud_transport; // views x above x (sines, below)
layout(binding = 7) uniform sampler2D droplets_phase;  // by the sine of half the angle: 3 rows

float volume_edges() { return float(textureSize(light_volume, 0).z); }
vec3 depths_at(vec3 place) { return textureLod(light_volume, place, 0.0).rgb; }
vec4 diffuse_at(vec3 place) { return textureLod(light_diffuse, place, 0.0); }

vec4 transport_nodes(vec3 node) {
    return textureLod(cloud_transport, (node + 0.5) / vec3(textureSize(cloud_transport, 0)), 0.0);
}

float phase_angles() { return float(textureSize(droplets_phase, 0).x); }
vec3 phase_nodes(float node, int row) {
    vec2 place = vec2(node, float(row)) + 0.5;
    return textureLod(droplets_phase, place / vec2(textureSize(droplets_phase, 0)), 0.0).rgb;
}

vec3 sun_nodes(float share, float height) {
    vec2 size = vec2(textureSize(sunlight_at_altitude, 0));
    vec2 place = vec2(share, height) * (size - 1.0) + 0.5;
    return textureLod(sunlight_at_altitude, place / size, 0.0).rgb;
}
