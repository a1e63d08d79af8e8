// Normals of the triangle, of the surface and of its normal map, and the point that is shaded.

// The normal of the triangle, on its visible side.
vec3 face_normal(vec3 view) {
#ifdef FROM_BUFFER
    return face_in_buffer;
#endif
    vec3 n = cross(dFdx(eye_to_point), dFdy(eye_to_point));
    float squared = dot(n, n);
    if (!(squared > 0.0)) return view;
    n *= inversesqrt(squared);
    return dot(n, view) < 0.0 ? -n : n;
}

// Squared changes from pixel to pixel on one triangle, of a mirrored ray (rad^2) and of a place in
// the chart (texels^2). Differences of deferred pixels could span two surfaces.
#ifdef FROM_BUFFER
float change_of_ray(vec3 mirrored) { return ray_change_in_buffer; }
float change_of_place(vec2 at_px) { return place_change_in_buffer; }
#else
float change_of_ray(vec3 mirrored) {
    vec3 right = dFdx(mirrored), up = dFdy(mirrored);
    return max(dot(right, right), dot(up, up));
}

float change_of_place(vec2 at_px) {
    vec2 right = dFdx(at_px), up = dFdy(at_px);
    return max(dot(right, right), dot(up, up));
}
#endif

// The interpolated normal, and whether the back face is visible.
vec3 smooth_normal(vec3 face, out bool behind) {
    vec3 n = face;
    behind = false;
#ifdef NORMAL_LOC
    float length_squared = dot(world_normal, world_normal);
    if (length_squared > 0.0) n = world_normal * inversesqrt(length_squared);
    // The back of a sheet is lit from its own side.
#if defined(FRONT)
    behind = false;
#elif defined(BACK)
    behind = true;
#else
    behind = dot(n, face) < 0.0;
#endif
    if (behind) n = -n;
#endif
    return n;
}

// The surface's normal by its normal map. Flanks that lean away from the eye are invisible: they
// are replaced by the opposite ones.
vec3 mapped_normal(vec3 n, vec3 view) {
#ifdef HAS_NORMAL_TEX
#ifdef TEXCOORD_0_LOC
    // Tangents from screen derivatives (Schueler, "Normal mapping without precomputed
    // tangents", ShaderX 5): right for any mesh, and needs no tangents in the file.
    vec3 dpx = dFdx(eye_to_point), dpy = dFdy(eye_to_point);
    vec2 uv = uv_of(normal_layer);
    vec2 dux = dFdx(uv), duy = dFdy(uv);
    vec3 across_x = cross(n, dpx), across_y = cross(dpy, n);
    vec3 t = across_y * dux.x + across_x * duy.x;
    vec3 b = across_y * dux.y + across_x * duy.y;
    float longest = max(dot(t, t), dot(b, b));
    if (longest > 0.0) {
        vec3 m = 2.0 * texture(material.normal_texture, uv).rgb - 1.0;
        m.xy *= normal_scale;
        vec3 bent = normalize(mat3(t * inversesqrt(longest), b * inversesqrt(longest), n) * m);
        n = dot(bent, view) > 0.0 ? bent : 2.0 * dot(bent, n) * n - bent;
    }
#endif
#endif
    return n;
}

#ifdef ONE_SAMPLE
// A pixel's centre is inside of every triangle that it shows.
float centroid_factor(vec3 face) { return 1.0; }
vec3 point_in_triangle(vec3 face) { return eye_to_point; }
#else
// Corrects interpolation at the centroid on the edge of a triangle. Some rasterisers take 1 / w
// at the pixel's centre for the centroid too, which moves the point along its ray off the plane.
float centroid_factor(vec3 face) {
    float reached = dot(face, eye_to_sample);
    return abs(reached) > 0.0 ? dot(face, eye_to_point) / reached : 1.0;
}

// The shaded point of this triangle, also at its edge.
vec3 point_in_triangle(vec3 face) {
    float distance_to_plane = dot(face, eye_to_point), reached = dot(face, eye_to_sample);
    return abs(reached) > 0.0 ? eye_to_sample * (distance_to_plane / reached) : eye_to_point;
}
#endif
