// The nodes of the trapezoid rule along a work group's ray, found once for all its suns. To be
// included after the group's size is declared.

shared float ray_distance[RAY_INTERVALS + 1];
shared Point ray_point[RAY_INTERVALS + 1];
shared vec4 ray_clear[RAY_INTERVALS + 1];       // transmittance from the start, times metres

void prepare_ray(Ray ray) {
    float step = ray.ray_length / float(RAY_INTERVALS);
    Transmittance start = transmittance_to_top(point_on(ray, 0.0));
    for (uint i = gl_LocalInvocationIndex; i <= RAY_INTERVALS; i += gl_WorkGroupSize.x) {
        // The last node is the end itself, not a rounding error short of it.
        float distance = i == RAY_INTERVALS ? ray.ray_length : float(i) * step;
        Point point = point_on(ray, distance);
        Transmittance there = transmittance_to_top(point);
        // The table knows no rays through the planet: those to the ground are looked up backwards.
        vec4 clear = ray.hits ? ratio(there, start) : ratio(start, there);
        ray_distance[i] = distance;
        ray_point[i] = point;
        ray_clear[i] = clear * (i == 0 || i == RAY_INTERVALS ? 0.5 * step : step);
    }
}
