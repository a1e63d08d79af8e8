#version 430 core
// Exposure, white balance, a tone curve and a dither: the twin of pictures/display.py.

uniform sampler2D radiance;
uniform mat3 from_radiance;  // exposure, white balance, and AgX's inset
uniform float exponential_rate;
uniform mat3 outset;         // AgX's, after its saturation
uniform float darkest;
uniform float darkest_log2;
uniform float per_log2;
uniform float curve[8];      // AgX's sigmoid and contrast, one polynomial
uniform vec3 luminance_weights;
#ifdef EYE
uniform mat3 xyz_from_srgb;
uniform vec3 rods_grey;              // of a scotopic luminance of 1, beside cones
uniform vec3 rods_blue;              // and where rods see alone
uniform float field;                 // the eye's adaptation; CIE Y in W m^-2 sr^-1, as the next two
uniform float rods_alone;
uniform float cones_alone;
uniform vec4 acuity;
uniform float least_cycles;
uniform float sharp_px;
uniform float lumens_per_watt;
uniform float blur;                  // deviation in pixels times cycles a degree
uniform int reach;                   // pixels at most; 0 blurs nothing
uniform float deviations;            // radius of the sum
#endif

in vec2 at;
out vec4 display;

// Triangular noise of one 8-bit step, fixed per pixel (interleaved gradient noise, Jimenez
// 2014): breaks the bands of a smooth sky without moving its mean.
float dither(vec2 p) {
    float a = fract(52.9829189 * fract(dot(p, vec2(0.06711056, 0.00583715))));
    float b = fract(52.9829189 * fract(dot(p + 47.0, vec2(0.00583715, 0.06711056))));
    return (a + b - 1.0) / 255.0;
}

vec3 srgb_encode(vec3 c) {
    c = clamp(c, 0.0, 1.0);
    return mix(12.92 * c, 1.055 * pow(c, vec3(1.0 / 2.4)) - 0.055, step(vec3(0.0031308), c));
}

vec3 agx(vec3 picture) {
    vec3 x = clamp((log2(max(picture, darkest)) - darkest_log2) * per_log2, 0.0, 1.0);
    vec3 c = vec3(curve[7]);
    for (int k = 6; k >= 0; --k) c = c * x + curve[k];
    return clamp(outset * max(c, 0.0), 0.0, 1.0);
}

#ifdef EYE
// The twins of pictures/night_eye.py.
vec3 as_sharp_as_seen(ivec2 p) {
    ivec2 last = textureSize(radiance, 0) - 1;
    vec3 own = texelFetch(radiance, p, 0).rgb;
    if (reach == 0) return own;
    float light = 0.0;
    for (int i = -1; i <= 1; ++i)
        for (int j = -1; j <= 1; ++j)
            light += dot(texelFetch(radiance, clamp(p + ivec2(j, i), ivec2(0), last), 0).rgb,
                         luminance_weights);
    float decades = log(max(max(light / 9.0, field) * lumens_per_watt, 1e-20)) / log(10.0);
    float cycles = acuity.x * atan(acuity.y * decades + acuity.z) + acuity.w;
    float deviation = min(blur / max(cycles, least_cycles), float(reach) / deviations);
    if (deviation < sharp_px) return own;
    int near = min(reach, int(ceil(deviations * deviation)));
    // exp(-(i * i + j * j) / (2 deviation^2)) along a row by its ratios: q, q^3, q^5, ...
    float q = exp(-0.5 / (deviation * deviation));
    vec3 total = vec3(0.0);
    float weights = 0.0;
    for (int i = -near; i <= near; ++i) {
        int y = clamp(p.y + i, 0, last.y);
        float weight = exp(-0.5 * float(i * i) / (deviation * deviation)), ratio = q;
        vec3 row = weight * texelFetch(radiance, ivec2(p.x, y), 0).rgb;
        float row_weights = weight;
        for (int j = 1; i * i + j * j <= near * near; ++j) {
            weight *= ratio;
            ratio *= q * q;
            row += weight * (texelFetch(radiance, ivec2(max(p.x - j, 0), y), 0).rgb
                             + texelFetch(radiance, ivec2(min(p.x + j, last.x), y), 0).rgb);
            row_weights += 2.0 * weight;
        }
        total += row;
        weights += row_weights;
    }
    return total / weights;
}

vec3 seen_by_eye(vec3 rgb) {
    vec3 xyz = max(xyz_from_srgb * rgb, 1e-20);
    float scotopic = xyz.y * max(1.33 * (1.0 + (xyz.y + xyz.z) / xyz.x) - 1.68, 0.0);
    float adapted = log(max(xyz.y, field) / rods_alone);
    float seen_by_rods = 1.0 - clamp(adapted / log(cones_alone / rods_alone), 0.0, 1.0);
    vec3 grey = mix(rods_grey, rods_blue, seen_by_rods);
    return mix(rgb, scotopic * grey, seen_by_rods);
}
#endif

void main() {
#ifdef EYE
    vec3 picture = seen_by_eye(as_sharp_as_seen(ivec2(gl_FragCoord.xy)));
#else
    vec3 picture = texelFetch(radiance, ivec2(gl_FragCoord.xy), 0).rgb;
#endif
    picture = from_radiance * picture;
#if defined(AGX)
    vec3 encoded = agx(picture);
#elif defined(EXPONENTIAL)
    vec3 encoded = srgb_encode(1.0 - exp(-exponential_rate * max(picture, 0.0)));
#else
    vec3 encoded = srgb_encode(picture);
#endif
    display = vec4(encoded + dither(gl_FragCoord.xy), dot(encoded, luminance_weights));
}
