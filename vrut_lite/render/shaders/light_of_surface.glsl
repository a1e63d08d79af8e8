// Which light reaches a surface: of its own texels, of probes, or of the ground around.

#if defined(LIGHT_MAP) || defined(LIGHT_PROBES) || defined(GROUND_LIGHT)
#define SURFACE_LIGHT
//!include surface_light.glsl

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
Reached surface_light(vec3 face, vec3 smooth_n, vec3 n, bool behind) {
    Reached found = light_of_scene(face, smooth_n, n, behind);
#ifdef VIEW_LIGHT
    if (add_points_of_view(point_in_triangle(face), face, found)) {
#ifdef HAS_NORMAL_TEX
        found.light.rgb *= tilted(n, smooth_n, MOST_TILTED);
#endif
    }
#endif
    return found;
}
#endif
