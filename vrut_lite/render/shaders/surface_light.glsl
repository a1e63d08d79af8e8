// Light on a surface without the direct sun: RGB irradiance in W m^-2, and in alpha the share of
// the open sky that arrives. render/surface_light.py uploads it.

layout(binding = 5) uniform sampler2D light_map;
layout(binding = 6) uniform sampler3D light_probes;  // its layers: six faces, each all of z
layout(binding = 7) uniform sampler2D open_sky;      // open_irradiance.py's table
layout(binding = 32) uniform sampler2D visible_sky;  // b and a of the share a + b . d that is seen
//!include surface_light_block.glsl

const float FEWEST_THINGS = 0.05;  // share of all directions below which things are too few to tell
const float OPEN_AIR = 0.5;      // share of the sky at a surface from which the air before it gets all
const float GROUND_FADE = 0.7;  // of the half width, where the map goes over into open ground

// Light, and towards where the sky is seen from there: b and a of the share a + b . d. Where points
// of the view tell, also what both parts of Schlick's term mirror.
struct Reached {
    vec4 light;
    vec4 sky;
    bool mirrors;
    vec3 direct, grazing;
};

Reached by_map(vec4 light, vec4 sky) {
    return Reached(light, sky, false, vec3(0.0), vec3(0.0));
}

Reached map_light(vec2 at_px) {
    vec4 light = textureLod(light_map, at_px * surface.texel, 0.0);
    vec4 sky = textureLod(visible_sky, at_px * surface.texel, 0.0);
    return by_map(vec4(light.rgb * surface.radiance_scale, light.a), sky);
}

// Irradiance of a plane with normal n under the open sky, where sky_irradiance costs more.
vec3 open_irradiance(vec3 n) {
    vec3 on_faces = n / (abs(n.x) + abs(n.y) + abs(n.z));
    vec2 at = on_faces.xz;
    if (n.y < 0.0) at = (1.0 - abs(at.yx)) * vec2(at.x < 0.0 ? -1.0 : 1.0, at.y < 0.0 ? -1.0 : 1.0);
    float nodes = float(textureSize(open_sky, 0).x);
    vec2 texel = (0.5 + 0.5 * at) * (nodes - 1.0) + 0.5;
    return textureLod(open_sky, texel / nodes, 0.0).rgb;
}

#ifdef GROUND_LIGHT
// At a point relative to the eye: messages/light_map.py says where it lies in the map.
Reached ground_light(vec3 point) {
    vec2 away_m = surface.ground_eye_m + point.xz;
    vec2 reach = away_m / surface.ground_half_width_m;
    vec2 x = abs(reach) * surface.ground_slope;
    vec2 along = sign(reach) * log(x + sqrt(x * x + 1.0)) / surface.ground_warp;  // asinh
    vec2 at_px = surface.ground_first + clamp(0.5 + 0.5 * along, 0.0, 1.0) * surface.ground_steps;
    float far = smoothstep(GROUND_FADE, 1.0, max(abs(reach.x), abs(reach.y)));
    Reached near = map_light(at_px);
    vec4 open = vec4(surface.open_ground, 1.0);
    return by_map(mix(near.light, open, far), mix(near.sky, vec4(0.0, 0.0, 0.0, 1.0), far));
}
#endif

#ifdef VIEW_LIGHT
// Points that the picture shows: their light, their triangles' planes from the eye, and what coats
// mirror there, by both parts of Schlick's term.
layout(binding = 31) uniform sampler3D view_points;
const float SAME_PLANE = 2e-3;  // of the distance from the eye
const float SAME_FACING = 0.97;
const float FEW_POINTS = 0.1;     // share of a fragment that the four points about it have

