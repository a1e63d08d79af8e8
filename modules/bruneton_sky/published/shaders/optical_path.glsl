// Metres of density 1 along a ray, in closed form: optical_path.py derives the formulas.
// Molecules and aerosol go through them side by side, as the two components of a vec2.

// exp(x^2) erfc(x) for x >= 0, relative error 1.3e-9 before rounding.
vec2 erfcx(vec2 x) {
    vec2 t = (x - 4.0) / (x + 4.0);
    vec2 p = vec2(-0.000008625303);
    p = p * t + 0.000114208173;
    p = p * t - 0.000220404494;
    p = p * t - 0.000709132787;
    p = p * t + 0.005047229283;
    p = p * t - 0.016230391983;
    p = p * t + 0.037161482871;
    p = p * t - 0.066319044089;
    p = p * t + 0.093734073444;
    p = p * t - 0.101040940771;
    p = p * t + 0.068096941417;
    p = p * t + 0.015379768723;
    p = p * t - 0.139621113854;
    p = p * t + 1.232995117440;
    return p / (1.0 + 2.0 * x);
}

// Path beyond a place, away from the perigee, over sqrt(pi H).
vec2 tail(float y, vec2 density, vec2 scale) {
    return density * erfcx(abs(y) * inversesqrt(scale));
}

// From the start of a ray, where densities and tails are d0 and tail0, to a place with d1.
vec2 exponential_paths(Ray ray, vec2 d0, vec2 tail0, Place end, vec2 d1, vec2 scale) {
    vec2 tail1 = tail(end.y, d1, scale);
    vec2 t0;
    if (ray.y >= 0.0) {
        t0 = tail0 - tail1;
    } else if (end.y <= 0.0) {
        t0 = tail1 - tail0;
    } else {
        t0 = 2.0 * exp(-max(ray.perigee_altitude, 0.0) / scale) - tail0 - tail1;
    }
    t0 *= sqrt(PI * scale);
    float y_squared = ray.y * ray.y;
    vec2 t1 = scale * (d0 * ray.y - d1 * end.y) + (0.5 * scale - y_squared) * t0;
    vec2 t2 = (1.5 * scale - y_squared) * t1
        + scale * (y_squared * t0 - end.y * (end.altitude - ray.altitude) * d1);
    float inverse_q = 1.0 / (ray.radius + ray.perigee_radius);
    float a1 = 1.0 / ray.radius - 0.5 * inverse_q;
    float a2 = inverse_q * (0.375 * inverse_q - 0.5 / ray.radius);
    return max(ray.radius * sqrt(inverse_q) * (t0 + a1 * t1 + a2 * t2), 0.0);
}

// The same through fog, to a place where its density is d1.
float fog_path(Ray ray, Place end, float d1) {
    if (fog_scale_height_m == 0.0) {
        return 0.0;
    }
    vec2 scale = vec2(fog_scale_height_m);
    vec2 d0 = vec2(fog_at(ray.altitude));
    return exponential_paths(ray, d0, tail(ray.y, d0, scale), end, vec2(d1), scale).x;
}

// Where an ascending ray that starts at `low` reaches an altitude.
Place place_above(Place low, float altitude) {
    return Place(sqrt(low.y * low.y + (altitude - low.altitude)), altitude);
}

// Through the absorber on an ascending piece of a ray, 0 <= low.y: three Gauss-Legendre nodes
// in y on each linear piece of its density.
float ascending_absorber_path(float perigee_radius, Place low, Place high) {
    const float GAUSS_NODE[3] = float[3](0.1127016653792583, 0.5, 0.8872983346207417);
    const float GAUSS_WEIGHT[3] = float[3](5.0 / 18.0, 8.0 / 18.0, 5.0 / 18.0);
    float path = 0.0;
    for (int k = 0; k + 1 < absorber_nodes; ++k) {
        float bottom = absorber_altitude_m[k];
        float top = absorber_altitude_m[k + 1];
        if (high.altitude < bottom || low.altitude >= top) {
            continue;
        }
        Place a = bottom > low.altitude ? place_above(low, bottom) : low;
        Place b = top < high.altitude ? place_above(low, top) : high;
        float slope = (absorber_density[k + 1] - absorber_density[k]) / (top - bottom);
        float whole = extent(a, b);
        for (int i = 0; i < 3; ++i) {
            float dy = whole * GAUSS_NODE[i];
            float altitude = a.altitude + dy * (dy + 2.0 * a.y);
            float density = absorber_density[k] + slope * (altitude - bottom);
            path += GAUSS_WEIGHT[i] * whole * jacobian(perigee_radius, a.y + dy) * density;
        }
    }
    return path;
}

float absorber_path(Ray ray, Place end) {
    if (absorber_nodes == 0) {
        return 0.0;
    }
    // Descending pieces are ascending ones in the mirror of the perigee.
    Place start = Place(abs(ray.y), ray.altitude);
    Place perigee = Place(0.0, ray.perigee_altitude);
    bool through_perigee = ray.y < 0.0 && end.y > 0.0;
    Place low = ray.y >= 0.0 ? start : through_perigee ? perigee : Place(-end.y, end.altitude);
    Place high = ray.y >= 0.0 ? end : start;
    float path = ascending_absorber_path(ray.perigee_radius, low, high);
    if (through_perigee) {
        path += ascending_absorber_path(ray.perigee_radius, perigee, end);
    }
    return path;
}

// Optical depth from the start of a ray to a place on it.
vec3 optical_depth_to(Ray ray, Place end) {
    vec2 d0 = densities_at(ray.altitude);
    vec2 d1 = densities_at(end.altitude);
    vec2 tail0 = tail(ray.y, d0, scale_height_m);
    vec2 paths = exponential_paths(ray, d0, tail0, end, d1, scale_height_m);
    float fog = fog_path(ray, end, fog_at(end.altitude));
    return optical_depth(paths, fog, absorber_path(ray, end));
}
