// Midpoint, trapezoid and Simpson with even intervals along both rays, as rules_classical.py
// has them: the view ray's optical depth is accumulated by the rule itself.

const int MIDPOINT = 1;
const int TRAPEZOID = 2;
const int SIMPSON = 3;
uniform ivec2 intervals;        // on the view ray, on the light ray

// Nodes lie at (i + first_node) / intervals; the midpoint rule has one less than the others.
float first_node() {
    return rule == MIDPOINT ? 0.5 : 0.0;
}

int last_node(int count) {
    return rule == MIDPOINT ? count - 1 : count;
}

// Times the interval.
float node_weight(int i, int count) {
    if (rule == MIDPOINT) {
        return 1.0;
    }
    bool at_end = i == 0 || i == count;
    if (rule == TRAPEZOID) {
        return at_end ? 0.5 : 1.0;
    }
    return (at_end ? 1.0 : i % 2 == 1 ? 4.0 : 2.0) / 3.0;
}

float distance_to_top(Ray ray) {
    float above = top_altitude_m - ray.altitude;
    float c = above * (2.0 * ground_radius_m + top_altitude_m + ray.altitude);
    // A node of a ray that ends at the top may lie above it by a rounding.
    float root = sqrt(max(ray.along * ray.along + c, 0.0));
    return ray.along > 0.0 ? c / (root + ray.along) : root - ray.along;
}

float distance_to_ground(Ray ray) {
    float horizon = sqrt(ray.altitude * (ray.radius + ground_radius_m));
    float b = abs(ray.along);
    float far = b + sqrt(max((b - horizon) * (b + horizon), 0.0));
    return far > 0.0 ? horizon * horizon / far : 0.0;
}

// Densities of molecules, aerosol, absorber and fog.
vec4 all_densities_at(float altitude) {
    return vec4(densities_at(altitude), absorber_at(altitude), fog_at(altitude));
}

// Paths from a point to the top of the atmosphere.
vec4 light_paths(float altitude, float mu_s) {
    Ray ray = make_ray(altitude, mu_s);
    int count = intervals.y;
    float interval = distance_to_top(ray) / float(count);
    vec4 paths = vec4(0.0);
    for (int i = 0; i <= last_node(count); ++i) {
        float distance = (float(i) + first_node()) * interval;
        float h = max(altitude_after(ray, distance), 0.0);
        paths += node_weight(i, count) * all_densities_at(h);
    }
    return paths * interval;
}

// The paths up to node i over the interval: `whole` is the sum that even nodes hand on, and the
// densities are those of the two nodes before, of this and of the next one.
vec4 paths_to_node(int i, vec4 before[2], vec4 here, vec4 next, inout vec4 whole) {
    if (rule == MIDPOINT) {
        whole += here;
        return whole - 0.5 * here;
    }
    if (i == 0) {
        return vec4(0.0);
    }
    if (rule == TRAPEZOID) {
        whole += 0.5 * (before[1] + here);
        return whole;
    }
    if (i % 2 == 1) {
        // Where densities grow a lot from node to node the parabola dips below zero.
        return whole + max(5.0 * before[1] + 8.0 * here - next, vec4(0.0)) / 12.0;
    }
    whole += (before[0] + 4.0 * before[1] + here) / 3.0;
    return whole;
}

// Altitude of node i of the view ray. The last one on the ground is exactly there: a centimetre
// higher a sun at the horizon would shine on it.
float node_altitude(Ray ray, int i, float interval) {
    if (i == intervals.x && rule != MIDPOINT && hits_ground(ray)) {
        return 0.0;
    }
    float altitude = altitude_after(ray, (float(i) + first_node()) * interval);
    return clamp(altitude, 0.0, top_altitude_m);
}

Integrals classical_integrals(float altitude, float mu, float mu_s, float nu) {
    Ray ray = make_ray(altitude, mu);
    int count = intervals.x;
    float length = hits_ground(ray) ? distance_to_ground(ray) : distance_to_top(ray);
    float interval = length / float(count);
    float h = node_altitude(ray, 0, interval);
    vec4 before[2] = vec4[2](vec4(0.0), vec4(0.0));
    vec4 here = all_densities_at(h);
    vec4 whole = vec4(0.0);
    Integrals sum = Integrals(vec3(0.0), vec3(0.0), vec3(0.0));
    for (int i = 0; i <= last_node(count); ++i) {
        float distance = (float(i) + first_node()) * interval;
        float next_h = node_altitude(ray, i + 1, interval);
        vec4 next = all_densities_at(next_h);
        vec4 paths = paths_to_node(i, before, here, next, whole) * interval;
        float sun = (ray.radius * mu_s + distance * nu) / (ground_radius_m + h);
        sun = clamp(sun, -1.0, 1.0);
        if (!in_shadow(h, sun)) {
            paths += light_paths(h, sun);
            vec3 depth = optical_depth(paths.xy, paths.w, paths.z);
            vec3 light = node_weight(i, count) * interval * exp(-depth);
            sum.rayleigh += light * here.x;
            sum.mie += light * here.y;
            sum.fog += light * here.w;
        }
        before[0] = before[1];
        before[1] = here;
        here = next;
        h = next_h;
    }
    return sum;
}
