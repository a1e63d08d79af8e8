// Sunlight that the air before a point lacks, because a frame part dims it: differences of the
// tables' sums, each times the share that is removed.

const int PART_SHAFT_STEPS = 24;

vec3 shaded_by_part(AirRay ray, vec3 d, float metres) {
    float last_m = sun_factor_end_m(d, min(metres, ray.entry_m + ray.span_m));
    float reach_m = last_m - ray.entry_m;
    if (!(reach_m > 0.0)) return vec3(0.0);
    float dither = ray_dither();
    vec3 missing = vec3(0.0), before = vec3(0.0);
    for (int i = 0; i < PART_SHAFT_STEPS; ++i) {
        // Steps grow with the distance.
        float near = float(i) / float(PART_SHAFT_STEPS);
        float middle = (float(i) + dither) / float(PART_SHAFT_STEPS);
        float far = float(i + 1) / float(PART_SHAFT_STEPS);
        vec3 sum = sunlit_before(ray, ray.entry_m + reach_m * far * far);
        float lit = sun_factor(d * (ray.entry_m + reach_m * middle * middle));
        missing += (1.0 - lit) * max(sum - before, 0.0);
        before = sum;
    }
    return missing;
}
