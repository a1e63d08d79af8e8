// Light on surfaces by the light map: texels (LIGHT_MAP), probes (LIGHT_PROBES), or the chart of the
// ground (GROUND_LIGHT). surface_light.py uploads it.

//!sampler sampler2D light_map
// Its layers: six faces, each all of z.
//!sampler sampler3D light_probes
// The table of open_irradiance.py.
//!sampler sampler2D open_sky
// `Reached.sky`.
//!sampler sampler2D visible_sky
//!include surface_light_block.glsl

#ifdef LIGHT_MAP
uniform vec2 light_corner_px;    // of the surface's rectangle in the light map
#endif
const float MOST_BEHIND = 10.0;  // times the light of the front, on the back of a sheet
const float OPEN_AIR = 0.5;      // share of the sky at a surface from which the air before it gets all
const float GROUND_FADE = 0.7;  // of the half width, where the map goes over into open ground

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
vec2 ground_reach(vec3 point) {
    return (surface.ground_eye_m + point.xz) / surface.ground_half_width_m;
}

// Of a point relative to the eye: messages/light_map.py says where it lies in the map.
vec2 ground_px(vec3 point) {
    vec2 reach = ground_reach(point), x = abs(reach) * surface.ground_slope;
    vec2 along = sign(reach) * log(x + sqrt(x * x + 1.0)) / surface.ground_warp;  // asinh
    return surface.ground_first + clamp(0.5 + 0.5 * along, 0.0, 1.0) * surface.ground_steps;
}

Reached ground_light(vec3 point) {
    vec2 reach = ground_reach(point);
    float far = smoothstep(GROUND_FADE, 1.0, max(abs(reach.x), abs(reach.y)));
    Reached near = map_light(ground_px(point));
    vec4 open = vec4(surface.open_ground, 1.0);
    return by_map(mix(near.light, open, far), mix(near.sky, vec4(0.0, 0.0, 0.0, 1.0), far));
}
#endif

#ifdef VIEW_LIGHT
#define LOBES
// Points that the picture shows: their light, their triangles' planes from the eye, and what coats
// mirror there, by both parts of Schlick's term.
//!sampler sampler3D view_points
const float SAME_PLANE = 2e-3;  // of the distance from the eye
const float SAME_FACING = 0.97;
const float FEW_POINTS = 0.1;     // share of a fragment that the four points about it have
const float FINE_POINTS = 0.5;    // texels between points up to which these alone light a surface

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

// Share of the map's light where its texels are finer than the points: on far and slanted surfaces
// these leap over the dark foot of a wall, and others light it.
float share_of_map() {
#if defined(GROUND_LIGHT)
    vec2 at_px = ground_px(eye_to_point);
#elif defined(LIGHT_MAP)
    vec2 at_px = place_px;
#else
    vec2 at_px = vec2(0.0);
#endif
    float texels_apart = surface.view_edge_px * sqrt(change_of_place(at_px));
    return smoothstep(FINE_POINTS, 2.0 * FINE_POINTS, texels_apart);
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

// Ratio of the open sky's irradiance on planes with two normals.
vec3 tilted(vec3 n, vec3 from, float most) {
    return ratio(open_irradiance(n), open_irradiance(from), most);
}

// Light of a surface with this normal, and with its normal map's normal.
Reached light_of_scene(vec3 face, vec3 smooth_n, vec3 n, bool behind) {
#if defined(GROUND_LIGHT)
    return ground_light(eye_to_point);
#elif defined(LIGHT_MAP)
#ifdef TWO_SIDED
    // The map has the light of the front alone.
    if (behind) {
#ifdef LIGHT_PROBES
        if (has_probes(eye_to_point)) return probe_light(eye_to_point, n);
#endif
        vec4 front = map_light(light_corner_px + place_px * centroid_factor(face)).light;
        front.rgb *= tilted(n, -smooth_n, MOST_BEHIND);
        return by_map(front, vec4(0.0, 0.0, 0.0, front.a));
    }
#endif
    Reached front = map_light(light_corner_px + place_px * centroid_factor(face));
#ifdef HAS_NORMAL_TEX
    front.light.rgb *= tilted(n, smooth_n, MOST_TILTED);
#endif
    return front;
#else
    return probe_light(eye_to_point, n);
#endif
}

// The same, finer where points of the view are known.
Reached surface_light(vec3 face, vec3 smooth_n, vec3 n, bool behind, float occlusion) {
    Reached found = light_of_scene(face, smooth_n, n, behind);
#ifdef VIEW_LIGHT
    vec4 by_map = found.light;
    // Backs of sheets have none of their own in the map.
    float of_map = behind ? 0.0 : share_of_map();
    if (add_points_of_view(point_in_triangle(face), face, found)) {
#ifdef HAS_NORMAL_TEX
        found.light.rgb *= tilted(n, smooth_n, MOST_TILTED);
#endif
        found.light = mix(found.light, by_map, of_map);
    }
#endif
#ifndef LIGHT_MAP
    found.light *= occlusion;  // of folds that are too fine for probes or the ground's texels
#endif
    return found;
}

#ifdef MIRROR
//!include mirror.glsl
#endif
