// The light that a bin of a ray scatters toward the observer: the twin of
// solver/first_order_kernels.py and solver/later_order_kernels.py.

struct Bin {
    vec4 place;        // distance of its centre, of both ends; 0: it adds next to nothing
    vec4 centre;       // 1 / radius, mu, 1 / sine, place on the axis of altitudes
    vec4 to_top;       // of the sun's path there: see sunlight
    vec4 molecules;    // weight of their scattering, four wavelengths
    vec4 aerosol;
    vec4 shares[3];    // of the second and further kinds in what particles scatter
};

layout(std430, binding = 4) restrict readonly buffer Transmittance { vec4 transmittance[]; };
layout(std430, binding = 5) restrict readonly buffer Rayleigh { vec4 rayleigh[]; };
layout(std430, binding = 6) restrict readonly buffer Mie { vec4 mie[]; };

struct Phases {
    vec4 kinds[4];     // of the particles' kinds at four wavelengths
    vec4 channels;     // of red, green and blue of their light
};

// Uniform in the sine of half the angle to the sun.
layout(std430, binding = 7) restrict readonly buffer Angles { Phases angles[]; };

// Of the source functions, by altitude and sun: see Source.bend and Source.pace.
layout(std430, binding = 8) restrict readonly buffer Bends { vec2 bends[]; };

const float SUN_TILT = 0.47140452;  // see between_suns.py
const float OVER_ONE = 1.000001;    // see first_order_kernels.py

uniform ivec2 transmittances;   // altitudes, columns
uniform ivec2 altitudes;        // of both source functions; 0: no source function
uniform ivec3 directions;       // of the source function: suns, azimuths, mu
uniform vec4 sun_grid;          // see SunGrid.constants
uniform vec4 solar_irradiance;
uniform float anisotropy;       // of molecules: see Atmosphere.rayleigh_anisotropy

const float PI = 3.14159265;

// Where on an axis of tables: the node before, and the share of the next.
struct Place {
    int low;
    float far;
};

Place place_of(float place, int nodes) {
    int low = min(int(place), nodes - 2);
    return Place(low, place - float(low));
}

Place place_on(float at, int nodes) {
    return place_of(clamp(at, 0.0, 1.0) * float(nodes - 1), nodes);
}

// As the twin does it for suns and azimuths: never quite on the last node.
Place place_before_last(float at, int nodes) {
    return place_of(clamp(at * float(nodes - 1), 0.0, float(nodes) - 1.001), nodes);
}

// Distances between which the ray is in the planet's shadow. `row`: radius where the ray starts,
// that height as a share of the squared radius, mu.
vec2 shadow_of(vec4 row, float mu_s, float nu) {
    float a = max((1.0 - nu) * (1.0 + nu), 1e-7);
    float b = row.z - mu_s * nu, c = row.y - mu_s * mu_s;
    float root = sqrt(max(b * b - a * c, 0.0));
    if (root <= 0.0) return vec2(3e38, 0.0);
    float level = -mu_s / max(abs(nu), 1e-7);
    float first = (-b - root) / a, last = (root - b) / a;
    return row.x * (nu < 0.0 ? vec2(max(first, -level), last) : vec2(first, min(last, level)));
}

// The sun's light at a bin, four wavelengths.
vec4 sunlight(Bin bin, float sun, vec2 shadow) {
    float path = sqrt(sun * sun + bin.to_top.x) - sun;
    Place column = place_before_last((path - bin.to_top.y) * bin.to_top.z, transmittances.y);
    Place altitude = place_on(bin.centre.w, transmittances.x);
    int at = altitude.low * transmittances.y + column.low, above = at + transmittances.y;
    vec4 here = mix(transmittance[at], transmittance[above], altitude.far);
    vec4 next = mix(transmittance[at + 1], transmittance[above + 1], altitude.far);
    float dark = (min(shadow.y, bin.place.z) - max(shadow.x, bin.place.y))
                 * (OVER_ONE / max(bin.place.z - bin.place.y, 1e-30));
    return (1.0 - clamp(dark, 0.0, 1.0)) * solar_irradiance * mix(here, next, column.far);
}

Place sun_place(float sun) {
    float d = sqrt(1.0 - sun) - sun_grid.x;
    return place_before_last((sun_grid.z - d / (sun_grid.y + abs(d))) * sun_grid.w, directions.x);
}

float azimuth_cosine(int turn) {
    float x = float(turn) / float(directions.y - 1);
    return 1.0 - 2.0 * x * x;
}

