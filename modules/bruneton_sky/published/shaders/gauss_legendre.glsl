// The rule "GL-y-exp" of quadrature.py: Gauss-Legendre in y, in an exponential map that puts
// the nodes where the air is dense, on segments that end at the perigee and the shadow's edge.

const int MOST_GAUSS_NODES = 32;
uniform int gauss_nodes;
uniform float gauss_node[MOST_GAUSS_NODES];     // on [0, 1]
uniform float gauss_weight[MOST_GAUSS_NODES];
uniform vec2 clustering;                        // b in clear air, depth from which haze adds
uniform float fog_top;                          // of fog, in its scale heights

// In fog there are two more break points, and two more segments.
const int MOST_BREAKS = 7;

// Two places of one y, as on a steep ray of a few metres, differ in altitude still.
bool is_further(Place a, Place b) {
    return a.y == b.y ? (a.altitude - b.altitude) * a.y > 0.0 : a.y > b.y;
}

void put_in_order(inout Place a, inout Place b) {
    if (is_further(a, b)) {
        Place c = a;
        a = b;
        b = c;
    }
}

// Place of a ray at the top of the fog, before (side -1) or behind (1) its perigee.
Place place_at_fog_top(Ray ray, float side, Place end) {
    float altitude = fog_top * fog_scale_height_m;
    float y = side * sqrt(max(altitude - ray.perigee_altitude, 0.0));
    Place start = start_of(ray);
    Place place = Place(y, max(altitude, ray.perigee_altitude));
    return is_further(start, place) ? start : is_further(place, end) ? end : place;
}

// Start, perigee, both edges of the shadow and end, along the ray; some coincide. In fog there
// are also the places where it begins and ends. Returns how many.
int find_break_points(Ray ray, float mu, float mu_s, float nu, out Place breaks[MOST_BREAKS]) {
    Place start = start_of(ray);
    Place end = end_of(ray);
    breaks = Place[MOST_BREAKS](start, start, start, start, end, end, end);
    if (ray.y < 0.0 && end.y > 0.0) {
        breaks[1] = Place(0.0, ray.perigee_altitude);
    }
    vec2 edge = shadow_boundary(ray, mu, mu_s, nu);
    for (int k = 0; k < 2; ++k) {
        if (edge[k] > 0.0) {
            breaks[2 + k] = place_before_end(ray, edge[k], end);
        }
    }
    put_in_order(breaks[1], breaks[2]);
    put_in_order(breaks[2], breaks[3]);
    put_in_order(breaks[1], breaks[2]);
    if (fog_scale_height_m == 0.0) {
        return 5;
    }
    breaks[4] = place_at_fog_top(ray, -1.0, end);
    breaks[5] = place_at_fog_top(ray, 1.0, end);
    for (int last = 4; last < 6; ++last) {
        for (int k = last; k > 1; --k) {
            put_in_order(breaks[k - 1], breaks[k]);
        }
    }
    return 7;
}

// A lit piece of a ray, from its low end; the extent in y is negative on a descending one.
struct Segment {
    Place low;
    float extent;
};

int find_lit_segments(Ray ray, float mu, float mu_s, float nu, out Segment lit[MOST_BREAKS - 1]) {
    Place breaks[MOST_BREAKS];
    int segments = find_break_points(ray, mu, mu_s, nu, breaks) - 1;
    int count = 0;
    for (int k = 0; k < segments; ++k) {
        float whole = extent(breaks[k], breaks[k + 1]);
        bool ascending = breaks[k + 1].y > 0.0;
        Segment segment = Segment(breaks[ascending ? k : k + 1], ascending ? whole : -whole);
        Place middle = moved(segment.low, 0.5 * segment.extent);
        bool dark = in_shadow(middle.altitude, sun_cosine(ray, middle, mu_s, nu));
        if (whole > 0.0 && !dark) {
            lit[count++] = segment;
        }
    }
    return count;
}

// Extinction of all that scatters where it is largest in the spectrum.
float largest_extinction(float altitude) {
    vec3 r = rayleigh_scattering;
    vec3 m = mie_extinction;
    vec2 largest = vec2(max(max(r.x, r.y), r.z), max(max(m.x, m.y), m.z));
    vec3 f = fog_extinction;
    float fog = max(max(f.x, f.y), f.z) * fog_at(altitude);
    return dot(largest, densities_at(altitude)) + fog;
}

// Add a node's share, metres of path wide, to the integrals.
void add_node(Ray ray, vec2 d0, vec2 tail0, Place node, float mu_s, float metres,
              inout Integrals sum) {
    vec2 density = densities_at(node.altitude);
    Ray sun = make_ray(node.altitude, mu_s);
    Place sun_end = place_at_top(sun);
    vec2 scale = scale_height_m;
    vec2 paths = exponential_paths(ray, d0, tail0, node, density, scale);
    paths += exponential_paths(sun, density, tail(sun.y, density, scale), sun_end,
                               densities_at(top_altitude_m), scale);
    float fog_density = fog_at(node.altitude);
    float fog = fog_path(ray, node, fog_density)
        + fog_path(sun, sun_end, fog_at(top_altitude_m));
    float absorbed = absorber_path(ray, node) + absorber_path(sun, sun_end);
    vec3 light = metres * exp(-optical_depth(paths, fog, absorbed));
    sum.rayleigh += light * density.x;
    sum.mie += light * density.y;
    sum.fog += light * fog_density;
}

// How strongly the nodes cluster at the low end.
float clustering_of(Ray ray, Segment segment) {
    // Up a hazy ray the light comes from the nearest part only.
    float metres = max(segment.extent, 0.0) * jacobian(ray.perigee_radius, segment.low.y);
    float depth = largest_extinction(segment.low.altitude) * metres;
    return clustering.x + log(1.0 + depth / clustering.y);
}

Integrals gauss_legendre_integrals(float altitude, float mu, float mu_s, float nu) {
    Ray ray = make_ray(altitude, mu);
    vec2 d0 = densities_at(altitude);
    vec2 tail0 = tail(ray.y, d0, scale_height_m);
    Segment lit[MOST_BREAKS - 1];
    int count = find_lit_segments(ray, mu, mu_s, nu, lit);
    Integrals sum = Integrals(vec3(0.0), vec3(0.0), vec3(0.0));
    for (int k = 0; k < count; ++k) {
        float b = clustering_of(ray, lit[k]);
        float span = exp(b) - 1.0;
        for (int i = 0; i < gauss_nodes; ++i) {
            float rise = exp(b * gauss_node[i]);
            Place node = moved(lit[k].low, lit[k].extent * (rise - 1.0) / span);
            float dy = abs(lit[k].extent) * gauss_weight[i] * b * rise / span;
            float metres = dy * jacobian(ray.perigee_radius, node.y);
            add_node(ray, d0, tail0, node, sun_cosine(ray, node, mu_s, nu), metres, sum);
        }
    }
    return sum;
}
