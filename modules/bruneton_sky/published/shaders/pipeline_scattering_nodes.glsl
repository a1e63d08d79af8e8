// The nodes of a scattering table, four axes packed in three: x = nu * MU_S + mu_s, y = mu,
// z = altitude. The axis of mu is two in one: rays that meet the ground, from the horizon down,
// then those that do not, from the zenith to the horizon. tables/parametrisation_2017.py is the
// same in double precision.

// The sun of a node, as seen along a ray: azimuth 0 is the ray's.
struct Sun {
    float mu_s;
    float sine;
    float cos_azimuth;
    float nu;
};

Ray ray_of_node(int altitude_node, int mu_node) {
    float h = altitude_of_unit(float(altitude_node) / float(ALTITUDE - 1));
    const float last = float(MU / 2 - 1);
    if (mu_node < MU / 2) {
        return ray_to_ground(h, float(mu_node) / last);
    }
    return ray_to_top(h, float(MU - 1 - mu_node) / last);
}

Sun sun_of_node(Ray ray, int nu_node, int mu_s_node) {
    float unit = float(mu_s_node) / float(MU_S - 1);
    float lowest = lowest_sun_share;
    float share = lowest * (1.0 - unit) / (1.0 + unit * lowest);
    Ray from_ground = ray_to_top(0.0, 1.0 - share);
    Sun sun;
    sun.mu_s = from_ground.mu;
    sun.sine = from_ground.sine;
    // nu is held to what mu and mu_s allow.
    float nu = 2.0 * float(nu_node) / float(NU - 1) - 1.0;
    float across = ray.sine * sun.sine;
    sun.cos_azimuth = across > 0.0 ? clamp((nu - ray.mu * sun.mu_s) / across, -1.0, 1.0) : 0.0;
    sun.nu = clamp(ray.mu * sun.mu_s + across * sun.cos_azimuth, -1.0, 1.0);
    return sun;
}