// What the points around a fragment have that lie on its triangle's plane: linear between the four
// points about it, and beyond where these hardly count. One loop serves both, as a software renderer
// runs both sides of an `if`.
bool add_points_of_view(vec3 point, vec3 face, inout Reached found) {
    ivec2 size = textureSize(view_points, 0).xy;
    // Squares count from the upper edge of the picture, which the last of them may pass.
    float below = surface.view_edge_px * float(size.y) - surface.view_height_px;
    vec2 at = (gl_FragCoord.xy + vec2(0.0, below)) / surface.view_edge_px - 0.5;
    ivec2 first = ivec2(floor(at));
    vec2 share = at - vec2(first);
    float reach = SAME_PLANE * length(point), total = 0.0;
    vec4 light = vec4(0.0), direct = vec4(0.0), grazing = vec4(0.0);
    int taps = 4;
    for (int k = 0; k < taps; ++k) {
        ivec2 off = k < 4 ? ivec2(k & 1, k >> 1) : ivec2(k & 3, (k >> 2) - 1) - 1;
        ivec2 texel = clamp(first + off, ivec2(0), size - 1);
        vec4 plane = texelFetch(view_points, ivec3(texel, 1), 0);
        bool same = dot(plane.xyz, face) >= SAME_FACING
            && abs(dot(plane.xyz, point) - plane.w) <= reach;
        bool again = k >= 4 && clamp(off, ivec2(0), ivec2(1)) == off;
        vec2 near = max(1.0 - abs(vec2(off) - share), 1e-3);
        float weight = same && !again ? near.x * near.y : 0.0;
        light += weight * texelFetch(view_points, ivec3(texel, 0), 0);
        direct += weight * texelFetch(view_points, ivec3(texel, 2), 0);
        grazing += weight * texelFetch(view_points, ivec3(texel, 3), 0);
        total += weight;
        if (k == 3 && total < FEW_POINTS) taps = 20;
    }
    if (total <= 0.0) return false;
    found.light = vec4(light.rgb * surface.view_scale, light.a) / total;
    if (direct.a <= 0.0) return true;
    found.mirrors = true;
    found.direct = direct.rgb * (surface.view_scale / direct.a);
    found.grazing = grazing.rgb * (surface.view_scale / grazing.a);
    return true;
}
#endif

#ifdef LIGHT_PROBES
vec3 among_probes(vec3 point) {
    return surface.probes_eye + point * surface.probes_per_m;
}

// Whether probes stand around a point, or at least beside it.
bool has_probes(vec3 point) {
    vec3 at = among_probes(point);
    return all(greaterThan(at, vec3(-1.0))) && all(lessThan(at, surface.probe_counts));
}

// Of a plane with normal n: each of the six planes by its squared cosine, so that shares sum up
// to one (McTaggart 2004, "Half-Life 2 / Valve Source shading").
Reached probe_light(vec3 point, vec3 n) {
    // Half a step off the surface, since the nearest probes may lie behind it.
    vec3 at = among_probes(point) + 0.5 * n;
    at = clamp(at, vec3(0.0), surface.probe_counts - 1.0) + 0.5;
    vec3 size = vec3(surface.probe_counts.xy, 6.0 * surface.probe_counts.z);
    vec3 weight = n * n / dot(n, n);
    vec4 light = vec4(0.0);
    for (int axis = 0; axis < 3; ++axis) {
        float face = 2.0 * axis + (n[axis] < 0.0 ? 1.0 : 0.0);
        float layer = at.z + face * surface.probe_counts.z;
        light += weight[axis] * textureLod(light_probes, vec3(at.xy, layer) / size, 0.0);
    }
    return by_map(vec4(light.rgb * surface.radiance_scale, light.a), vec4(0.0, 0.0, 0.0, light.a));
}
#endif

// Share of the light in open air that is in the air before a point: none in a room without windows,
// little in a hall, all in a street or far away. The air is assumed to get the surface's share.
float light_in_air(float share_of_sky, float metres) {
    float far = smoothstep(1.0, 2.0, metres / surface.scene_m);
    return mix(smoothstep(0.0, OPEN_AIR, share_of_sky), 1.0, far);
}

vec3 ratio(vec3 wanted, vec3 had, float most) {
    return clamp((wanted + 1e-20) / (had + 1e-20), 1.0 / most, most);
}

// Ratio of the open sky's irradiance on planes with two normals.
vec3 tilted(vec3 n, vec3 from, float most) {
    return ratio(open_irradiance(n), open_irradiance(from), most);
}
