#version 430 core
// Curtains of light: the twin of aurora/curtains.py, which explains the model and its constants.
uniform vec3 poleward, east, air_depth;
uniform float edge_km, width_km, lean, eye_km;
uniform float phases[5];
uniform vec3 line_rgb[3];            // times kR
in vec3 ray;
out vec4 frag_radiance;
const float R = 6371.0, LOW = 90.0, HIGH = 400.0, TURN = 6.28318531, STEPS = 64.0,
    THICKNESS_KM = 4.0, DIFFUSE = 0.06;
const vec3 PEAK_KM = vec3(112.0, 240.0, 106.0), SCALE_KM = vec3(16.0, 50.0, 12.0);
const vec3 FOLD_KM = vec3(25.0, 9.0, 3.0), WAVE_KM = vec3(420.0, 130.0, 41.0);
const vec3 SHEET_PLACE = vec3(0.1, 0.45, 0.8), SHEET_BRIGHT = vec3(1.0, 0.6, 0.35);
float density(float x, float y, vec2 moved) {
    float inside = ((y - edge_km) / width_km - 0.5) / 0.45;
    float whole = DIFFUSE * exp(-inside * inside);
    for (int number = 0; number < 3; ++number) {
        float fold = 0.0, across = moved.y;
        for (int k = 0; k < 3; ++k) {
            float phase = TURN * x / WAVE_KM[k] + phases[k] + 1.7 * number * (k + 1);
            fold += FOLD_KM[k] * sin(phase);
            across -= FOLD_KM[k] * TURN / WAVE_KM[k] * cos(phase) * moved.x;
        }
        float width = length(vec2(THICKNESS_KM, 0.8 * across));
        float slow = sin(TURN * x / 190.0 + phases[4] + number);
        float rays = 0.5 + 0.5 * sin(TURN * x / 67.0 + phases[3] + 2.2 * slow);
        float away = (y - edge_km - SHEET_PLACE[number] * width_km - fold) / width;
        float sheet = exp(-away * away) * THICKNESS_KM / width;
        whole += SHEET_BRIGHT[number] * sheet * (0.2 + 0.8 * rays * rays);
    }
    return whole;
}
vec2 through_shell(float mu, float r) {
    float high = mu * mu * r * r + (R + HIGH - r) * (R + HIGH + r);
    float low = mu * mu * r * r + (R + LOW - r) * (R + LOW + r);
    float far = -r * mu + sqrt(max(high, 0.0)), below = sqrt(max(low, 0.0));
    if (r < R + LOW) return vec2(-r * mu + below, mu > 0.0 ? far : 0.0);
    float near = max(-r * mu - sqrt(max(high, 0.0)), 0.0);
    float end = low > 0.0 && mu < 0.0 ? -r * mu - below : far;
    return vec2(near, high > 0.0 ? end : near);
}
void main() {
    vec3 d = normalize(ray), total = vec3(0.0);
    float mu = d.y, r = R + eye_km, north = dot(d, poleward), right = dot(d, east);
    vec2 shell = through_shell(mu, r);
    float step_km = (shell.y - shell.x) / STEPS;
    for (int k = 0; k < int(STEPS) && step_km > 0.0; ++k) {
        float t = shell.x + (k + 0.5) * step_km, square = 2.0 * r * mu * t + t * t;
        float altitude = (eye_km * (2.0 * R + eye_km) + square) / (sqrt(r * r + square) + R);
        float y = R * atan(t * north, r + t * mu) + lean * (altitude - PEAK_KM.x);
        vec3 u = (vec3(altitude) - PEAK_KM) / SCALE_KM, glow = exp(-u - exp(-u)) / SCALE_KM;
        vec2 moved = step_km * vec2(right, north + lean * mu);
        total += density(R * atan(t * right, r + t * mu), y, moved) * step_km * (mat3(line_rgb[0], line_rgb[1], line_rgb[2]) * glow);
    }
    float sine = clamp(mu, 0.0, 1.0);
    float mass = 1.0 / (sine + 0.50572 * pow(degrees(asin(sine)) + 6.07995, -1.6364));
    frag_radiance = vec4(total * exp(-mass * air_depth), 0.0);
}
