// Rays in altitudes, never in radii: geometry.py explains y and why no large squares are
// subtracted. In single precision two values of y (2522 at the zenith on Earth) are seldom to be
// subtracted either: see `extent`.

struct Ray {
    float altitude;
    float radius;
    float along;            // radius times mu: signed distance from the perigee
    float perigee_radius;
    float perigee_altitude;
    float y;
};

// A place on a ray.
struct Place {
    float y;
    float altitude;
};

Ray make_ray(float altitude, float mu) {
    Ray ray;
    ray.altitude = altitude;
    ray.radius = ground_radius_m + altitude;
    ray.along = ray.radius * mu;
    float sine = sqrt((1.0 - mu) * (1.0 + mu));
    float y_squared = ray.along * mu / (1.0 + sine);
    ray.perigee_radius = ray.radius * sine;
    ray.perigee_altitude = altitude - y_squared;
    ray.y = mu < 0.0 ? -sqrt(y_squared) : sqrt(y_squared);
    return ray;
}

Place start_of(Ray ray) {
    return Place(ray.y, ray.altitude);
}

bool hits_ground(Ray ray) {
    return ray.along < 0.0 && ray.perigee_altitude <= 0.0;
}

// Where the ray leaves the atmosphere, as if there were no ground.
Place place_at_top(Ray ray) {
    float y = sqrt(max(ray.y * ray.y + (top_altitude_m - ray.altitude), 0.0));
    return Place(max(y, ray.y), top_altitude_m);
}

Place end_of(Ray ray) {
    if (!hits_ground(ray)) {
        return place_at_top(ray);
    }
    return Place(max(-sqrt(-ray.perigee_altitude), ray.y), 0.0);
}

// Altitude after a distance along the ray.
float altitude_after(Ray ray, float distance) {
    float rise = distance * (distance + 2.0 * ray.along);
    return ray.altitude + rise / (sqrt(rise + ray.radius * ray.radius) + ray.radius);
}

// The place after a distance, or the end if that comes first. Altitudes decide, since y is equal at
// both ends of a steep ray of a few metres.
Place place_before_end(Ray ray, float distance, Place end) {
    float d = ray.along + distance;
    float altitude = altitude_after(ray, distance);
    bool beyond = end.y <= 0.0 ? d >= 0.0 || altitude <= 0.0 : d > 0.0 && altitude >= end.altitude;
    if (beyond) {
        return end;
    }
    float p = ray.perigee_radius;
    float y = d / sqrt(max(p + sqrt(p * p + d * d), 1e-30));
    return Place(clamp(y, ray.y, end.y), max(altitude, 0.0));
}

// Extent in y from a to b, both on one side of the perigee, of which b lies further along.
float extent(Place a, Place b) {
    // Use y or altitude, whichever has less rounding error: a level ray at 60 km rises by
    // too little for its altitudes to tell, a steep one gains too little y.
    float total = a.y + b.y;
    bool level = abs(total) * max(abs(a.y), abs(b.y)) <= max(a.altitude, b.altitude);
    return level ? b.y - a.y : (b.altitude - a.altitude) / total;
}

// The place dy further, in the units of y.
Place moved(Place from, float dy) {
    float altitude = from.altitude + dy * (dy + 2.0 * from.y);
    return Place(from.y + dy, clamp(altitude, 0.0, top_altitude_m));
}

// Metres of path per unit of y.
float jacobian(float perigee_radius, float y) {
    float squared = y * y + 2.0 * perigee_radius;
    return squared > 0.0 ? 2.0 * (y * y + perigee_radius) / sqrt(squared) : 0.0;
}

// Cosine of the sun's zenith angle at a place on the ray.
float sun_cosine(Ray ray, Place place, float mu_s, float nu) {
    float distance = place.y * sqrt(place.y * place.y + 2.0 * ray.perigee_radius) - ray.along;
    float cosine = (ray.radius * mu_s + distance * nu) / (ground_radius_m + place.altitude);
    return clamp(cosine, -1.0, 1.0);
}

// Whether the planet hides the sun's centre.
bool in_shadow(float altitude, float mu_s) {
    float radius = ground_radius_m + altitude;
    float tangent = radius * mu_s;
    return mu_s < 0.0 && tangent * tangent >= altitude * (radius + ground_radius_m);
}

// Distances to where the ray crosses the edge of the planet's shadow; negative: no crossing.
vec2 shadow_boundary(Ray ray, float mu, float mu_s, float nu) {
    float a = (1.0 - nu) * (1.0 + nu);
    float b = ray.radius * (mu - mu_s * nu);
    float horizon = sqrt(ray.altitude * (ray.radius + ground_radius_m));
    float sun = ray.radius * mu_s;
    float c = (horizon - sun) * (horizon + sun);
    float discriminant = b * b - a * c;
    if (discriminant <= 0.0) {
        return vec2(-1.0);
    }
    float q = b < 0.0 ? sqrt(discriminant) - b : -(sqrt(discriminant) + b);
    vec2 numerator = vec2(q, c);
    vec2 denominator = vec2(a, q);
    vec2 distance = vec2(-1.0);
    for (int k = 0; k < 2; ++k) {
        if (abs(denominator[k]) > abs(numerator[k]) * 1e-9) {
            float s = numerator[k] / denominator[k];
            // On the edge's sunward side the planet hides nothing.
            distance[k] = s > 0.0 && sun + s * nu < 0.0 ? s : -1.0;
        }
    }
    return distance;
}
