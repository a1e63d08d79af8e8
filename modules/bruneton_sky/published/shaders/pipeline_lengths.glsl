// Altitudes and directions as lengths of rays, as tables/ray_lengths.py has them in double
// precision. Squares stay factored: no cancellation at the ground, the horizon or the top.

// Length of the tangent to the ground.
float tangent(float altitude) {
    return sqrt(altitude * (2.0 * ground_radius_m + altitude));
}

float altitude_of_squared_tangent(float squared) {
    float far = ground_radius_m + sqrt(squared + ground_radius_m * ground_radius_m);
    return min(squared / far, top_altitude_m);
}

// The altitude whose tangent has this share of the top's; exactly the top at 1.
float altitude_of_unit(float unit) {
    float rho = unit * top_tangent_m;
    return unit < 1.0 ? altitude_of_squared_tangent(rho * rho) : top_altitude_m;
}

// To the top of the atmosphere, as if there were no ground.
float length_to_top(float altitude, float mu) {
    float along = (ground_radius_m + altitude) * mu;
    float rise = (top_altitude_m - altitude) * (2.0 * ground_radius_m + top_altitude_m + altitude);
    float far = sqrt(along * along + rise) + abs(along);
    return along > 0.0 ? rise / far : far;
}

// To the ground, of a ray that meets it.
float length_to_ground(float altitude, float mu) {
    float along = (ground_radius_m + altitude) * -mu;
    float rho = tangent(altitude);
    float far = along + sqrt(max((along - rho) * (along + rho), 0.0));
    return far > 0.0 ? rho * rho / far : 0.0;
}

bool hits_ground(float altitude, float mu) {
    return mu < 0.0 && (ground_radius_m + altitude) * -mu >= tangent(altitude);
}

// The longest ray to the top that misses the ground, and by how much it exceeds the shortest.
float longest_to_top(float altitude) {
    return tangent(altitude) + top_tangent_m;
}

float room_to_top(float altitude) {
    return longest_to_top(altitude) - (top_altitude_m - altitude);
}

// Cosine of the sun's zenith angle after a distance along a ray.
float mu_s_after(float altitude, float mu_s, float nu, float distance, float there) {
    float along = (ground_radius_m + altitude) * mu_s + distance * nu;
    return clamp(along / (ground_radius_m + there), -1.0, 1.0);
}
