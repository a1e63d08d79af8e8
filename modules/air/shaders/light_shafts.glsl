// Sunlight that the air before a point lacks, because the scene shades it. The tables hold light
// summed up from the eye, so each shaded piece of the ray is a difference of two look-ups, exact
// for any number of pieces; the steps only find where shadows begin and end.

//!sampler sampler2DShadow shaft_shadow_map

#ifdef LIGHT_SHAFTS
const int SHAFT_STEPS = 64;
#else
// In the glow around the sun, where what hides the sun shades most of a ray.
const int SHAFT_STEPS = 8;
#endif
const int SHAFT_HALVINGS = 5;

// The part of a ray that the scene can shade: the box of the shadow map, open away from the sun.
vec2 shaded_range(vec3 start, vec3 along, float nearest_m, float farthest_m) {
    vec3 slope = mix(along, vec3(1e-30), lessThan(abs(along), vec3(1e-30)));
    vec3 a = (-1.0 - start) / slope, b = (1.0 - start) / slope;
    vec3 enter = min(a, b), leave = max(a, b);
    enter.z = slope.z > 0.0 ? a.z : nearest_m;
    leave.z = slope.z > 0.0 ? farthest_m : a.z;
    return vec2(max(nearest_m, max(enter.x, max(enter.y, enter.z))),
                min(farthest_m, min(leave.x, min(leave.y, leave.z))));
}

bool is_lit(vec3 at) {
    vec3 place = vec3(at.xy, min(at.z, 1.0)) * 0.5 + 0.5;
    return textureLod(shaft_shadow_map, place, 0.0) > 0.5;
}

// Bisects the distance at which light and shadow meet, between a lit and a shaded place.
float edge_between(vec3 start, vec3 along, float before_m, float after_m, bool lit_before) {
    for (int k = 0; k < SHAFT_HALVINGS; ++k) {
        float middle = 0.5 * (before_m + after_m);
        if (is_lit(start + along * middle) == lit_before) before_m = middle;
        else after_m = middle;
    }
    return 0.5 * (before_m + after_m);
}

// Share of a step by which a ray's samples move, by pixel (Jimenez 2014, "interleaved gradient
// noise") and from picture to picture of a still: details thinner than a step become grain instead of
// bands.
float ray_dither() {
    float dither = fract(52.9829189 * fract(dot(gl_FragCoord.xy, vec2(0.06711056, 0.00583715))));
#ifdef PICTURE_SHARE
    dither = fract(dither + PICTURE_SHARE);
#endif
    return dither;
}

vec3 shaded_by_scene(AirRay ray, vec3 d, float metres) {
    vec3 start = air.shadow_from_eye[3].xyz;
    vec3 along = mat3(air.shadow_from_eye) * d;
    float last_m = min(metres, ray.entry_m + ray.span_m);
    vec2 range = shaded_range(start, along, ray.entry_m, last_m);
    if (!(range.y > range.x)) return vec3(0.0);
    float dither = ray_dither();
    float step_m = (range.y - range.x) / float(SHAFT_STEPS);
    bool lit = is_lit(start + along * range.x);
    float before_m = range.x;
    vec3 missing = vec3(0.0), since = lit ? vec3(0.0) : sunlit_before(ray, before_m);
    // The last sample lies before the surface, which the map's texels shade in part.
    for (int i = 0; i <= SHAFT_STEPS; ++i) {
        float now_m = min(range.x + (float(i) + dither) * step_m, range.y - 0.06 * step_m);
        bool lit_now = is_lit(start + along * now_m);
        if (lit_now != lit) {
            vec3 at_edge = sunlit_before(ray, edge_between(start, along, before_m, now_m, lit));
            if (lit) since = at_edge;
            else missing += at_edge - since;
            lit = lit_now;
        }
        before_m = now_m;
    }
    return lit ? missing : missing + sunlit_before(ray, range.y) - since;
}

#ifdef LIGHT_SHAFTS
#ifdef SUN_FACTOR
//!include part_shafts.glsl
#endif

vec3 shadowed_light(AirRay ray, vec3 d, float metres) {
    vec3 missing = shaded_by_scene(ray, d, metres);
#ifdef SUN_FACTOR
    // Approximation: the part removes an equal share of all light that the scene leaves.
    vec3 whole = sunlit_before(ray, metres);
    vec3 left = clamp(1.0 - missing / max(whole, 1e-30), 0.0, 1.0);
    missing += left * shaded_by_part(ray, d, metres);
#endif
    return missing;
}
#endif
