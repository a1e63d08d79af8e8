// Rays at the nodes of tables, and the points on them.
//
// The axes of mu are lengths of rays: exact at a node is its ray's deficit, the difference to the
// longest ray of its kind, which grazes the ground. In haze light fades so steeply toward that ray
// that a rounding error of the table coordinate would show. So every ray is described from its
// lowest point upward, and all values at its points are sums of positive terms: the squared
// tangent, of which the altitude is made, and the deficit to the top.

struct Line {
    float squared;      // of the tangent at the lowest point, which is the ground or the perigee
    float along;        // from the perigee to the lowest point
    float deficit;      // the rest of it there, without the tangent
    float start;        // of the ray, in metres from the lowest point; negative before it
    float sense;        // 1, or -1 for a ray that goes down to the ground
};

struct Ray {
    float altitude;
    float mu;
    float sine;
    float ray_length;   // to the ground or to the top
    bool hits;
    Line line;
};

// A point of the air, and how much shorter than the longest the way up along the line is there.
struct Point {
    float altitude;
    float deficit;
};

Point point_on(Ray ray, float distance) {
    Line line = ray.line;
    float t = line.start + line.sense * distance;
    float squared = line.squared + t * (t + 2.0 * line.along);
    float rho = sqrt(squared);
    // rho + t, without cancellation where t is negative.
    float rest = t < 0.0 ? line.squared / (rho - t) : rho + t;
    return Point(altitude_of_squared_tangent(squared), line.deficit + rest);
}

// Sine of a zenith angle whose ray exceeds the shortest, straight up or down, by a length: at
// zenith and nadir the cosine has too few digits. `sum` is the other factor of that difference of
// squares.
float sine_of_excess(float altitude, float ray_length, float excess, float sum) {
    float twice = 2.0 * (ground_radius_m + altitude) * ray_length;
    float versine = twice > 0.0 ? min(excess * sum / twice, 2.0) : 0.0;
    return sqrt(versine * (2.0 - versine));
}

// Ray to the ground, shorter than the longest by a share of the range from shortest to longest. A
// ray of no length goes down.
Ray ray_to_ground(float h, float lacking) {
    float rho = tangent(h);
    float room = rho - h;
    float deficit = lacking * room;
    float excess = (1.0 - lacking) * room;
    float d = h + excess;
    // Over the ground, the distance to the perigee of the line beyond it.
    float along = d > 0.0 ? deficit * (rho + d) / (2.0 * d) : ground_radius_m;
    float far = top_tangent_m + sqrt(top_tangent_m * top_tangent_m + along * along);
    Ray ray;
    ray.altitude = h;
    ray.mu = -min((along + d) / (ground_radius_m + h), 1.0);
    ray.sine = sine_of_excess(h, d, excess, 2.0 * ground_radius_m + h - d);
    ray.ray_length = d;
    ray.hits = true;
    ray.line = Line(0.0, along, along * (1.0 - along / far), d, -1.0);
    return ray;
}

// Likewise to the top. One of no length goes up.
Ray ray_to_top(float h, float lacking) {
    float rho = tangent(h);
    float shortest = top_altitude_m - h;
    float room = room_to_top(h);
    float deficit = lacking * room;
    float excess = (1.0 - lacking) * room;
    float d = shortest + excess;
    float radius = ground_radius_m + h;
    // rho + along, where along is the distance from the perigee, negative before it.
    float sum = d > 0.0 ? deficit * (2.0 * top_tangent_m - deficit) / (2.0 * d) : rho + radius;
    float along = sum - rho;
    Ray ray;
    ray.altitude = h;
    ray.mu = clamp(along / radius, -1.0, 1.0);
    ray.sine = sine_of_excess(h, d, excess, radius + ground_radius_m + top_altitude_m + d);
    ray.ray_length = d;
    ray.hits = false;
    if (along < 0.0) {
        float squared = sum * (rho - along);
        float to_top = sqrt(max(top_tangent_m * top_tangent_m - squared, 0.0));
        ray.line = Line(squared, 0.0, squared / (top_tangent_m + to_top), along, 1.0);
    } else {
        ray.line = Line(rho * rho, along, max(deficit - rho, 0.0), 0.0, 1.0);
    }
    return ray;
}