// A coefficient of the molecules' source function: between altitudes and suns.
vec4 coefficient(int which, Place altitude, Place sun) {
    int at = (4 * altitude.low + which) * directions.x + sun.low, above = at + 4 * directions.x;
    return mix(mix(rayleigh[at], rayleigh[at + 1], sun.far),
               mix(rayleigh[above], rayleigh[above + 1], sun.far), altitude.far);
}

vec4 source_of_molecules(Bin bin, Place sun, Place turn) {
    if (altitudes.x == 0) return vec4(0.0);
    Place altitude = place_on(bin.centre.w, altitudes.x);
    float mu = bin.centre.y, across = max((1.0 - mu) * (1.0 + mu), 0.0);
    vec4 level = coefficient(0, altitude, sun);
    level += (3.0 * mu * mu - 1.0) * coefficient(1, altitude, sun);
    vec4 once = mu * sqrt(across) * coefficient(2, altitude, sun);
    vec4 twice = across * coefficient(3, altitude, sun);
    // Between two azimuths, as the tables of aerosol.
    float c = azimuth_cosine(turn.low), d = azimuth_cosine(turn.low + 1);
    return level + mix(c, d, turn.far) * once + (2.0 * mix(c * c, d * d, turn.far) - 1.0) * twice;
}

// Of aerosol, between suns and azimuths, at a node of altitude and mu.
vec4 mie_at(int altitude, int mu, Place sun, Place turn) {
    int at = ((altitude * directions.z + mu) * directions.y + turn.low) * directions.x + sun.low;
    int beside = at + directions.x;
    return mix(mix(mie[at], mie[at + 1], sun.far),
               mix(mie[beside], mie[beside + 1], sun.far), turn.far);
}

vec4 source_of_aerosol(Bin bin, Place sun, Place turn) {
    if (altitudes.y == 0) return vec4(0.0);
    Place altitude = place_on(bin.centre.w, altitudes.y);
    Place mu = place_on(0.5 * bin.centre.y + 0.5, directions.z);
    int i = altitude.low, j = mu.low;
    return mix(mix(mie_at(i, j, sun, turn), mie_at(i, j + 1, sun, turn), mu.far),
               mix(mie_at(i + 1, j, sun, turn), mie_at(i + 1, j + 1, sun, turn), mu.far),
               altitude.far);
}

// The light between two suns and along a bin over that of lines at its centre: see the twin.
float level_of(Bin bin, float sun, float nu, Place at) {
    int nodes = max(altitudes.x, altitudes.y);
    if (nodes == 0) return 1.0;
    Place altitude = place_on(bin.centre.w, nodes);
    int here = altitude.low * directions.x + at.low;
    float bend = mix(bends[here].x, bends[here + directions.x].x, altitude.far);
    float moved = (nu - bin.centre.y * sun) * (bin.place.z - bin.place.y) * bin.centre.x;
    float tilted = 1.0 + SUN_TILT * sqrt(max(bend, 0.0)) * (1.0 - 2.0 * at.far);
    return 1.0 - bend * (tilted * at.far * (1.0 - at.far) - bends[here].y * moved * moved);
}

// Light scattered twice and more toward the eye.
vec4 scattered_again(Bin bin, float sun, float nu) {
    float sines = max((1.0 - sun) * (1.0 + sun), 1e-9);
    float cosine = clamp((nu - bin.centre.y * sun) * bin.centre.z * inversesqrt(sines), -1.0, 1.0);
    Place turn = place_before_last(sqrt(0.5 - 0.5 * cosine), directions.y), at = sun_place(sun);
    return level_of(bin, sun, nu, at) * (bin.molecules * source_of_molecules(bin, at, turn)
                                       + bin.aerosol * source_of_aerosol(bin, at, turn));
}

Phases phases_of(float nu) {
    Place at = place_on(sqrt(max(0.5 - 0.5 * nu, 0.0)), angles.length());
    Phases here = angles[at.low], next = angles[at.low + 1];
    Phases between;
    for (int k = 0; k < 4; ++k) {
        between.kinds[k] = mix(here.kinds[k], next.kinds[k], at.far);
    }
    between.channels = mix(here.channels, next.channels, at.far);
    return between;
}

// The mean phase function of a bin's particles.
vec4 mean_phase(Bin bin, Phases p) {
    vec4 mean = p.kinds[0];
    for (int k = 0; k < 3; ++k) {
        mean += bin.shares[k] * (p.kinds[k + 1] - p.kinds[0]);
    }
    return mean;
}

float rayleigh_phase(float nu) {
    return 3.0 / (16.0 * PI) * (1.0 + nu * nu);
}

// The molecules' phase function over Rayleigh's, of this value.
float depolarised(float rayleigh_phase) {
    return anisotropy + (1.0 - anisotropy) / (4.0 * PI * rayleigh_phase);
}
