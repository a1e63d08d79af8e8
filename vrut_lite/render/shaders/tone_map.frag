#version 430 core
// Exposure, the AgX curve and a dither: the twin of render/tone_map.py.

uniform sampler2D radiance;
uniform float exposure_scale;
uniform mat3 inset;
uniform mat3 outset;
uniform float darkest_log2;
uniform float brightest_log2;
uniform float sigmoid[7];
uniform float contrast;
uniform float saturation;
uniform vec3 luminance_weights;

in vec2 at;
out vec4 display;

// Triangular noise of one 8-bit step, fixed per pixel (interleaved gradient noise, Jimenez
// 2014): breaks the bands of a smooth sky without moving its mean.
float dither(vec2 p) {
    float a = fract(52.9829189 * fract(dot(p, vec2(0.06711056, 0.00583715))));
    float b = fract(52.9829189 * fract(dot(p + 47.0, vec2(0.00583715, 0.06711056))));
    return (a + b - 1.0) / 255.0;
}

void main() {
    vec3 picture = texelFetch(radiance, ivec2(gl_FragCoord.xy), 0).rgb * exposure_scale;
    vec3 x = (log2(max(inset * picture, exp2(darkest_log2))) - darkest_log2)
             / (brightest_log2 - darkest_log2);
    x = clamp(x, 0.0, 1.0);
    vec3 curve = vec3(sigmoid[6]);
    for (int k = 5; k >= 0; --k) curve = curve * x + sigmoid[k];
    curve = pow(max(curve, 0.0), vec3(contrast));
    float grey = dot(curve, luminance_weights);
    vec3 encoded = clamp(outset * mix(vec3(grey), curve, saturation), 0.0, 1.0);
    display = vec4(encoded + dither(gl_FragCoord.xy), 1.0);
}
