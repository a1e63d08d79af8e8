// What an observer aloft sees behind the scene, for every pixel of a picture.

#include "sky_view.glsl"

// Fourth roots of the sun's irradiance through the air, where points of its disc are seen.
layout(std430, binding = 2) restrict readonly buffer BackgroundSunlight {
    vec4 background_sunlight_nodes[];
};
uniform vec2 background_disc;  // 1 + mu of the first of these nodes and of the last, less horizon

// How much of a pixel lies above the horizon.
float background_share_above(float height) {
    return clamp(height / max(fwidth(height), 1e-9) + 0.5, 0.0, 1.0);
}

vec3 background_radiance(vec3 direction) {
    float height = background_height(direction);
    float above = background_share_above(height);
    vec3 seen = vec3(0.0);
    if (above > 0.0) seen += above * background_on_side(direction, height, true);
    if (above < 1.0) seen += (1.0 - above) * background_on_side(direction, height, false);
    return seen;
}

vec3 background_sunlight(vec3 direction) {
    float height = background_height(direction);
    int last = background_sunlight_nodes.length() - 1;
    float place = (height - background_disc.x) / (background_disc.y - background_disc.x);
    place = clamp(place, 0.0, 1.0) * float(last);
    int i = min(int(place), last - 1);
    vec3 root = mix(background_sunlight_nodes[i], background_sunlight_nodes[i + 1],
                    place - float(i)).rgb;
    return background_share_above(height) * background_fourth_power(root);
}
